//! Record lines of Tracking Tools and of Motive 1.0 and 1.1.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| swimmer_fuzz::tracks::read(
    bytes,
    &["comment,", "righthanded", "lefthanded", "info,", "frame,0"]
));
