//! Somebody at the robot: a jumper from a pin to ground, and on the Pico its BOOTSEL button.

use embassy_rp::Peri;
use embassy_rp::gpio::{Input, Pull};
use embassy_rp::peripherals::PIN_5;

/// The jumper's pin. Pulled up, so that a wire that is not there is nobody.
pub(crate) struct Presence {
    jumper: Input<'static>,
}

impl Presence {
    pub(crate) fn new(pin: Peri<'static, PIN_5>) -> Self {
        Self {
            jumper: Input::new(pin, Pull::Up),
        }
    }

    /// Whether the jumper is closed or the button pressed.
    pub(crate) fn shows(&self) -> bool {
        self.jumper.is_low() || button::is_pressed()
    }
}

/// The BOOTSEL button pulls at the flash chip's select line, so nothing can be read from flash while it is asked for: 30 µs
/// with interrupts off. That is done in the thread, and only while no pulses go out.
#[cfg(feature = "pico")]
pub(crate) mod button {
    use embassy_rp::Peri;
    use embassy_rp::bootsel::is_bootsel_pressed;
    use embassy_rp::peripherals::BOOTSEL;
    use embassy_time::{Duration, Ticker};
    use portable_atomic::{AtomicBool, Ordering};

    /// From look to look.
    const EVERY: Duration = Duration::from_millis(100);

    static PRESSED: AtomicBool = AtomicBool::new(false);
    static MAY_LOOK: AtomicBool = AtomicBool::new(false);

    pub(super) fn is_pressed() -> bool {
        PRESSED.load(Ordering::Relaxed)
    }

    /// To be called at each tick: whether no pulses go out.
    pub(crate) fn may_be_looked_at(pulses_are_off: bool) {
        MAY_LOOK.store(pulses_are_off, Ordering::Relaxed);
    }

    #[embassy_executor::task]
    pub(crate) async fn watch(mut button: Peri<'static, BOOTSEL>) {
        let mut ticker = Ticker::every(EVERY);
        loop {
            ticker.next().await;
            // No tick comes between question and look.
            let pressed = cortex_m::interrupt::free(|_| {
                MAY_LOOK.load(Ordering::Relaxed) && is_bootsel_pressed(button.reborrow())
            });
            PRESSED.store(pressed, Ordering::Relaxed);
        }
    }
}

/// The Nano has no such button.
#[cfg(not(feature = "pico"))]
pub(crate) mod button {
    pub(super) const fn is_pressed() -> bool {
        false
    }

    pub(crate) const fn may_be_looked_at(_: bool) {}
}
