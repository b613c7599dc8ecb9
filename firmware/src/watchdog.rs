//! The watchdog: what stops the servos when the CPU hangs, because the PWM slice would keep pulsing without it.
//!
//! Only the control task feeds it, after a tick has gone through, and only while the thread executor beats: a UART task
//! that hangs resets the robot just as a hung control task does. It is fed for each sector of flash that is erased, too: no
//! pulses go out then.

use embassy_rp::Peri;
use embassy_rp::pac::RESETS;
use embassy_rp::peripherals::WATCHDOG;
use embassy_rp::watchdog::{ResetReason, Watchdog as Peripheral};
use embassy_time::{Duration, Ticker};
use portable_atomic::{AtomicBool, Ordering};

/// From the last feed to the reset. Above the 400 ms that a slow flash chip may take to erase a sector, during which
/// nothing can feed; with [`PATIENCE`] below the promised 0.5 s.
const TIMEOUT: Duration = Duration::from_millis(430);
/// Ticks in a row without a beat that are forgiven: 40 ms.
const PATIENCE: u8 = 2;
/// The scratch registers we use. The boot ROM has 4 to 7, and writes 0 and 1 where a program asks it to take a new program
/// over USB. They outlive every reset but those of power and reset pin (`retained_ram.rs` has what must outlive the pin too).
const KEPT: usize = 0;
const STARTS: usize = 1;
const ARMED: usize = 2;
/// In [`ARMED`] from when our start armed the watchdog: what the others hold is ours, and a reset by the watchdog is one of
/// ours. The boot ROM resets by the watchdog too, once it has written the flash.
const BY_US: u32 = u32::from_le_bytes(*b"swim");

static BEATEN: AtomicBool = AtomicBool::new(false);

/// Whether the start was one of the whole chip, which holds every peripheral in reset; a debugger resets the core alone, and
/// then the watchdog tells a reason from long ago. To be asked before `embassy_rp::init`, which resets the peripherals; the
/// boot ROM leaves the PWM alone.
pub(crate) fn whole_chip_was_reset() -> bool {
    RESETS.reset().read().pwm()
}

/// The chip's watchdog and its scratch registers.
pub(crate) struct Watchdog {
    peripheral: Peripheral,
    armed_by_us: bool,
    missed_beats: u8,
}

impl Watchdog {
    pub(crate) fn new(peripheral: Peri<'static, WATCHDOG>) -> Self {
        let mut peripheral = Peripheral::new(peripheral);
        let armed_by_us = peripheral.get_scratch(ARMED) == BY_US;
        if !armed_by_us {
            // What others left there is no word of ours.
            peripheral.set_scratch(KEPT, 0);
            peripheral.set_scratch(STARTS, 0);
        }
        Self {
            peripheral,
            armed_by_us,
            missed_beats: 0,
        }
    }

    /// How the watchdog last reset the chip, whoever wanted it to: `None` after power or the reset pin.
    pub(crate) fn reset_reason(&self) -> Option<ResetReason> {
        self.peripheral.reset_reason()
    }

    /// Whether it was a start of this firmware that had armed it for that.
    pub(crate) fn was_armed_by_us(&self) -> bool {
        self.armed_by_us
    }

    pub(crate) fn start(&mut self) {
        self.peripheral.set_scratch(ARMED, BY_US);
        // Out of reset its timer stands still while a debugger halts a core, and the PWM slice would keep pulsing.
        self.peripheral.pause_on_debug(false);
        self.peripheral.start(TIMEOUT);
    }

    /// Called by the control task once a tick has gone through.
    pub(crate) fn feed(&mut self) {
        self.missed_beats = if BEATEN.swap(false, Ordering::Relaxed) {
            0
        } else {
            self.missed_beats.saturating_add(1)
        };
        if self.missed_beats <= PATIENCE {
            self.peripheral.feed(TIMEOUT);
        }
    }

    /// The chip is the boot ROM's from here on: what it resets it by is none of our faults.
    pub(crate) fn hand_over(&mut self) {
        self.peripheral.set_scratch(ARMED, 0);
    }

    /// Feeds it around the erase of a sector of flash, while no pulses go out.
    pub(crate) fn feed_for_flash(&mut self) {
        self.peripheral.feed(TIMEOUT);
    }

    /// The word that [`Self::keep`] kept over the reset; anything after power was off.
    pub(crate) fn kept(&mut self) -> u32 {
        self.peripheral.get_scratch(KEPT)
    }

    pub(crate) fn keep(&mut self, word: u32) {
        self.peripheral.set_scratch(KEPT, word);
    }

    /// Counts this start; the number since power came on.
    pub(crate) fn count_start(&mut self) -> u32 {
        let starts = self.peripheral.get_scratch(STARTS).wrapping_add(1);
        self.peripheral.set_scratch(STARTS, starts);
        starts
    }
}

/// The thread executor's proof of life, twice a tick.
#[embassy_executor::task]
pub(crate) async fn beat() {
    let mut ticker = Ticker::every(Duration::from_millis(10));
    loop {
        BEATEN.store(true, Ordering::Relaxed);
        ticker.next().await;
    }
}
