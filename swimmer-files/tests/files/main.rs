//! Tests of the swimmer, gait, campaign and log files.

mod campaign;
mod gait_file;
mod link_log;
mod swimmer_file;
