//! Gait files: what is read can be written, and is read the same again.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use swimmer_files::{AnyGait, GaitFile};

fuzz_target!(|text: &str| {
    let path = Path::new("f");
    let Ok(file) = GaitFile::parse(text, path) else {
        return;
    };
    let written = file.to_text();
    let again =
        GaitFile::parse(&written, path).unwrap_or_else(|error| panic!("{error}\n{written}"));
    assert_eq!(again.to_text(), written);
    let _ = AnyGait::from_file(&file);
});
