//! Tracker's text: several tracks, tracks side by side, one track.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| swimmer_fuzz::tracks::read(
    bytes,
    &["#multi:", "front,,,back", "front\nt\tx\ty"]
));
