//! On-board LED: state of the brain, and a flash at each cycle's start for the cameras.

use embassy_rp::Peri;
use embassy_rp::gpio::{AnyPin, Level, Output};

/// On-board LED, active high on both boards.
pub(crate) struct Led {
    pin: Output<'static>,
}

impl Led {
    pub(crate) fn new(pin: Peri<'static, AnyPin>) -> Self {
        Self {
            pin: Output::new(pin, Level::Low),
        }
    }

    pub(crate) fn set(&mut self, on: bool) {
        self.pin.set_level(on.into());
    }
}
