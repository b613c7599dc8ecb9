//! Tracking files of any format, in any encoding: the way from bytes to a reader.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| swimmer_fuzz::tracks::read(bytes, &[]));
