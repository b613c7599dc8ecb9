//! Motive exports 1.2 to 1.25.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| swimmer_fuzz::tracks::read(
    bytes,
    &["Format Version,", "Format Version;", "Format Version\t"]
));
