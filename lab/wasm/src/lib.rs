//! The door between the lab page and the workspace: each call of [`calls`] has the name, the keys and the functions of a
//! command of `swimmer`. Nothing is decided here.
//!
//! The module needs nothing from the page but memory: no clock, no randomness (seeds are arguments), no imports.

pub mod abi;
pub mod calls;
pub mod drive;
pub mod explore;
mod input;
