//! Motive exports without their header: rows of frame, time and positions from the first line on.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| swimmer_fuzz::tracks::read(bytes, &["0,0.0,", "0,", "0;", "0\t"]));
