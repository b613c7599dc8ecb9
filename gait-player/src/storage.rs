//! Non-volatile memory: two raw slots for tables and one record of settings.
//!
//! A slot is written in the order erase, data, header; its header carries length, checksum and generation under a
//! checksum of its own. A cut at any byte leaves that slot invalid and the other as it was: old or new, never a mix.

#[cfg(any(test, feature = "testing"))]
mod memory;

use crate::ShortStarts;
#[cfg(any(test, feature = "testing"))]
pub use memory::MemoryStorage;

/// Bytes of a page: the unit of [`Storage::program`].
pub const PAGE: usize = 256;
/// Number of table slots.
pub const SLOTS: usize = 2;
/// Pages a slot must hold: header and table.
pub const SLOT_PAGES: usize = 1 + link_protocol::MAX_TABLE / PAGE;
/// Most bytes of the settings record.
pub const MAX_SETTINGS: usize = 128;

/// Non-volatile memory. The shell serves it only from [`crate::Brain::load`] and
/// [`crate::Brain::serve_storage`]; erasing may stall the processor.
pub trait Storage {
    /// What can go wrong; the brain only counts it and tries again later.
    type Error;

    /// Reads bytes of a slot.
    ///
    /// # Errors
    /// The memory cannot be read.
    fn read(&mut self, slot: usize, offset: usize, bytes: &mut [u8]) -> Result<(), Self::Error>;

    /// Erases a slot: all bytes 0xFF.
    ///
    /// # Errors
    /// The memory cannot be erased.
    fn erase(&mut self, slot: usize) -> Result<(), Self::Error>;

    /// Programs one erased page.
    ///
    /// # Errors
    /// The memory cannot be programmed.
    fn program(&mut self, slot: usize, page: usize, bytes: &[u8; PAGE]) -> Result<(), Self::Error>;

    /// Reads the settings record into `bytes`; `None` where there is none.
    ///
    /// # Errors
    /// The memory cannot be read.
    fn load_settings(
        &mut self,
        bytes: &mut [u8; MAX_SETTINGS],
    ) -> Result<Option<usize>, Self::Error>;

    /// Replaces the settings record, old or new over a power cut.
    ///
    /// # Errors
    /// The memory cannot be written.
    fn save_settings(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;

    /// Reads the record of short starts; false where there is none.
    ///
    /// # Errors
    /// The memory cannot be read.
    fn load_starts(&mut self, bytes: &mut [u8; ShortStarts::LEN]) -> Result<bool, Self::Error>;

    /// Replaces it, old or new over a power cut. Asked for at most twice a start: from [`crate::Brain::load`], before any pulse,
    /// and once the run has lasted for a minute.
    ///
    /// # Errors
    /// The memory cannot be written.
    fn save_starts(&mut self, bytes: &[u8; ShortStarts::LEN]) -> Result<(), Self::Error>;
}
