//! Flash behind the brain's storage trait: two raw slots for gait tables, a `sequential-storage` map for the settings.
//!
//! Erasing and programming stop the program (interrupts too) for as long as the flash is busy; the brain asks for it
//! only while stopped. Addresses come from `memory.x`.

use core::ops::Range;

use embassy_embedded_hal::adapter::BlockingAsync;
use embassy_futures::block_on;
use embassy_rp::Peri;
use embassy_rp::flash::{Blocking, ERASE_SIZE, Error as FlashError, Flash};
use embassy_rp::peripherals::FLASH;
use gait_player::storage::{MAX_SETTINGS, PAGE, SLOT_PAGES, SLOTS, Storage};
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

/// The smaller of the boards' flash chips (the Pico's).
const FLASH_SIZE: usize = 2 * 1024 * 1024;
/// The only key of the settings map.
const SETTINGS_KEY: u8 = 0;

const _: () =
    assert!(SLOTS == 2 && SLOT_PAGES * PAGE <= ERASE_SIZE && PAGE == embassy_rp::flash::PAGE_SIZE);

// SAFETY: nothing is called, and nothing is read behind these names. They are no variables: the linker script gives
// each an address that is an offset into the flash chip, and only the address is taken.
#[allow(unsafe_code)]
unsafe extern "C" {
    static __gait_slot_0_start: u8;
    static __gait_slot_0_end: u8;
    static __gait_slot_1_start: u8;
    static __gait_slot_1_end: u8;
    static __settings_start: u8;
    static __settings_end: u8;
}

/// Offset into the flash chip that a linker symbol stands for.
fn offset(symbol: *const u8) -> u32 {
    symbol.addr() as u32
}

/// What can go wrong with the flash.
#[derive(Debug, defmt::Format)]
pub(crate) enum Error {
    /// The chip's driver refused.
    Flash(FlashError),
    /// The settings map could not be read or written.
    Settings(sequential_storage::Error<FlashError>),
    /// There is something where the settings are, but no settings can be made of it.
    SettingsLost,
    /// The brain asked for a slot or a page that there is not.
    NoSuchPlace,
}

impl From<FlashError> for Error {
    fn from(error: FlashError) -> Self {
        Self::Flash(error)
    }
}

/// The flash chip's part that outlives the program.
pub(crate) struct FlashStorage {
    flash: Flash<'static, FLASH, Blocking, FLASH_SIZE>,
    slots: [Range<u32>; SLOTS],
    settings: Range<u32>,
}

type SettingsMap<'a> = MapStorage<
    u8,
    BlockingAsync<&'a mut Flash<'static, FLASH, Blocking, FLASH_SIZE>>,
    Cache<Uncached, Uncached, Uncached, u8>,
>;

impl FlashStorage {
    pub(crate) fn new(flash: Peri<'static, FLASH>) -> Self {
        Self {
            flash: Flash::new_blocking(flash),
            slots: [
                offset(&raw const __gait_slot_0_start)..offset(&raw const __gait_slot_0_end),
                offset(&raw const __gait_slot_1_start)..offset(&raw const __gait_slot_1_end),
            ],
            settings: offset(&raw const __settings_start)..offset(&raw const __settings_end),
        }
    }

    fn slot(&self, slot: usize) -> Result<Range<u32>, Error> {
        self.slots.get(slot).cloned().ok_or(Error::NoSuchPlace)
    }

    /// Nothing was ever written where the settings are.
    fn settings_are_blank(&mut self) -> Result<bool, Error> {
        let mut bytes = [0; PAGE];
        for start in self.settings.clone().step_by(PAGE) {
            self.flash.blocking_read(start, &mut bytes)?;
            if bytes.iter().any(|byte| *byte != 0xFF) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn settings(&mut self) -> SettingsMap<'_> {
        MapStorage::new(
            BlockingAsync::new(&mut self.flash),
            MapConfig::new(self.settings.clone()),
            Cache::new_uncached(),
        )
    }
}

impl Storage for FlashStorage {
    type Error = Error;

    fn read(&mut self, slot: usize, offset: usize, bytes: &mut [u8]) -> Result<(), Error> {
        let slot = self.slot(slot)?;
        if offset.saturating_add(bytes.len()) > slot.len() {
            return Err(Error::NoSuchPlace);
        }
        Ok(self
            .flash
            .blocking_read(slot.start + offset as u32, bytes)?)
    }

    fn erase(&mut self, slot: usize) -> Result<(), Error> {
        let slot = self.slot(slot)?;
        Ok(self.flash.blocking_erase(slot.start, slot.end)?)
    }

    fn program(&mut self, slot: usize, page: usize, bytes: &[u8; PAGE]) -> Result<(), Error> {
        let slot = self.slot(slot)?;
        if page >= slot.len() / PAGE {
            return Err(Error::NoSuchPlace);
        }
        Ok(self
            .flash
            .blocking_write(slot.start + (page * PAGE) as u32, bytes)?)
    }

    fn load_settings(&mut self, bytes: &mut [u8; MAX_SETTINGS]) -> Result<Option<usize>, Error> {
        let mut buffer = [0; MAX_SETTINGS + 32];
        let found = block_on(
            self.settings()
                .fetch_item::<&[u8]>(&mut buffer, &SETTINGS_KEY),
        )
        .map_err(Error::Settings)?;
        let found = found.and_then(|found| {
            bytes.get_mut(..found.len())?.copy_from_slice(found);
            Some(found.len())
        });
        // The map reads past what it does not understand: then it has none, which is not the same as none yet.
        if found.is_none() && !self.settings_are_blank()? {
            return Err(Error::SettingsLost);
        }
        Ok(found)
    }

    fn save_settings(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let mut buffer = [0; MAX_SETTINGS + 32];
        let mut settings = self.settings();
        let mut store = |settings: &mut SettingsMap<'_>| {
            block_on(settings.store_item(&mut buffer, &SETTINGS_KEY, &bytes))
        };
        match store(&mut settings) {
            // Nothing in there can be read any more: what is new is better than nothing.
            Err(sequential_storage::Error::Corrupted { .. }) => {
                block_on(settings.erase_all()).map_err(Error::Settings)?;
                store(&mut settings).map_err(Error::Settings)
            }
            outcome => outcome.map_err(Error::Settings),
        }
    }
}
