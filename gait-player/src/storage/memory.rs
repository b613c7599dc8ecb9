//! Storage in memory that behaves like the chip's flash, for tests and virtual robots.

extern crate std;

use core::fmt;
use std::convert::Infallible;
use std::vec::Vec;

use super::{MAX_SETTINGS, PAGE, SLOT_PAGES, SLOTS, Storage};
use crate::ShortStarts;

const SLOT_BYTES: usize = PAGE * SLOT_PAGES;

/// In-memory storage: two table slots, a settings record and the record of short starts.
#[derive(Clone, PartialEq, Eq)]
pub struct MemoryStorage {
    /// Bytes of the table slots.
    pub slots: [Vec<u8>; SLOTS],
    /// The settings record.
    pub settings: Option<Vec<u8>>,
    /// The record of short starts.
    pub starts: Option<[u8; ShortStarts::LEN]>,
}

impl MemoryStorage {
    /// Returns an erased storage, as delivered.
    pub fn erased() -> Self {
        Self {
            slots: core::array::from_fn(|_| std::vec![0xFF; SLOT_BYTES]),
            settings: None,
            starts: None,
        }
    }
}

/// Omits the settings record, which holds the key.
impl fmt::Debug for MemoryStorage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MemoryStorage")
            .field("slots", &self.slots)
            .field("settings", &self.settings.as_ref().map(Vec::len))
            .field("starts", &self.starts)
            .finish()
    }
}

impl Default for MemoryStorage {
    fn default() -> Self {
        Self::erased()
    }
}

impl Storage for MemoryStorage {
    type Error = Infallible;

    /// Reads like the chip's flash: bytes outside a slot read as erased.
    fn read(&mut self, slot: usize, offset: usize, bytes: &mut [u8]) -> Result<(), Infallible> {
        bytes.fill(0xFF);
        if let Some(stored) = self.slots.get(slot).and_then(|slot| slot.get(offset..)) {
            let count = stored.len().min(bytes.len());
            bytes[..count].copy_from_slice(&stored[..count]);
        }
        Ok(())
    }

    fn erase(&mut self, slot: usize) -> Result<(), Infallible> {
        if let Some(slot) = self.slots.get_mut(slot) {
            slot.fill(0xFF);
        }
        Ok(())
    }

    /// Programs like the chip's flash: bits can only be cleared.
    fn program(&mut self, slot: usize, page: usize, bytes: &[u8; PAGE]) -> Result<(), Infallible> {
        let start = page * PAGE;
        if let Some(stored) = self
            .slots
            .get_mut(slot)
            .and_then(|slot| slot.get_mut(start..start + PAGE))
        {
            for (stored, byte) in stored.iter_mut().zip(bytes) {
                *stored &= byte;
            }
        }
        Ok(())
    }

    fn load_settings(
        &mut self,
        bytes: &mut [u8; MAX_SETTINGS],
    ) -> Result<Option<usize>, Infallible> {
        Ok(self.settings.as_ref().map(|settings| {
            let count = settings.len().min(MAX_SETTINGS);
            bytes[..count].copy_from_slice(&settings[..count]);
            count
        }))
    }

    fn save_settings(&mut self, bytes: &[u8]) -> Result<(), Infallible> {
        self.settings = Some(bytes.to_vec());
        Ok(())
    }

    fn load_starts(&mut self, bytes: &mut [u8; ShortStarts::LEN]) -> Result<bool, Infallible> {
        if let Some(starts) = &self.starts {
            *bytes = *starts;
        }
        Ok(self.starts.is_some())
    }

    fn save_starts(&mut self, bytes: &[u8; ShortStarts::LEN]) -> Result<(), Infallible> {
        self.starts = Some(*bytes);
        Ok(())
    }
}
