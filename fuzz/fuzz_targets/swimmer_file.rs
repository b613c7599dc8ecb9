//! Swimmer and campaign files: what is read as a swimmer makes a model and can be written and read again.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use swimmer_files::{Campaign, SwimmerFile};

fuzz_target!(|text: &str| {
    let path = Path::new("f");
    let _ = Campaign::parse(text, path);
    let Ok(file) = SwimmerFile::parse(text, path) else {
        return;
    };
    let written = file.to_toml();
    let again =
        SwimmerFile::parse(&written, path).unwrap_or_else(|error| panic!("{error}\n{written}"));
    assert_eq!(again.to_toml(), written);
    assert_eq!(again.hash(), file.hash());
});
