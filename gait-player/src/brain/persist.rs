//! Storing of changed tables and settings while the robot is stopped, in bounded steps: erase, pages, header.
//! [`crate::storage`] explains why a power cut at any byte leaves the old table or the new one. Stored content is not written
//! again, and a budget limits the rate of writes: flash bears about 100 000 erasures.

use crate::storage::{MAX_SETTINGS, PAGE, SLOTS, Storage};
use crate::{GaitTable, ShortStarts};
use link_protocol::{MAX_TABLE, crc32c};

const MAGIC: u32 = u32::from_le_bytes(*b"GAIT");
const FORMAT: u32 = 1;
const HEADER: usize = 24;
/// Pause after a storage failure, µs.
const RETRY_US: u64 = 1_000_000;

/// Size of the write budget; see [`WRITE_EVERY_US`].
const WRITES_AT_ONCE: u64 = 32;
/// Time after which the budget allows one more write, µs.
const WRITE_EVERY_US: u64 = 120_000_000;

/// Progress of storing.
#[derive(Clone)]
pub(crate) struct Persist {
    /// Slot and generation of the newest whole table.
    newest: Option<(usize, u32)>,
    step: Step,
    settings_unsaved: bool,
    /// Record of short starts to store.
    starts_unsaved: Option<ShortStarts>,
    /// The last write of the settings failed, so a table has priority.
    settings_failed: bool,
    failed_us: Option<u64>,
    /// A stored record could not be read, and nothing was stored since.
    lost: bool,
    budget: WearBudget,
}

/// Token bucket that limits flash writes.
#[derive(Clone, Copy, Debug)]
struct WearBudget {
    /// Tokens at `since_us`.
    left: u64,
    since_us: u64,
    /// A change with presence: the next write needs no token.
    granted: bool,
}

impl WearBudget {
    const fn full() -> Self {
        Self {
            left: WRITES_AT_ONCE,
            since_us: 0,
            granted: false,
        }
    }

    fn allows(&self, now_us: u64) -> bool {
        self.granted || self.left > 0 || now_us.saturating_sub(self.since_us) >= WRITE_EVERY_US
    }

    fn spend(&mut self, now_us: u64) {
        if core::mem::take(&mut self.granted) {
            return;
        }
        let earned = now_us.saturating_sub(self.since_us) / WRITE_EVERY_US;
        self.left = self.left.saturating_add(earned).min(WRITES_AT_ONCE);
        self.since_us = if self.left == WRITES_AT_ONCE {
            now_us
        } else {
            self.since_us.saturating_add(earned * WRITE_EVERY_US)
        };
        self.left = self.left.saturating_sub(1);
    }
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
            budget: WearBudget::full(),
        }
    }

    /// Grants the next write regardless of the budget, after a change with presence.
    pub(crate) fn grant(&mut self) {
        self.budget.granted = true;
    }

    /// Marks the active table as changed.
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

    /// Returns true if nothing waits to be stored.
    pub(crate) fn all_stored(&self) -> bool {
        !self.unsaved() && self.starts_unsaved.is_none()
    }

    /// Returns true if something waits to be stored, the budget allows it and no failure is recent.
    pub(crate) fn wanted(&self, now_us: u64) -> bool {
        let costs = self.settings_unsaved || self.step == Step::Erase;
        !self.all_stored()
            && (!costs || self.budget.allows(now_us))
            && self
                .failed_us
                .is_none_or(|failed| now_us.saturating_sub(failed) >= RETRY_US)
    }

    pub(crate) fn failed(&self) -> bool {
        self.lost || self.failed_us.is_some()
    }

    /// Records that a stored record could not be read.
    pub(crate) fn lost(&mut self) {
        self.lost = true;
    }

    /// Reads both slots into both buffers. Returns the slot of the newest valid table, and the read error of a slot if any; an
    /// error in one slot does not affect the other.
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

    /// Does one storage step.
    pub(crate) fn step<S: Storage>(
        &mut self,
        now_us: u64,
        storage: &mut S,
        table: Option<&GaitTable>,
        settings: &[u8],
    ) -> Result<(), S::Error> {
        let was_unsaved = self.unsaved();
        let result = self.try_step(now_us, storage, table, settings);
        self.failed_us = if result.is_err() { Some(now_us) } else { None };
        // The record of starts does not replace the lost one.
        self.lost &= result.is_err() || !was_unsaved;
        if result.is_err() && self.step != Step::Idle {
            // The state of the slot is unknown after an error.
            self.step = Step::Erase;
        }
        result
    }

    fn try_step<S: Storage>(
        &mut self,
        now_us: u64,
        storage: &mut S,
        table: Option<&GaitTable>,
        settings: &[u8],
    ) -> Result<(), S::Error> {
        if self.settings_unsaved && (self.table_stored() || !self.settings_failed) {
            self.settings_failed = true;
            if !holds_settings(storage, settings) {
                self.budget.spend(now_us);
                storage.save_settings(settings)?;
            }
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
        // The slot with the newest valid table is never overwritten.
        let (slot, generation) = self.newest.map_or((0, 1), |(slot, newest)| {
            ((slot + 1) % SLOTS, newest.wrapping_add(1))
        });
        match self.step {
            Step::Idle => {}
            Step::Erase
                if self
                    .newest
                    .is_some_and(|(slot, _)| holds_table(storage, slot, table)) =>
            {
                self.step = Step::Idle;
            }
            Step::Erase => {
                self.budget.spend(now_us);
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

/// Slot header, u32 little-endian: `magic | format | generation | len | CRC-32C of the table | CRC-32C of these`.
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

/// Returns true if the stored settings equal these. An unreadable record counts as different.
fn holds_settings<S: Storage>(storage: &mut S, settings: &[u8]) -> bool {
    let mut bytes = [0; MAX_SETTINGS];
    let stored = storage.load_settings(&mut bytes);
    matches!(stored, Ok(Some(len)) if bytes.get(..len) == Some(settings))
}

/// Returns true if the slot holds this table.
fn holds_table<S: Storage>(storage: &mut S, slot: usize, table: &GaitTable) -> bool {
    let mut head = [0; HEADER];
    let generation = 0..12;
    if storage.read(slot, 0, &mut head).is_err()
        || head[generation.end..HEADER - 4] != header(table, 0)[generation.end..HEADER - 4]
    {
        return false;
    }
    let mut pages = table.bytes().chunks(PAGE).enumerate();
    pages.all(|(page, data)| {
        let mut stored = [0; PAGE];
        let stored = &mut stored[..data.len()];
        storage.read(slot, PAGE * (1 + page), stored).is_ok() && stored == data
    })
}

/// Reads a slot. Returns its generation if it holds a valid table.
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

    fn table(amplitude: f64) -> GaitTable {
        let shape = |u: f64| [amplitude * u * (1.0 - u), 0.0];
        GaitTable::from_fn(100, shape).unwrap_or_else(|_| GaitTable::empty())
    }

    /// Storage that counts erasures, and writes of the settings.
    struct Counted {
        flash: MemoryStorage,
        writes: u64,
    }

    impl Counted {
        fn erased() -> Self {
            Self {
                flash: MemoryStorage::erased(),
                writes: 0,
            }
        }

        /// Stores everything that the budget allows; returns the number of writes.
        fn serve(
            &mut self,
            persist: &mut Persist,
            now_us: u64,
            table: &GaitTable,
            settings: &[u8],
        ) -> u64 {
            let before = self.writes;
            while persist.wanted(now_us) {
                let Ok(()) = persist.step(now_us, self, Some(table), settings);
            }
            self.writes - before
        }
    }

    impl Storage for Counted {
        type Error = core::convert::Infallible;

        fn read(
            &mut self,
            slot: usize,
            offset: usize,
            bytes: &mut [u8],
        ) -> Result<(), Self::Error> {
            self.flash.read(slot, offset, bytes)
        }

        fn erase(&mut self, slot: usize) -> Result<(), Self::Error> {
            self.writes += 1;
            self.flash.erase(slot)
        }

        fn program(
            &mut self,
            slot: usize,
            page: usize,
            bytes: &[u8; PAGE],
        ) -> Result<(), Self::Error> {
            self.flash.program(slot, page, bytes)
        }

        fn load_settings(
            &mut self,
            bytes: &mut [u8; MAX_SETTINGS],
        ) -> Result<Option<usize>, Self::Error> {
            self.flash.load_settings(bytes)
        }

        fn save_settings(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
            self.writes += 1;
            self.flash.save_settings(bytes)
        }

        fn load_starts(&mut self, bytes: &mut [u8; ShortStarts::LEN]) -> Result<bool, Self::Error> {
            self.flash.load_starts(bytes)
        }

        fn save_starts(&mut self, bytes: &[u8; ShortStarts::LEN]) -> Result<(), Self::Error> {
            self.flash.save_starts(bytes)
        }
    }

    /// Repeats Begin and Commit of the stored table, and the present settings, seven times a second for an hour.
    #[test]
    fn equal_content_is_not_written() {
        let (mut flash, mut persist) = (Counted::erased(), Persist::new());
        let table = table(1.0);
        persist.table_changed();
        persist.settings_changed();
        assert_eq!(flash.serve(&mut persist, 0, &table, &[7]), 2);
        for again in 1..7 * 3600_u64 {
            persist.table_changed();
            persist.settings_changed();
            let writes = flash.serve(&mut persist, again * 142_857, &table, &[7]);
            assert_eq!((writes, persist.all_stored()), (0, true));
        }
        // A table of equal length but different content is written.
        persist.table_changed();
        let other = self::table(0.9);
        assert_eq!(flash.serve(&mut persist, 3_600_000_000, &other, &[7]), 1);
    }

    /// Content that changes each time is written at the budget of `docs/reference/promises.md`.
    #[test]
    fn changes_are_written_at_the_rate_of_the_budget() {
        let (mut flash, mut persist) = (Counted::erased(), Persist::new());
        let table = GaitTable::empty();
        let (mut writes, day_us) = (0, 86_400_000_000_u64);
        for second in 0..86_400_u64 {
            persist.settings_changed();
            let settings = second.to_le_bytes();
            writes += flash.serve(&mut persist, second * 1_000_000, &table, &settings);
        }
        assert_eq!(writes, WRITES_AT_ONCE + day_us / WRITE_EVERY_US - 1);
        // A change with presence is stored at once.
        persist.settings_changed();
        assert_eq!(flash.serve(&mut persist, day_us, &table, &[1]), 1);
        persist.settings_changed();
        assert_eq!(flash.serve(&mut persist, day_us, &table, &[2]), 0);
        persist.grant();
        assert_eq!(flash.serve(&mut persist, day_us, &table, &[2]), 1);
        assert_eq!(flash.flash.settings.as_deref(), Some(&[2][..]));
    }

    #[test]
    fn what_was_lost_is_told_until_it_is_stored_anew() {
        let mut flash = MemoryStorage::erased();
        let mut persist = Persist::new();
        persist.lost();
        // The record of starts does not replace lost settings or tables.
        persist.starts_changed(ShortStarts { runs: 1 });
        let Ok(()) = persist.step(0, &mut flash, None, &[7]);
        assert!(persist.all_stored() && persist.failed());
        persist.settings_changed();
        let Ok(()) = persist.step(0, &mut flash, None, &[7]);
        assert!(persist.all_stored() && !persist.failed());
        assert_eq!(flash.settings.as_deref(), Some(&[7][..]));
    }
}
