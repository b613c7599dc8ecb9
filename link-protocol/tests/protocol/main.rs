//! Tests of the wire format and of the authority table.

mod authority;
mod corruption;
mod decoder;
mod golden;
mod samples;
mod seal;
