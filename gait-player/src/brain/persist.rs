//! Storing what is not stored yet, in bounded steps, while the robot is stopped: erase, pages, header (see
//! [`crate::storage`] for why a power cut at any byte leaves the old table or the new one).

use crate::storage::{PAGE, SLOTS, Storage};
use crate::{GaitTable, ShortStarts};
use link_protocol::{MAX_TABLE, crc32c};

const MAGIC: u32 = u32::from_le_bytes(*b"GAIT");
const FORMAT: u32 = 1;
const HEADER: usize = 24;
/// After a failure the storage is left alone for so long.
const RETRY_US: u64 = 1_000_000;

/// What is stored, and how far the rest is.
#[derive(Clone)]
pub(crate) struct Persist {
    /// Slot and generation of the newest whole table.
    newest: Option<(usize, u32)>,
    step: Step,
    settings_unsaved: bool,
    /// The record of short starts to be stored.
    starts_unsaved: Option<ShortStarts>,
    /// The last try to store them failed: a table goes first.
    settings_failed: bool,
    failed_us: Option<u64>,
    /// What was stored could not be read, and nothing was stored since.
    lost: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Idle,
    Erase,
    Page(usize),
    Header,
}

impl Persist {
    pub(crate) const fn new() -> Self {
        Self {
            newest: None,
            step: Step::Idle,
            settings_unsaved: false,
            starts_unsaved: None,
            settings_failed: false,
            failed_us: None,
            lost: false,
        }
    }

    /// The active table is another one now.
    pub(crate) fn table_changed(&mut self) {
        self.step = Step::Erase;
    }

    pub(crate) fn settings_changed(&mut self) {
        self.settings_unsaved = true;
    }

    pub(crate) fn starts_changed(&mut self, starts: ShortStarts) {
        self.starts_unsaved = Some(starts);
    }

    pub(crate) fn table_stored(&self) -> bool {
        self.step == Step::Idle
    }

    pub(crate) fn unsaved(&self) -> bool {
        self.settings_unsaved || !self.table_stored()
    }

    /// Nothing waits to be stored.
    pub(crate) fn all_stored(&self) -> bool {
        !self.unsaved() && self.starts_unsaved.is_none()
    }

    /// There is something to store, and no failure just now.
    pub(crate) fn wanted(&self, now_us: u64) -> bool {
        !self.all_stored()
            && self
                .failed_us
                .is_none_or(|failed| now_us.saturating_sub(failed) >= RETRY_US)
    }

    pub(crate) fn failed(&self) -> bool {
        self.lost || self.failed_us.is_some()
    }

    /// What was stored could not be read.
    pub(crate) fn lost(&mut self) {
        self.lost = true;
    }

    /// Reads both slots into both buffers; returns which holds the newest whole table, and what kept a slot from being
    /// read: it does not keep the other.
    pub(crate) fn load<S: Storage>(
        &mut self,
        storage: &mut S,
        buffers: &mut [GaitTable; SLOTS],
    ) -> (Option<usize>, Result<(), S::Error>) {
        let mut outcome = Ok(());
        for (slot, buffer) in buffers.iter_mut().enumerate() {
            match read_slot(storage, slot, buffer) {
                Ok(Some(generation))
                    if self
                        .newest
                        .is_none_or(|(_, newest)| newer(generation, newest)) =>
                {
                    self.newest = Some((slot, generation));
                }
                Ok(_) => {}
                Err(error) => outcome = Err(error),
            }
        }
        (self.newest.map(|(slot, _)| slot), outcome)
    }

    /// One step.
    pub(crate) fn step<S: Storage>(
        &mut self,
        now_us: u64,
        storage: &mut S,
        table: Option<&GaitTable>,
        settings: &[u8],
    ) -> Result<(), S::Error> {
        let was_unsaved = self.unsaved();
        let result = self.try_step(storage, table, settings);
        self.failed_us = if result.is_err() { Some(now_us) } else { None };
        // The record of starts says nothing of what was lost.
        self.lost &= result.is_err() || !was_unsaved;
        if result.is_err() && self.step != Step::Idle {
            // Nothing is known of the slot now.
            self.step = Step::Erase;
        }
        result
    }

    fn try_step<S: Storage>(
        &mut self,
        storage: &mut S,
        table: Option<&GaitTable>,
        settings: &[u8],
    ) -> Result<(), S::Error> {
        if self.settings_unsaved && (self.table_stored() || !self.settings_failed) {
            self.settings_failed = true;
            storage.save_settings(settings)?;
            (self.settings_failed, self.settings_unsaved) = (false, false);
            return Ok(());
        }
        if let Some(starts) = self.starts_unsaved.filter(|_| self.table_stored()) {
            storage.save_starts(&starts.encode())?;
            self.starts_unsaved = None;
            return Ok(());
        }
        let Some(table) = table else {
            self.step = Step::Idle;
            return Ok(());
        };
        // Never the slot that holds the newest whole table.
        let (slot, generation) = self.newest.map_or((0, 1), |(slot, newest)| {
            ((slot + 1) % SLOTS, newest.wrapping_add(1))
        });
        match self.step {
            Step::Idle => {}
            Step::Erase => {
                storage.erase(slot)?;
                self.step = Step::Page(0);
            }
            Step::Page(page) => {
                let from = page * PAGE;
                let data = table.bytes().get(from..).unwrap_or_default();
                storage.program(slot, 1 + page, &padded(&data[..data.len().min(PAGE)]))?;
                self.step = if data.len() > PAGE {
                    Step::Page(page + 1)
                } else {
                    Step::Header
                };
            }
            Step::Header => {
                storage.program(slot, 0, &padded(&header(table, generation)))?;
                self.newest = Some((slot, generation));
                self.step = Step::Idle;
            }
        }
        Ok(())
    }
}

fn newer(generation: u32, than: u32) -> bool {
    generation.wrapping_sub(than) < 1 << 31
}

fn padded(bytes: &[u8]) -> [u8; PAGE] {
    let mut page = [0xFF; PAGE];
    page[..bytes.len()].copy_from_slice(bytes);
    page
}

/// `magic | format | generation | len | CRC-32C of the table | CRC-32C of these`, u32 little-endian.
fn header(table: &GaitTable, generation: u32) -> [u8; HEADER] {
    let mut bytes = [0; HEADER];
    let words = [
        MAGIC,
        FORMAT,
        generation,
        table.bytes().len() as u32,
        table.crc32(),
    ];
    for (place, word) in bytes.chunks_exact_mut(4).zip(words) {
        place.copy_from_slice(&word.to_le_bytes());
    }
    let crc = crc32c(&bytes[..HEADER - 4]);
    bytes[HEADER - 4..].copy_from_slice(&crc.to_le_bytes());
    bytes
}

/// Reads a slot; its generation where it holds a whole table.
fn read_slot<S: Storage>(
    storage: &mut S,
    slot: usize,
    table: &mut GaitTable,
) -> Result<Option<u32>, S::Error> {
    let mut bytes = [0; HEADER];
    storage.read(slot, 0, &mut bytes)?;
    let word = |index: usize| u32::from_le_bytes(core::array::from_fn(|i| bytes[4 * index + i]));
    let len = word(3) as usize;
    let whole = word(0) == MAGIC && word(1) == FORMAT && word(5) == crc32c(&bytes[..HEADER - 4]);
    if !whole || len > MAX_TABLE || !len.is_multiple_of(crate::table::KNOT_BYTES) {
        return Ok(None);
    }
    storage.read(
        slot,
        PAGE,
        table.buffer((len / crate::table::KNOT_BYTES) as u16),
    )?;
    Ok((table.knots() >= crate::table::MIN_KNOTS && table.crc32() == word(4)).then_some(word(2)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::storage::MemoryStorage;

    #[test]
    fn what_was_lost_is_told_until_it_is_stored_anew() {
        let mut flash = MemoryStorage::erased();
        let mut persist = Persist::new();
        persist.lost();
        // The record of starts says nothing of settings or table.
        persist.starts_changed(ShortStarts { runs: 1 });
        let Ok(()) = persist.step(0, &mut flash, None, &[7]);
        assert!(persist.all_stored() && persist.failed());
        persist.settings_changed();
        let Ok(()) = persist.step(0, &mut flash, None, &[7]);
        assert!(persist.all_stored() && !persist.failed());
        assert_eq!(flash.settings.as_deref(), Some(&[7][..]));
    }
}
