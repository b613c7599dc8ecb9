//! Pin assignment of both boards. The wiring table of the README describes this file.

use crate::build_setting::number;
use embassy_rp::Peri;
use embassy_rp::Peripherals;
use embassy_rp::gpio::AnyPin;
#[cfg(feature = "pico")]
use embassy_rp::peripherals::BOOTSEL;
use embassy_rp::peripherals::{
    ADC, FLASH, PIN_0, PIN_1, PIN_5, PIN_16, PIN_17, PIN_26, PWM_SLICE0, UART0, USB, WATCHDOG,
};

#[cfg(all(feature = "nano-connect", feature = "pico"))]
compile_error!(
    "one board at a time: build the Pico with `--no-default-features --features pico`, or `cargo xtask firmware --board pico`"
);
#[cfg(not(any(feature = "nano-connect", feature = "pico")))]
compile_error!("no board chosen: add `--features nano-connect` or `--features pico`");

/// GPIO of the HC-05's STATE, if it differs from the board's default.
const STATE_PIN: Option<u32> = number(option_env!("SWIMMER_STATE_PIN"));

/// GPIO of the on-board LED.
#[cfg(feature = "nano-connect")]
pub(crate) const LED: u32 = 6;
#[cfg(not(feature = "nano-connect"))]
pub(crate) const LED: u32 = 25;

/// Peripherals by function. The boards differ in LED, STATE pin and BOOTSEL button only.
pub(crate) struct Board {
    /// Serial link to the HC-05: UART0.
    pub(crate) uart: Peri<'static, UART0>,
    /// TX to the HC-05's RXD: GPIO0 (Nano D1, Pico GP0).
    pub(crate) link_tx: Peri<'static, PIN_0>,
    /// RX from the HC-05's TXD: GPIO1 (Nano D0, Pico GP1).
    pub(crate) link_rx: Peri<'static, PIN_1>,
    /// STATE of the HC-05, high while connected: Nano D2 = GPIO25, Pico GP22, unless [`STATE_PIN`] selects another.
    pub(crate) link_state: Peri<'static, AnyPin>,
    /// USB socket.
    pub(crate) usb: Peri<'static, USB>,
    /// Bench jumper, to ground: GPIO5 (Nano D10, Pico GP5).
    pub(crate) presence: Peri<'static, PIN_5>,
    /// Button of the Pico.
    #[cfg(feature = "pico")]
    pub(crate) bootsel: Peri<'static, BOOTSEL>,
    /// PWM slice of both servos, so that they switch in the same period.
    pub(crate) servo_slice: Peri<'static, PWM_SLICE0>,
    /// Front joint φ₁: GPIO16, channel A (Nano D4, Pico GP16).
    pub(crate) servo_front: Peri<'static, PIN_16>,
    /// Back joint φ₂: GPIO17, channel B (Nano D5, Pico GP17).
    pub(crate) servo_back: Peri<'static, PIN_17>,
    /// On-board LED: Nano D13 = GPIO6, Pico GP25.
    pub(crate) led: Peri<'static, AnyPin>,
    /// ADC of the battery pin.
    pub(crate) adc: Peri<'static, ADC>,
    /// Battery voltage through a divider: GPIO26 (Nano A0, Pico GP26).
    pub(crate) battery: Peri<'static, PIN_26>,
    /// Flash with gait slots and settings.
    pub(crate) flash: Peri<'static, FLASH>,
    /// Watchdog, with its scratch registers.
    pub(crate) watchdog: Peri<'static, WATCHDOG>,
}

impl Board {
    /// Assigns the chip's peripherals to their functions.
    pub(crate) fn new(p: Peripherals) -> Self {
        const {
            assert!(
                matches!(STATE_PIN, None | Some(15 | 18..=21)),
                "SWIMMER_STATE_PIN must be 15, 18, 19, 20 or 21: those are free on both boards"
            );
        }
        #[cfg(feature = "nano-connect")]
        let (usual, led) = (p.PIN_25.into(), p.PIN_6.into());
        #[cfg(not(feature = "nano-connect"))]
        let (usual, led) = (p.PIN_22.into(), p.PIN_25.into());
        let link_state = match STATE_PIN {
            Some(15) => p.PIN_15.into(),
            Some(18) => p.PIN_18.into(),
            Some(19) => p.PIN_19.into(),
            Some(20) => p.PIN_20.into(),
            Some(21) => p.PIN_21.into(),
            _ => usual,
        };
        Self {
            uart: p.UART0,
            link_tx: p.PIN_0,
            link_rx: p.PIN_1,
            link_state,
            usb: p.USB,
            presence: p.PIN_5,
            #[cfg(feature = "pico")]
            bootsel: p.BOOTSEL,
            servo_slice: p.PWM_SLICE0,
            servo_front: p.PIN_16,
            servo_back: p.PIN_17,
            led,
            adc: p.ADC,
            battery: p.PIN_26,
            flash: p.FLASH,
            watchdog: p.WATCHDOG,
        }
    }
}
