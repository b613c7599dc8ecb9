//! UF2, the format of the boot loader's USB drive: blocks of 512 bytes, each with 256 bytes of flash and their address.

use std::collections::BTreeMap;

use crate::{Flash, PAGE, Page};

const BLOCK: usize = 512;
/// Offset of a block's data.
const DATA: usize = 32;
const MAGIC: [u32; 2] = [0x0A32_4655, 0x9E5D_5157];
const MAGIC_END: u32 = 0x0AB1_6F30;
/// The block names its chip in its family word.
const FLAG_FAMILY: u32 = 0x2000;
const FAMILY_RP2040: u32 = 0xE48B_FF56;

/// Reason why bytes are not a UF2 file for the RP2040.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum InvalidUf2 {
    /// The size is not a multiple of a block's.
    #[error("it is no UF2 file: {bytes} bytes are not whole blocks of {BLOCK}")]
    Size {
        /// Size of the file.
        bytes: usize,
    },
    /// A block lacks the format's magic numbers.
    #[error("it is no UF2 file: block {block} has no marks of one")]
    Magic {
        /// Number of the block, from 0.
        block: usize,
    },
    /// The family is another chip's.
    #[error("it is for another chip than the RP2040")]
    Family,
    /// Blocks are missing.
    #[error("it is not whole: block {block} of {blocks} counts {counted}")]
    Incomplete {
        /// Number of the block, from 0.
        block: usize,
        /// Blocks in the file.
        blocks: usize,
        /// Blocks that the file should have, by this block.
        counted: u32,
    },
}

impl Flash {
    /// Reads a UF2 file.
    ///
    /// # Errors
    /// The bytes are not a complete UF2 file for the RP2040.
    pub fn from_uf2(bytes: &[u8]) -> Result<Self, InvalidUf2> {
        let (blocks, rest) = bytes.as_chunks::<BLOCK>();
        if blocks.is_empty() || !rest.is_empty() {
            return Err(InvalidUf2::Size { bytes: bytes.len() });
        }
        let mut pages = BTreeMap::new();
        for (number, block) in blocks.iter().enumerate() {
            let words = block.as_chunks::<4>().0;
            let word = |index: usize| words.get(index).copied().map_or(0, u32::from_le_bytes);
            if [word(0), word(1)] != MAGIC || word(BLOCK / 4 - 1) != MAGIC_END {
                return Err(InvalidUf2::Magic { block: number });
            }
            if word(7) != FAMILY_RP2040 {
                return Err(InvalidUf2::Family);
            }
            if word(4) != PAGE || word(6) as usize != blocks.len() {
                return Err(InvalidUf2::Incomplete {
                    block: number,
                    blocks: blocks.len(),
                    counted: word(6),
                });
            }
            if let Some(data) = block.get(DATA..).and_then(<[u8]>::first_chunk) {
                pages.insert(word(3), *data);
            }
        }
        Ok(Self { pages })
    }

    /// Writes a UF2 file.
    pub fn to_uf2(&self) -> Vec<u8> {
        let count = u32::try_from(self.pages.len()).unwrap_or(u32::MAX);
        (0..)
            .zip(&self.pages)
            .flat_map(|(number, (&address, page))| block(number, count, address, page))
            .collect()
    }
}

fn block(number: u32, count: u32, address: u32, page: &Page) -> [u8; BLOCK] {
    let mut block = [0; BLOCK];
    let head = [
        MAGIC[0],
        MAGIC[1],
        FLAG_FAMILY,
        address,
        PAGE,
        number,
        count,
        FAMILY_RP2040,
    ];
    for (place, word) in block.chunks_exact_mut(4).zip(head) {
        place.copy_from_slice(&word.to_le_bytes());
    }
    block[DATA..][..page.len()].copy_from_slice(page);
    block[BLOCK - 4..].copy_from_slice(&MAGIC_END.to_le_bytes());
    block
}

#[cfg(test)]
mod tests {
    use super::*;

    fn word(file: &[u8], block: usize, place: usize) -> u32 {
        u32::from_le_bytes(file[block * 512 + place..][..4].try_into().unwrap())
    }

    #[test]
    fn blocks_carry_address_number_count_and_data() {
        let segments = [(0x1000_0000, &[1, 2, 3][..]), (0x1000_0100, &[4; 300][..])];
        let file = Flash::from_segments(segments).to_uf2();
        assert_eq!(file.len(), 16 * 512, "one sector");
        for block in 0..16 {
            assert_eq!(word(&file, block, 0), 0x0A32_4655);
            assert_eq!(word(&file, block, 4), 0x9E5D_5157);
            assert_eq!(word(&file, block, 8), 0x2000);
            assert_eq!(
                word(&file, block, 12),
                0x1000_0000 + 256 * u32::try_from(block).unwrap()
            );
            assert_eq!(word(&file, block, 16), 256);
            assert_eq!(word(&file, block, 20), u32::try_from(block).unwrap());
            assert_eq!(word(&file, block, 24), 16);
            assert_eq!(word(&file, block, 28), 0xE48B_FF56);
            assert_eq!(word(&file, block, 508), 0x0AB1_6F30);
        }
        assert_eq!(file[32..36], [1, 2, 3, 0]);
        assert_eq!(file[512 + 32..][..256], [4; 256]);
        assert_eq!(
            file[2 * 512 + 32..][..45],
            [[4; 44].as_slice(), &[0]].concat()
        );
    }

    #[test]
    fn a_segment_across_sectors_fills_both() {
        let file = Flash::from_segments([(0x1000_0FFF, &[7, 8][..])]).to_uf2();
        assert_eq!(file.len(), 32 * 512);
        assert_eq!(file[15 * 512 + 32 + 255], 7);
        assert_eq!(word(&file, 16, 12), 0x1000_1000);
        assert_eq!(file[16 * 512 + 32], 8);
    }

    #[test]
    fn no_segments_make_an_empty_file_which_is_not_read() {
        let file = Flash::from_segments([]).to_uf2();
        assert!(file.is_empty());
        let refused = Flash::from_uf2(&file).unwrap_err();
        assert_eq!(refused, InvalidUf2::Size { bytes: 0 });
    }

    #[test]
    fn an_invalid_file_is_refused() {
        let good = Flash::from_segments([(0x1000_0000, &[9; 512][..])]).to_uf2();
        let refused = |bytes: &[u8]| Flash::from_uf2(bytes).unwrap_err();
        assert_eq!(refused(&good[..700]), InvalidUf2::Size { bytes: 700 });
        let incomplete = InvalidUf2::Incomplete {
            block: 0,
            blocks: 1,
            counted: 16,
        };
        assert_eq!(refused(&good[..512]), incomplete);
        let with = |at: usize, byte: u8| {
            let mut changed = good.clone();
            changed[at] ^= byte;
            refused(&changed)
        };
        assert_eq!(with(0, 1), InvalidUf2::Magic { block: 0 });
        assert_eq!(with(512 + 508, 1), InvalidUf2::Magic { block: 1 });
        // The family of the RP2350.
        assert_eq!(with(28, 0x56 ^ 0x59), InvalidUf2::Family);
    }

    proptest::proptest! {
        #[test]
        fn a_file_that_was_written_is_read_back(
            start in 0x1000_0000_u32..0x1010_0000,
            bytes in proptest::collection::vec(proptest::prelude::any::<u8>(), 1..6000),
        ) {
            let flash = Flash::from_segments([(start, &bytes[..])]);
            proptest::prop_assert_eq!(Flash::from_uf2(&flash.to_uf2()), Ok(flash));
        }
    }
}
