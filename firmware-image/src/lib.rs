//! Firmware images of the RP2040: what goes into flash, as a UF2 file, and the binary information in it.
//!
//! ```
//! use firmware_image::Flash;
//!
//! let flash = Flash::from_segments([(0x1000_0000, &[1, 2, 3][..])]);
//! let file = flash.to_uf2();
//! assert_eq!(Flash::from_uf2(&file)?, flash);
//! assert_eq!(flash.binary_info().program, None);
//! # Ok::<(), firmware_image::InvalidUf2>(())
//! ```

mod binary_info;
mod uf2;

use std::collections::BTreeMap;

pub use binary_info::BinaryInfo;
pub use uf2::InvalidUf2;

/// Bytes that one UF2 block carries, and the unit in which flash is written.
const PAGE: u32 = 256;
type Page = [u8; PAGE as usize];
/// Bytes that the boot ROM erases at once.
const SECTOR: u32 = 4096;

/// Contents of flash memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Flash {
    /// Pages by their address.
    pages: BTreeMap<u32, Page>,
}

impl Flash {
    /// Fills flash with segments, each an address and its bytes.
    ///
    /// The rest of every sector that they touch is zeros: the boot ROM mishandles partly filled sectors (erratum RP2040-E14).
    pub fn from_segments<'a>(segments: impl IntoIterator<Item = (u32, &'a [u8])>) -> Self {
        let mut pages: BTreeMap<u32, Page> = BTreeMap::new();
        for (start, bytes) in segments {
            for (address, &byte) in (start..).zip(bytes) {
                let sector = address - address % SECTOR;
                if !pages.contains_key(&sector) {
                    let all = (sector..=sector | (SECTOR - 1)).step_by(PAGE as usize);
                    pages.extend(all.map(|page| (page, [0; PAGE as usize])));
                }
                let offset = address % PAGE;
                if let Some(page) = pages.get_mut(&(address - offset)) {
                    page[offset as usize] = byte;
                }
            }
        }
        Self { pages }
    }

    fn byte(&self, address: u32) -> Option<u8> {
        let (start, page) = self.pages.range(..=address).next_back()?;
        page.get((address - start) as usize).copied()
    }

    fn word(&self, address: u32) -> Option<u32> {
        let mut bytes = [0; 4];
        for (offset, byte) in (0..).zip(&mut bytes) {
            *byte = self.byte(address.checked_add(offset)?)?;
        }
        Some(u32::from_le_bytes(bytes))
    }
}
