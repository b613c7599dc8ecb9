//! Presence of a person: a jumper from a pin to ground, and on the Pico its BOOTSEL button.

use embassy_rp::Peri;
use embassy_rp::gpio::{Input, Pull};
use embassy_rp::peripherals::PIN_5;

/// Pin of the jumper, pulled up, so that an open pin means absence.
pub(crate) struct Presence {
    jumper: Input<'static>,
}

impl Presence {
    pub(crate) fn new(pin: Peri<'static, PIN_5>) -> Self {
        Self {
            jumper: Input::new(pin, Pull::Up),
        }
    }

    /// Returns true if the jumper is closed or the button pressed.
    pub(crate) fn shows(&self) -> bool {
        self.jumper.is_low() || button::is_pressed()
    }
}

/// BOOTSEL button. It shares the flash chip's select line, so the flash cannot be read while it is sampled: 30 µs with
/// interrupts off. The thread samples it, and only while pulses are off.
#[cfg(feature = "pico")]
pub(crate) mod button {
    use embassy_rp::Peri;
    use embassy_rp::bootsel::is_bootsel_pressed;
    use embassy_rp::peripherals::BOOTSEL;
    use embassy_time::{Duration, Ticker};
    use portable_atomic::{AtomicBool, Ordering};

    /// Interval between samples.
    const EVERY: Duration = Duration::from_millis(100);

    static PRESSED: AtomicBool = AtomicBool::new(false);
    static MAY_LOOK: AtomicBool = AtomicBool::new(false);

    pub(super) fn is_pressed() -> bool {
        PRESSED.load(Ordering::Relaxed)
    }

    /// Allows or forbids sampling. Called at each tick.
    pub(crate) fn allow_sampling(pulses_are_off: bool) {
        MAY_LOOK.store(pulses_are_off, Ordering::Relaxed);
    }

    #[embassy_executor::task]
    pub(crate) async fn watch(mut button: Peri<'static, BOOTSEL>) {
        let mut ticker = Ticker::every(EVERY);
        loop {
            ticker.next().await;
            // No tick can occur between this check and the sample.
            let pressed = cortex_m::interrupt::free(|_| {
                MAY_LOOK.load(Ordering::Relaxed) && is_bootsel_pressed(button.reborrow())
            });
            PRESSED.store(pressed, Ordering::Relaxed);
        }
    }
}

/// The Nano has no BOOTSEL button.
#[cfg(not(feature = "pico"))]
pub(crate) mod button {
    pub(super) const fn is_pressed() -> bool {
        false
    }

    pub(crate) const fn allow_sampling(_: bool) {}
}
