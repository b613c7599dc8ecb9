//! A UF2 file looked into before it goes onto a board: whole, for this chip, and what it says of itself (the binary information
//! that `picotool info` reads).

use std::collections::BTreeMap;
use std::fmt;

use link_protocol::Board;

/// A block of UF2: 32 bytes of head, 256 of flash, an end mark.
const BLOCK: usize = 512;
const PAYLOAD_AT: usize = 32;
const PAYLOAD: usize = 256;
const MAGIC: [u32; 3] = [0x0A32_4655, 0x9E5D_5157, 0x0AB1_6F30];
const FAMILY_RP2040: u32 = 0xE48B_FF56;
/// Where flash begins.
const FLASH: u32 = 0x1000_0000;
/// The head of the binary information lies in so many first bytes of the program.
const HEAD_WITHIN: u32 = 4096;
const HEAD: [u32; 2] = [0x7188_EBF2, 0xE71A_A390];
/// Entries that are a text under a number.
const TYPE_ID_AND_STRING: u16 = 6;
const TAG_RASPBERRY_PI: u16 = 0x5052;
const PROGRAM_NAME: u32 = 0x0203_1C86;
const PROGRAM_VERSION: u32 = 0x11A9_BC3A;
const PICO_BOARD: u32 = 0xB63C_FFBB;
/// Longer texts are none.
const LONGEST_TEXT: u32 = 128;

/// What an image says of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Image {
    pub(super) program: Option<String>,
    /// Version and commit.
    pub(super) version: Option<String>,
    /// The board as the maker's tools name it.
    board: Option<String>,
}

impl Image {
    /// Looks into a UF2 file.
    ///
    /// # Errors
    /// Why it is none for this chip, as a clause.
    pub(super) fn of_uf2(bytes: &[u8]) -> Result<Self, String> {
        let flash = Flash::of_uf2(bytes)?;
        Ok(Self {
            program: flash.text(PROGRAM_NAME),
            version: flash.text(PROGRAM_VERSION),
            board: flash.text(PICO_BOARD),
        })
    }

    /// The board that it was built for, where it says so.
    pub(super) fn board(&self) -> Option<Board> {
        match self.board.as_deref()? {
            "pico" => Some(Board::Pico),
            "arduino_nano_rp2040_connect" => Some(Board::NanoRp2040Connect),
            _ => None,
        }
    }

    /// It is a robot's firmware.
    pub(super) fn is_ours(&self) -> bool {
        self.program.as_deref() == Some("swimmer")
    }
}

impl fmt::Display for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let said = |text: &Option<String>| text.clone().unwrap_or_else(|| "unnamed".to_owned());
        write!(
            f,
            "{} {} for {}",
            said(&self.program),
            said(&self.version),
            said(&self.board)
        )
    }
}

/// The flash that a file fills, by address.
struct Flash(BTreeMap<u32, Vec<u8>>);

impl Flash {
    fn of_uf2(bytes: &[u8]) -> Result<Self, String> {
        let (blocks, rest) = bytes.as_chunks::<BLOCK>();
        if blocks.is_empty() || !rest.is_empty() {
            return Err(format!(
                "it is no UF2 file: {} bytes are not whole blocks of {BLOCK}",
                bytes.len()
            ));
        }
        let mut pages = BTreeMap::new();
        for (number, block) in blocks.iter().enumerate() {
            let at = |place: usize| word(block, place).unwrap_or_default();
            if [at(0), at(4), at(BLOCK - 4)] != MAGIC {
                return Err(format!(
                    "it is no UF2 file: block {number} has no marks of one"
                ));
            }
            if at(28) != FAMILY_RP2040 {
                return Err("it is for another chip than the RP2040".to_owned());
            }
            if at(16) as usize != PAYLOAD || at(24) as usize != blocks.len() {
                return Err(format!(
                    "it is not whole: block {number} of {} counts {}",
                    blocks.len(),
                    at(24)
                ));
            }
            let payload = block.get(PAYLOAD_AT..PAYLOAD_AT + PAYLOAD);
            pages.insert(at(12), payload.unwrap_or_default().to_vec());
        }
        Ok(Self(pages))
    }

    fn byte(&self, address: u32) -> Option<u8> {
        let (start, page) = self.0.range(..=address).next_back()?;
        page.get((address - start) as usize).copied()
    }

    fn word(&self, address: u32) -> Option<u32> {
        let mut bytes = [0; 4];
        for (place, byte) in (0..).zip(&mut bytes) {
            *byte = self.byte(address.checked_add(place)?)?;
        }
        Some(u32::from_le_bytes(bytes))
    }

    /// The text under a number of the maker's.
    fn text(&self, id: u32) -> Option<String> {
        let head = (FLASH..FLASH + HEAD_WITHIN)
            .step_by(4)
            .find(|&at| self.word(at) == Some(HEAD[0]) && self.word(at + 16) == Some(HEAD[1]))?;
        let (first, end) = (self.word(head + 4)?, self.word(head + 8)?);
        let entries = (first..end.min(first.saturating_add(HEAD_WITHIN))).step_by(4);
        entries
            .filter_map(|entry| self.word(entry))
            .find_map(|entry| {
                let kind = self.word(entry)?;
                let wanted = u32::from(TYPE_ID_AND_STRING) | u32::from(TAG_RASPBERRY_PI) << 16;
                (kind == wanted && self.word(entry.checked_add(4)?)? == id)
                    .then(|| self.word(entry.checked_add(8)?))
                    .flatten()
            })
            .and_then(|text| self.string(text))
    }

    fn string(&self, start: u32) -> Option<String> {
        let bytes: Vec<u8> = (start..start.saturating_add(LONGEST_TEXT))
            .map_while(|at| self.byte(at).filter(|&byte| byte != 0))
            .collect();
        String::from_utf8(bytes).ok()
    }
}

fn word(bytes: &[u8], place: usize) -> Option<u32> {
    let bytes = bytes.get(place..place + 4)?;
    Some(u32::from_le_bytes(bytes.try_into().ok()?))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A program of one page with the binary information of a board, built by the format's own description.
    pub(in super::super) fn uf2(board: &str, family: u32) -> Vec<u8> {
        let mut flash = vec![0_u8; 512];
        let mut put = |at: usize, words: &[u32]| {
            for (place, word) in words.iter().enumerate() {
                flash[at + 4 * place..][..4].copy_from_slice(&word.to_le_bytes());
            }
        };
        put(0x40, &[HEAD[0], FLASH + 0x60, FLASH + 0x6C, 0, HEAD[1]]);
        put(0x60, &[FLASH + 0x80, FLASH + 0x90, FLASH + 0xA0]);
        for (entry, (id, text)) in [
            (PROGRAM_NAME, 0x100),
            (PROGRAM_VERSION, 0x120),
            (PICO_BOARD, 0x160),
        ]
        .into_iter()
        .enumerate()
        {
            put(0x80 + 0x10 * entry, &[0x5052_0006, id, FLASH + text]);
        }
        for (at, text) in [
            (0x100, "swimmer"),
            (0x120, "0.1.0, commit 0123abcd"),
            (0x160, board),
        ] {
            flash[at..at + text.len()].copy_from_slice(text.as_bytes());
        }
        let mut file = Vec::new();
        for (number, page) in (0..).zip(flash.chunks_exact(PAYLOAD)) {
            let mut block = [0; BLOCK];
            let address = FLASH + 256 * number;
            let head = [MAGIC[0], MAGIC[1], 0x2000, address, 256, number, 2, family];
            for (place, word) in head.iter().enumerate() {
                block[4 * place..][..4].copy_from_slice(&word.to_le_bytes());
            }
            block[PAYLOAD_AT..][..PAYLOAD].copy_from_slice(page);
            block[BLOCK - 4..].copy_from_slice(&MAGIC[2].to_le_bytes());
            file.extend(block);
        }
        file
    }

    #[test]
    fn an_image_tells_its_program_version_and_board() {
        let image = Image::of_uf2(&uf2("pico", FAMILY_RP2040)).unwrap();
        assert!(image.is_ours());
        assert_eq!(image.board(), Some(Board::Pico));
        assert_eq!(image.to_string(), "swimmer 0.1.0, commit 0123abcd for pico");
        let nano = Image::of_uf2(&uf2("arduino_nano_rp2040_connect", FAMILY_RP2040)).unwrap();
        assert_eq!(nano.board(), Some(Board::NanoRp2040Connect));
    }

    #[test]
    fn what_is_no_image_for_this_chip_is_told() {
        let good = uf2("pico", FAMILY_RP2040);
        let told = |bytes: &[u8]| Image::of_uf2(bytes).unwrap_err();
        assert!(told(&[]).contains("no UF2"));
        assert!(told(&good[..700]).contains("no UF2"));
        assert!(told(&good[..512]).contains("not whole"));
        assert!(told(&uf2("pico", 0xE48B_FF59)).contains("another chip"));
        let mut broken = good.clone();
        broken[0] ^= 1;
        assert!(told(&broken).contains("no UF2"));
        // Anything may stand in it: it says nothing then, and nothing breaks.
        for place in (32..good.len()).step_by(7) {
            let mut other = good.clone();
            other[place] ^= 0xFF;
            let _ = Image::of_uf2(&other);
        }
    }
}
