//! Tracking files of every format: tracks or an error that says where, never a panic, never a number that is none.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match calibrate::read_tracks(bytes, Path::new("f")) {
        Ok(file) => swimmer_fuzz::files::sane(&file),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
