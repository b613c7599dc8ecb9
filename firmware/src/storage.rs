//! Flash implementation of the brain's storage trait: two raw slots for gait tables, a `sequential-storage` map for the
//! settings, and another map for the count of short starts, whose frequent writes must not wear the settings' pages.
//!
//! Erasing and programming block the program, including interrupts, while the flash is busy; the brain requests it only while
//! stopped. Addresses come from `memory.x`.

use core::ops::Range;

use embassy_futures::block_on;
use embassy_rp::Peri;
use embassy_rp::flash::{Blocking, ERASE_SIZE, Error as FlashError, Flash, READ_SIZE, WRITE_SIZE};
use embassy_rp::peripherals::FLASH;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use gait_player::ShortStarts;
use gait_player::storage::{MAX_SETTINGS, PAGE, SLOT_PAGES, SLOTS, Storage};
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

use crate::watchdog::Watchdog;

/// Size of the smaller flash chip of both boards (the Pico's), bytes.
const FLASH_SIZE: usize = 2 * 1024 * 1024;
/// Single key of each map.
const KEY: u8 = 0;

const _: () =
    assert!(SLOTS == 2 && SLOT_PAGES * PAGE <= ERASE_SIZE && PAGE == embassy_rp::flash::PAGE_SIZE);

// SAFETY: these symbols are neither called nor read. The linker script assigns each an address, which is an offset into the
// flash chip, and only the address is used.
#[allow(unsafe_code)]
unsafe extern "C" {
    static __gait_slot_0_start: u8;
    static __gait_slot_0_end: u8;
    static __gait_slot_1_start: u8;
    static __gait_slot_1_end: u8;
    static __settings_start: u8;
    static __settings_end: u8;
    static __starts_start: u8;
    static __starts_end: u8;
}

/// Offset into the flash chip of a linker symbol.
fn offset(symbol: *const u8) -> u32 {
    symbol.addr() as u32
}

/// Error of the flash storage.
#[derive(Debug, defmt::Format)]
pub(crate) enum Error {
    /// Error of the chip's driver.
    Flash(FlashError),
    /// Error of a map.
    Map(sequential_storage::Error<FlashError>),
    /// The settings' area is not blank, but holds no valid settings.
    SettingsLost,
    /// The slot or page does not exist.
    NoSuchPlace,
}

impl From<FlashError> for Error {
    fn from(error: FlashError) -> Self {
        Self::Flash(error)
    }
}

type Chip = Flash<'static, FLASH, Blocking, FLASH_SIZE>;

/// Persistent part of the flash chip.
pub(crate) struct FlashStorage {
    chip: Chip,
    slots: [Range<u32>; SLOTS],
    settings: Range<u32>,
    starts: Range<u32>,
}

/// Flash handle that also feeds the watchdog.
pub(crate) struct StorageInUse<'a> {
    flash: FedFlash<'a>,
    slots: &'a [Range<u32>; SLOTS],
    settings: &'a Range<u32>,
    starts: &'a Range<u32>,
}

/// Flash that feeds the watchdog between erases. One sector may take nearly the watchdog's time-out, and nothing else can feed
/// it meanwhile. One call of the settings map may erase several sectors to repair the result of a power cut.
struct FedFlash<'a> {
    chip: &'a mut Chip,
    watchdog: &'a mut Watchdog,
}

impl FedFlash<'_> {
    /// Erases sector by sector.
    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        for sector in (from..to).step_by(ERASE_SIZE) {
            let end = to.min(sector.saturating_add(ERASE_SIZE as u32));
            self.watchdog.feed_for_flash();
            self.chip.blocking_erase(sector, end)?;
        }
        // Restarts the time-out for the next operation.
        self.watchdog.feed_for_flash();
        Ok(())
    }
}

impl ErrorType for FedFlash<'_> {
    type Error = FlashError;
}

impl ReadNorFlash for FedFlash<'_> {
    const READ_SIZE: usize = READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        self.chip.blocking_read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        FLASH_SIZE
    }
}

impl NorFlash for FedFlash<'_> {
    const WRITE_SIZE: usize = WRITE_SIZE;
    const ERASE_SIZE: usize = ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        Self::erase(self, from, to)
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        self.chip.blocking_write(offset, bytes)
    }
}

type Map<'a, 'b> = MapStorage<u8, &'a mut FedFlash<'b>, Cache<Uncached, Uncached, Uncached, u8>>;

impl FlashStorage {
    pub(crate) fn new(flash: Peri<'static, FLASH>) -> Self {
        Self {
            chip: Flash::new_blocking(flash),
            slots: [
                offset(&raw const __gait_slot_0_start)..offset(&raw const __gait_slot_0_end),
                offset(&raw const __gait_slot_1_start)..offset(&raw const __gait_slot_1_end),
            ],
            settings: offset(&raw const __settings_start)..offset(&raw const __settings_end),
            starts: offset(&raw const __starts_start)..offset(&raw const __starts_end),
        }
    }

    /// Combines flash and watchdog; used only while pulses are off.
    pub(crate) fn feeding<'a>(&'a mut self, watchdog: &'a mut Watchdog) -> StorageInUse<'a> {
        StorageInUse {
            flash: FedFlash {
                chip: &mut self.chip,
                watchdog,
            },
            slots: &self.slots,
            settings: &self.settings,
            starts: &self.starts,
        }
    }
}

impl<'b> StorageInUse<'b> {
    fn slot(&self, slot: usize) -> Result<Range<u32>, Error> {
        self.slots.get(slot).cloned().ok_or(Error::NoSuchPlace)
    }

    /// Returns true if the settings' area was never written.
    fn settings_are_blank(&mut self) -> Result<bool, Error> {
        let mut bytes = [0; PAGE];
        for start in self.settings.clone().step_by(PAGE) {
            self.flash.chip.blocking_read(start, &mut bytes)?;
            if bytes.iter().any(|byte| *byte != 0xFF) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn map(&mut self, place: Range<u32>) -> Map<'_, 'b> {
        MapStorage::new(
            &mut self.flash,
            MapConfig::new(place),
            Cache::new_uncached(),
        )
    }

    /// Reads the single item of a map.
    fn load(&mut self, place: Range<u32>, bytes: &mut [u8]) -> Result<Option<usize>, Error> {
        let mut buffer = [0; MAX_SETTINGS + 32];
        let found =
            block_on(self.map(place).fetch_item::<&[u8]>(&mut buffer, &KEY)).map_err(Error::Map)?;
        Ok(found.and_then(|found| {
            bytes.get_mut(..found.len())?.copy_from_slice(found);
            Some(found.len())
        }))
    }

    fn save(&mut self, place: Range<u32>, bytes: &[u8]) -> Result<(), Error> {
        let mut buffer = [0; MAX_SETTINGS + 32];
        let mut map = self.map(place);
        let mut store = |map: &mut Map<'_, '_>| block_on(map.store_item(&mut buffer, &KEY, &bytes));
        match store(&mut map) {
            // The area is unreadable; new content is better than none.
            Err(sequential_storage::Error::Corrupted { .. }) => {
                block_on(map.erase_all()).map_err(Error::Map)?;
                store(&mut map).map_err(Error::Map)
            }
            outcome => outcome.map_err(Error::Map),
        }
    }
}

impl Storage for StorageInUse<'_> {
    type Error = Error;

    fn read(&mut self, slot: usize, offset: usize, bytes: &mut [u8]) -> Result<(), Error> {
        let slot = self.slot(slot)?;
        if offset.saturating_add(bytes.len()) > slot.len() {
            return Err(Error::NoSuchPlace);
        }
        Ok(self
            .flash
            .chip
            .blocking_read(slot.start + offset as u32, bytes)?)
    }

    fn erase(&mut self, slot: usize) -> Result<(), Error> {
        let slot = self.slot(slot)?;
        Ok(self.flash.erase(slot.start, slot.end)?)
    }

    fn program(&mut self, slot: usize, page: usize, bytes: &[u8; PAGE]) -> Result<(), Error> {
        let slot = self.slot(slot)?;
        if page >= slot.len() / PAGE {
            return Err(Error::NoSuchPlace);
        }
        Ok(self
            .flash
            .chip
            .blocking_write(slot.start + (page * PAGE) as u32, bytes)?)
    }

    fn load_settings(&mut self, bytes: &mut [u8; MAX_SETTINGS]) -> Result<Option<usize>, Error> {
        let found = self.load(self.settings.clone(), bytes)?;
        // The map skips records that it cannot read. An empty result in an area that is not blank means lost settings.
        if found.is_none() && !self.settings_are_blank()? {
            return Err(Error::SettingsLost);
        }
        Ok(found)
    }

    fn save_settings(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.save(self.settings.clone(), bytes)
    }

    fn load_starts(&mut self, bytes: &mut [u8; ShortStarts::LEN]) -> Result<bool, Error> {
        let found = self.load(self.starts.clone(), bytes)?;
        Ok(found == Some(ShortStarts::LEN))
    }

    fn save_starts(&mut self, bytes: &[u8; ShortStarts::LEN]) -> Result<(), Error> {
        self.save(self.starts.clone(), bytes)
    }
}
