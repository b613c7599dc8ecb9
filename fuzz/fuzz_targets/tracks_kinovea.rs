//! Kinovea's text and CSV.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| swimmer_fuzz::tracks::read(
    bytes,
    &["#Kinovea Trajectory data export\n", ""]
));
