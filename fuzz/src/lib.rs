//! What the fuzz targets share: operators and links without manners, and the witness that watches the pulses.
//!
//! Bytes from the fuzzer become a story (requests, raw bytes, times, resets) that is told to the real brain and the real
//! session; each target says what must hold however the story goes.

pub mod ask;
pub mod robot;
pub mod tracks;
pub mod wire;
