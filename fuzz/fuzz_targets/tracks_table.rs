//! Tables with named columns.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| swimmer_fuzz::tracks::read(
    bytes,
    &["t,x", "t;x", "t\tx", "# ", "frame,x"]
));
