//! Watchdog: stops the servos if the CPU hangs, because the PWM slice alone would continue to pulse.
//!
//! Only the control task feeds it, after a finished tick, and only while the thread executor beats: a hung UART task resets the
//! robot like a hung control task. It is also fed for each erased flash sector, while pulses are off.

use embassy_rp::Peri;
use embassy_rp::pac::RESETS;
use embassy_rp::peripherals::WATCHDOG;
use embassy_rp::watchdog::{ResetReason, Watchdog as Peripheral};
use embassy_time::{Duration, Ticker};
use portable_atomic::{AtomicBool, Ordering};

/// Time-out. It exceeds the 400 ms that a slow flash chip may take to erase a sector, during which nothing can feed it. With
/// [`PATIENCE`] it is below the promised 0.5 s.
const TIMEOUT: Duration = Duration::from_millis(430);
/// Number of consecutive ticks without a beat that are tolerated: 40 ms.
const PATIENCE: u8 = 2;
/// Scratch registers of this firmware. The boot ROM uses 4 to 7, and writes 0 and 1 if a program requests new firmware over
/// USB. They survive every reset except power-on and reset pin (`retained_ram.rs` has the state that must survive the pin too).
const KEPT: usize = 0;
const STARTS: usize = 1;
const ARMED: usize = 2;
/// Value in [`ARMED`] after our start-up has armed the watchdog. It shows that the other registers are ours, and that a
/// watchdog reset is ours too: the boot ROM also resets by the watchdog after it has written the flash.
const BY_US: u32 = u32::from_le_bytes(*b"swim");

static BEATEN: AtomicBool = AtomicBool::new(false);

/// Returns true if the whole chip was reset, including every peripheral. A debugger resets only the core, and then the watchdog
/// reports an outdated reason. Must be called before `embassy_rp::init`, which resets the peripherals; the boot ROM does not
/// touch the PWM.
pub(crate) fn whole_chip_was_reset() -> bool {
    RESETS.reset().read().pwm()
}

/// Watchdog of the chip, with its scratch registers.
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
            // A value that other software left is not our word.
            peripheral.set_scratch(KEPT, 0);
            peripheral.set_scratch(STARTS, 0);
        }
        Self {
            peripheral,
            armed_by_us,
            missed_beats: 0,
        }
    }

    /// Type of the last watchdog reset, whoever caused it. Returns `None` after power-on or the reset pin.
    pub(crate) fn reset_reason(&self) -> Option<ResetReason> {
        self.peripheral.reset_reason()
    }

    /// Returns true if this firmware had armed the watchdog.
    pub(crate) fn was_armed_by_us(&self) -> bool {
        self.armed_by_us
    }

    pub(crate) fn start(&mut self) {
        self.peripheral.set_scratch(ARMED, BY_US);
        // By default its timer stops while a debugger halts a core, and the PWM slice would continue to pulse.
        self.peripheral.pause_on_debug(false);
        self.peripheral.start(TIMEOUT);
    }

    /// Feeds the watchdog; called by the control task after each tick.
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

    /// Passes control to the boot ROM: later watchdog resets are not our faults.
    pub(crate) fn hand_over(&mut self) {
        self.peripheral.set_scratch(ARMED, 0);
    }

    /// Feeds the watchdog around the erase of a flash sector, while pulses are off.
    pub(crate) fn feed_for_flash(&mut self) {
        self.peripheral.feed(TIMEOUT);
    }

    /// Word that [`Self::keep`] stored before the reset; undefined after power-on.
    pub(crate) fn kept(&mut self) -> u32 {
        self.peripheral.get_scratch(KEPT)
    }

    pub(crate) fn keep(&mut self, word: u32) {
        self.peripheral.set_scratch(KEPT, word);
    }

    /// Counts this start. Returns the number of starts since power-on.
    pub(crate) fn count_start(&mut self) -> u32 {
        let starts = self.peripheral.get_scratch(STARTS).wrapping_add(1);
        self.peripheral.set_scratch(STARTS, starts);
        starts
    }
}

/// Liveness signal of the thread executor, twice per tick.
#[embassy_executor::task]
pub(crate) async fn beat() {
    let mut ticker = Ticker::every(Duration::from_millis(10));
    loop {
        BEATEN.store(true, Ordering::Relaxed);
        ticker.next().await;
    }
}
