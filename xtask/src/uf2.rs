//! UF2, the format of the RP2040's USB boot drive: 512-byte blocks, each with 256 bytes of flash and its address.

use std::collections::BTreeMap;

/// Bytes of flash a block carries.
const PAGE: u32 = 256;
/// What the boot ROM erases at once.
const SECTOR: u32 = 4096;
const MAGIC: [u32; 2] = [0x0A32_4655, 0x9E5D_5157];
const MAGIC_END: u32 = 0x0AB1_6F30;
const FLAG_FAMILY: u32 = 0x2000;
const FAMILY_RP2040: u32 = 0xE48B_FF56;

/// The UF2 file of pieces of flash given as (address, bytes).
///
/// Every sector that is touched is filled up with zeros: the boot ROM mishandles partly filled ones (erratum RP2040-E14).
pub(crate) fn from_segments<'a>(segments: impl IntoIterator<Item = (u32, &'a [u8])>) -> Vec<u8> {
    let mut sectors: BTreeMap<u32, [u8; SECTOR as usize]> = BTreeMap::new();
    for (start, bytes) in segments {
        for (address, &byte) in (start..).zip(bytes) {
            let offset = address % SECTOR;
            sectors
                .entry(address - offset)
                .or_insert([0; SECTOR as usize])[offset as usize] = byte;
        }
    }
    let pages = sectors.iter().flat_map(|(&start, sector)| {
        (start..)
            .step_by(PAGE as usize)
            .zip(sector.chunks_exact(PAGE as usize))
    });
    let count = u32::try_from(sectors.len()).unwrap_or(u32::MAX) * (SECTOR / PAGE);
    (0..)
        .zip(pages)
        .flat_map(|(number, (address, page))| block(number, count, address, page))
        .collect()
}

fn block(number: u32, count: u32, address: u32, page: &[u8]) -> [u8; 512] {
    let mut block = [0; 512];
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
    block[32..][..page.len()].copy_from_slice(page);
    block[508..].copy_from_slice(&MAGIC_END.to_le_bytes());
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
        let file = from_segments([(0x1000_0000, &[1, 2, 3][..]), (0x1000_0100, &[4; 300][..])]);
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
        let file = from_segments([(0x1000_0FFF, &[7, 8][..])]);
        assert_eq!(file.len(), 32 * 512);
        assert_eq!(file[15 * 512 + 32 + 255], 7);
        assert_eq!(word(&file, 16, 12), 0x1000_1000);
        assert_eq!(file[16 * 512 + 32], 8);
    }

    #[test]
    fn nothing_in_nothing_out() {
        assert!(from_segments([]).is_empty());
    }
}
