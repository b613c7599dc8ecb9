//! Common parts of the fuzz targets: arbitrary operators and links, and a checker of the pulses.
//!
//! Bytes from the fuzzer become a story (requests, raw bytes, times, resets) for the real brain and the real session; each target
//! checks invariants that hold for every story.

pub mod ask;
pub mod robot;
pub mod tracks;
pub mod wire;
