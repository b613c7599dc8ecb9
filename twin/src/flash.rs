//! The twin's non-volatile memory: it outlives a power cut of the twin when its caller keeps it.

use std::convert::Infallible;

use gait_player::storage::{MAX_SETTINGS, PAGE, SLOT_PAGES, SLOTS, Storage};

const SLOT_BYTES: usize = PAGE * SLOT_PAGES;

/// Two table slots and a settings record, in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VirtualFlash {
    slots: [Vec<u8>; SLOTS],
    settings: Option<Vec<u8>>,
}

impl VirtualFlash {
    /// As delivered: nothing stored.
    pub fn erased() -> Self {
        Self {
            slots: std::array::from_fn(|_| vec![0xFF; SLOT_BYTES]),
            settings: None,
        }
    }

    /// Whether anything was ever stored.
    pub fn is_erased(&self) -> bool {
        *self == Self::erased()
    }
}

impl Default for VirtualFlash {
    fn default() -> Self {
        Self::erased()
    }
}

impl Storage for VirtualFlash {
    type Error = Infallible;

    /// Reads like the chip's flash: what lies outside is as if erased.
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
}
