//! Binary information for `picotool info`, on a board or in a file: name, version with commit, board.

// SAFETY of the section: `memory.x` reserves it for addresses of entries, and these are such addresses.
#![allow(unsafe_code)]

use core::ffi::CStr;

use rp_binary_info::consts::{ID_RP_PROGRAM_VERSION_STRING, TAG_RASPBERRY_PI};
use rp_binary_info::{EntryAddr, consts::ID_RP_PICO_BOARD, rp_program_name};

#[unsafe(link_section = ".bi_entries")]
#[used]
static ENTRIES: [EntryAddr; 3] = [
    rp_program_name!(c"swimmer"),
    rp_binary_info::str!(TAG_RASPBERRY_PI, ID_RP_PROGRAM_VERSION_STRING, VERSION),
    rp_binary_info::str!(TAG_RASPBERRY_PI, ID_RP_PICO_BOARD, BOARD),
];

const VERSION: &CStr = words(concat!(
    env!("CARGO_PKG_VERSION"),
    ", commit ",
    env!("SWIMMER_COMMIT"),
    "\0"
));
const BOARD: &CStr = if cfg!(feature = "pico") {
    c"pico"
} else {
    c"arduino_nano_rp2040_connect"
};

const fn words(text: &'static str) -> &'static CStr {
    match CStr::from_bytes_with_nul(text.as_bytes()) {
        Ok(words) => words,
        Err(_) => panic!("words with a zero in their middle"),
    }
}
