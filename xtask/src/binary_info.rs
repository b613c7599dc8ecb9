//! What `picotool info` would say of an image: read here from its bytes, so that a linker script which drops it is found.
//!
//! In the first 512 bytes of the flash: a marker, the addresses of the first entry and past the last, a table, a marker. Each
//! entry begins with its type and tag; one of a string goes on with its number and the string's address.

use std::fmt;

use crate::failure::{Failure, Outcome};

const MARKERS: [u32; 2] = [0x7188_EBF2, 0xE71A_A390];
const FLASH: u32 = 0x1000_0000;
const HEADER_WITHIN: u32 = 512;
const NUMBERED_STRING: u16 = 6;
const TAG: u16 = u16::from_le_bytes(*b"RP");
const NAME: u32 = 0x0203_1C86;
const VERSION: u32 = 0x11A9_BC3A;
const BOARD: u32 = 0xB63C_FFBB;

/// Name, version with commit, board.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct BinaryInfo {
    name: String,
    version: String,
    board: String,
}

impl fmt::Display for BinaryInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            version,
            board,
        } = self;
        write!(f, "{name} {version}, for {board}")
    }
}

/// Pieces of flash: address and bytes.
#[derive(Clone, Copy)]
pub(crate) struct Pieces<'a>(pub(crate) &'a [(u32, &'a [u8])]);

impl<'a> Pieces<'a> {
    /// Reads what the image says of itself.
    ///
    /// # Errors
    /// When it does not say it where picotool looks.
    pub(crate) fn binary_info(self) -> Outcome<BinaryInfo> {
        self.find().ok_or_else(|| {
            Failure::new(
                "reading the firmware's binary info",
                "there is none where picotool looks",
                "see that memory.x keeps .boot_info and .bi_entries, which firmware/src/binary_info.rs fills",
            )
        })
    }

    fn find(self) -> Option<BinaryInfo> {
        let header = (FLASH..FLASH + HEADER_WITHIN)
            .step_by(4)
            .find(|&at| [self.word(at), self.word(at + 16)] == MARKERS.map(Some))?;
        let entries = self.word(header + 4)?..self.word(header + 8)?;
        let string = |number| {
            entries.clone().step_by(4).find_map(|at| {
                let entry = self.word(at)?;
                let kind = u32::from(NUMBERED_STRING) | u32::from(TAG) << 16;
                (self.word(entry)? == kind && self.word(entry + 4)? == number)
                    .then(|| self.text(self.word(entry + 8)?))?
            })
        };
        Some(BinaryInfo {
            name: string(NAME)?,
            version: string(VERSION)?,
            board: string(BOARD)?,
        })
    }

    fn from(self, address: u32) -> Option<&'a [u8]> {
        self.0.iter().find_map(|(start, bytes)| {
            let rest = bytes.get(usize::try_from(address.checked_sub(*start)?).ok()?..)?;
            // Where one piece ends the next may begin.
            (!rest.is_empty()).then_some(rest)
        })
    }

    fn word(self, address: u32) -> Option<u32> {
        self.from(address)?
            .first_chunk()
            .copied()
            .map(u32::from_le_bytes)
    }

    fn text(self, address: u32) -> Option<String> {
        let bytes = self.from(address)?;
        let end = bytes.iter().position(|byte| *byte == 0)?;
        String::from_utf8(bytes[..end].to_vec()).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(words: &[u32]) -> Vec<u8> {
        words.iter().flat_map(|word| word.to_le_bytes()).collect()
    }

    #[test]
    fn finds_the_strings_by_their_numbers() {
        let kind = 0x5052_0006;
        let table = FLASH + 0x1000;
        let strings = b"swimmer\x000.1.0, commit 01234567\0pico\0";
        let text = table + 4 * 12;
        let header = words(&[MARKERS[0], table, table + 12, 0, MARKERS[1]]);
        let mut rest = words(&[
            table + 12,
            table + 24,
            table + 36, // entries
            kind,
            BOARD,
            text + 31,
            kind,
            NAME,
            text,
            kind,
            VERSION,
            text + 8,
        ]);
        rest.extend(strings);
        let before = [0; 16];
        let pieces = [
            (FLASH + 0xC0, &header[..]),
            (table - 16, &before[..]),
            (table, &rest[..]),
        ];
        let info = Pieces(&pieces).binary_info().unwrap();
        assert_eq!(info.to_string(), "swimmer 0.1.0, commit 01234567, for pico");
        // Too far from the start, or without its end.
        let far = [(FLASH + 0x200, &header[..]), (table, &rest[..])];
        assert!(Pieces(&far).binary_info().is_err());
        let cut = [(FLASH + 0xC0, &header[..16]), (table, &rest[..])];
        assert!(Pieces(&cut).binary_info().is_err());
        assert!(Pieces(&[]).binary_info().is_err());
    }
}
