//! Non-volatile memory: two raw slots for tables, a record of settings and a record of short starts.
//!
//! A slot is written in the order erase, data, header. The header carries length, checksum and generation under a checksum of
//! its own. A power cut at any byte leaves that slot invalid and the other intact: old or new, never a mix.

#[cfg(any(test, feature = "testing"))]
mod memory;

use crate::ShortStarts;
#[cfg(any(test, feature = "testing"))]
pub use memory::MemoryStorage;

/// Size of a page, bytes: the unit of [`Storage::program`].
pub const PAGE: usize = 256;
/// Number of table slots.
pub const SLOTS: usize = 2;
/// Capacity of a slot, pages: header and table.
pub const SLOT_PAGES: usize = 1 + link_protocol::MAX_TABLE / PAGE;
/// Largest settings record, bytes.
pub const MAX_SETTINGS: usize = 128;

/// Non-volatile memory. The shell accesses it only in [`crate::Brain::load`] and [`crate::Brain::serve_storage`]; erasing may
/// stall the processor.
pub trait Storage {
    /// Error of the memory. The brain only counts it and tries again later.
    type Error;

    /// Reads bytes of a slot.
    ///
    /// # Errors
    /// The memory cannot be read.
    fn read(&mut self, slot: usize, offset: usize, bytes: &mut [u8]) -> Result<(), Self::Error>;

    /// Erases a slot: all bytes become 0xFF.
    ///
    /// # Errors
    /// The memory cannot be erased.
    fn erase(&mut self, slot: usize) -> Result<(), Self::Error>;

    /// Programs one erased page.
    ///
    /// # Errors
    /// The memory cannot be programmed.
    fn program(&mut self, slot: usize, page: usize, bytes: &[u8; PAGE]) -> Result<(), Self::Error>;

    /// Reads the settings record into `bytes`. Returns `None` if there is no record.
    ///
    /// # Errors
    /// The memory cannot be read.
    fn load_settings(
        &mut self,
        bytes: &mut [u8; MAX_SETTINGS],
    ) -> Result<Option<usize>, Self::Error>;

    /// Replaces the settings record atomically under power cuts.
    ///
    /// # Errors
    /// The memory cannot be written.
    fn save_settings(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;

    /// Reads the record of short starts. Returns false if the record is missing.
    ///
    /// # Errors
    /// The memory cannot be read.
    fn load_starts(&mut self, bytes: &mut [u8; ShortStarts::LEN]) -> Result<bool, Self::Error>;

    /// Replaces the record of short starts atomically under power cuts. At most two calls per start: in [`crate::Brain::load`],
    /// before any pulse, and after the run has lasted a minute.
    ///
    /// # Errors
    /// The memory cannot be written.
    fn save_starts(&mut self, bytes: &[u8; ShortStarts::LEN]) -> Result<(), Self::Error>;
}
