//! Binary information, which `picotool info` prints: program, version, board.
//!
//! The first 512 bytes of flash hold a header: a marker, the addresses of the first entry and past the last one, a table, a
//! marker. Each entry begins with its type and tag; that of a string goes on with its identifier and the string's address.

use std::fmt;

use crate::Flash;

/// Start of flash in the chip's address space.
const FLASH: u32 = 0x1000_0000;
/// The header begins within this many bytes.
const HEADER_WITHIN: u32 = 512;
const MARKERS: [u32; 2] = [0x7188_EBF2, 0xE71A_A390];
/// Most bytes of the list of entries that are read.
const LONGEST_LIST: u32 = 4096;
/// Longer data is not treated as a string.
const LONGEST_STRING: u32 = 128;

/// Type and tag of an entry with a string: `BINARY_INFO_TYPE_ID_AND_STRING`, `RP`.
const STRING_ENTRY: u32 = 6 | (u16::from_le_bytes(*b"RP") as u32) << 16;
const PROGRAM_NAME: u32 = 0x0203_1C86;
const PROGRAM_VERSION: u32 = 0x11A9_BC3A;
const PICO_BOARD: u32 = 0xB63C_FFBB;

/// Strings of the binary information.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BinaryInfo {
    /// Name of the program.
    pub program: Option<String>,
    /// Version of the program.
    pub version: Option<String>,
    /// Board, by the name that the Pico SDK gives it.
    pub board: Option<String>,
}

impl fmt::Display for BinaryInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [program, version, board] = [&self.program, &self.version, &self.board]
            .map(|text| text.as_deref().unwrap_or("unnamed"));
        write!(f, "{program} {version} for {board}")
    }
}

impl Flash {
    /// Reads the binary information; strings that are missing or invalid are `None`.
    pub fn binary_info(&self) -> BinaryInfo {
        BinaryInfo {
            program: self.numbered_string(PROGRAM_NAME),
            version: self.numbered_string(PROGRAM_VERSION),
            board: self.numbered_string(PICO_BOARD),
        }
    }

    /// Returns the string with this identifier.
    fn numbered_string(&self, identifier: u32) -> Option<String> {
        let header = (FLASH..FLASH + HEADER_WITHIN)
            .step_by(4)
            .find(|&at| [self.word(at), self.word(at + 16)] == MARKERS.map(Some))?;
        let (first, end) = (self.word(header + 4)?, self.word(header + 8)?);
        (first..end.min(first.saturating_add(LONGEST_LIST)))
            .step_by(4)
            .filter_map(|at| self.word(at))
            .find(|&entry| self.is_string_entry(entry, identifier))
            .and_then(|entry| self.string(self.word(entry.checked_add(8)?)?))
    }

    fn is_string_entry(&self, entry: u32, identifier: u32) -> bool {
        let second = entry.checked_add(4).and_then(|at| self.word(at));
        self.word(entry) == Some(STRING_ENTRY) && second == Some(identifier)
    }

    /// Returns the string that begins at an address and ends before a zero.
    fn string(&self, start: u32) -> Option<String> {
        let bytes: Vec<u8> = (start..start.saturating_add(LONGEST_STRING))
            .map_while(|at| self.byte(at).filter(|&byte| byte != 0))
            .collect();
        let end = start.checked_add(u32::try_from(bytes.len()).ok()?)?;
        (self.byte(end) == Some(0)).then(|| String::from_utf8(bytes).ok())?
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(words: &[u32]) -> Vec<u8> {
        words.iter().flat_map(|word| word.to_le_bytes()).collect()
    }

    const TABLE: u32 = FLASH + 0x1000;

    fn header() -> Vec<u8> {
        words(&[MARKERS[0], TABLE, TABLE + 12, 0, MARKERS[1]])
    }

    /// Three addresses of entries, three entries, and their strings.
    fn table() -> Vec<u8> {
        let text = TABLE + 4 * 12;
        let mut table = words(&[TABLE + 12, TABLE + 24, TABLE + 36]);
        for (identifier, offset) in [(PICO_BOARD, 31), (PROGRAM_NAME, 0), (PROGRAM_VERSION, 8)] {
            table.extend(words(&[0x5052_0006, identifier, text + offset]));
        }
        table.extend(b"swimmer\x000.1.0, commit 01234567\0pico\0");
        table
    }

    fn info(header_at: u32, header: &[u8], table: &[u8]) -> BinaryInfo {
        Flash::from_segments([(header_at, header), (TABLE, table)]).binary_info()
    }

    #[test]
    fn strings_are_found_by_their_identifiers() {
        let info = info(FLASH + 0xC0, &header(), &table());
        assert_eq!(info.to_string(), "swimmer 0.1.0, commit 01234567 for pico");
        assert_eq!(info.board.as_deref(), Some("pico"));
    }

    #[test]
    fn a_header_that_is_cut_or_too_far_away_has_no_strings() {
        let far = info(FLASH + 0x200, &header(), &table());
        let cut = info(FLASH + 0xC0, &header()[..16], &table());
        let empty = Flash::from_segments([]).binary_info();
        for info in [far, cut, empty] {
            assert_eq!(info.to_string(), "unnamed unnamed for unnamed");
        }
    }

    #[test]
    fn a_long_string_is_invalid_and_the_others_stay() {
        let mut table = table();
        table.truncate(table.len() - 5);
        table.extend([b'x'; 200]);
        let info = info(FLASH + 0xC0, &header(), &table);
        assert_eq!(info.board, None);
        assert_eq!(info.program.as_deref(), Some("swimmer"));
    }

    #[test]
    fn any_bytes_can_be_read() {
        let good = [header(), vec![0; 0x1000 - 0xC0 - 20], table()].concat();
        for place in 0..good.len() {
            let mut changed = good.clone();
            changed[place] ^= 0xFF;
            let _ = Flash::from_segments([(FLASH + 0xC0, &changed[..])]).binary_info();
        }
    }
}
