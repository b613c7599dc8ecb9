//! The watchdog: what stops the servos when the CPU hangs, because the PWM slice would keep pulsing without it.
//!
//! Only the control task feeds it, after a tick has gone through, and only while the thread executor beats: a UART task
//! that hangs resets the robot just as a hung control task does.

use embassy_rp::Peri;
use embassy_rp::peripherals::WATCHDOG;
use embassy_rp::watchdog::{ResetReason, Watchdog as Peripheral};
use embassy_time::{Duration, Ticker};
use portable_atomic::{AtomicBool, Ordering};

/// From the last feed to the reset. Above the 400 ms that a slow flash chip may take to erase a sector, during which
/// nothing can feed; with [`PATIENCE`] below the promised 0.5 s.
const TIMEOUT: Duration = Duration::from_millis(430);
/// Ticks in a row without a beat that are forgiven: 40 ms.
const PATIENCE: u8 = 2;
/// The scratch registers we use; the boot ROM has 4 to 7. They outlive every reset but those of power and reset pin
/// (`survivors.rs` has what must outlive the pin too).
const KEPT: usize = 0;
const STARTS: usize = 1;

static BEATEN: AtomicBool = AtomicBool::new(false);

/// The chip's watchdog and its scratch registers.
pub(crate) struct Watchdog {
    peripheral: Peripheral,
    missed_beats: u8,
}

impl Watchdog {
    pub(crate) fn new(peripheral: Peri<'static, WATCHDOG>) -> Self {
        Self {
            peripheral: Peripheral::new(peripheral),
            missed_beats: 0,
        }
    }

    /// Why the chip started: `None` for power or the reset pin.
    pub(crate) fn reset_reason(&self) -> Option<ResetReason> {
        self.peripheral.reset_reason()
    }

    pub(crate) fn start(&mut self) {
        self.peripheral.start(TIMEOUT);
    }

    /// Called by the control task, and by nothing else, once a tick has gone through.
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
