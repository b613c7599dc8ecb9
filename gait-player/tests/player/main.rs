//! Tests of the brain, one module for each promise or part.

mod bench;
mod crossing;
mod failsafe;
mod follow;
mod key;
mod latched;
mod passive;
mod play;
mod playback;
mod presence;
mod pulses;
mod refusals;
mod session;
mod size;
mod storage;
mod telemetry;
mod transports;
mod work;
