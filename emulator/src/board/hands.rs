//! What a hand does to the board from outside: plugs, pins, buttons, the mains switch.

use std::time::Duration;

use serde_json::json;

use super::{Board, EmulatorError};

impl Board {
    /// The radio's STATE pin.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_connected(&mut self, up: bool) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "connected", "up": up }))
    }

    /// Voltage at the battery's ADC pin \[V\], 0 to 3.3.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_battery(&mut self, volts: f64) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "battery", "volts": volts }))
    }

    /// The power goes when so many more bytes of flash have been erased or programmed.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn cut_power_after(&mut self, flash_bytes: u32) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "cut", "flashBytes": flash_bytes }))
    }

    /// How long the flash chip takes to erase a sector from now on; 45 ms at first.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_erase_time(&mut self, time: Duration) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "erase_time", "ns": time.as_nanos() as f64 }))
    }

    /// A computer's cable in the USB socket: with it in, the computer finds the device and opens its port. It brings no power.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_plugged(&mut self, plugged: bool) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "plugged", "in": plugged }))
    }

    /// The presence jumper, from its pin to ground.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_jumper(&mut self, closed: bool) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "jumper", "closed": closed }))
    }

    /// The BOOTSEL button (a Pico has one).
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_button(&mut self, pressed: bool) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "button", "pressed": pressed }))
    }

    /// Off and on again: RAM is lost, flash stays.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn power_cycle(&mut self) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "power_cycle" }))
    }

    /// The reset pin: RAM stays, the watchdog's scratch registers do not.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn pin_reset(&mut self) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "pin_reset" }))
    }

    /// The reset with which the chip's boot ROM ends the writing of flash over USB: by the watchdog, though nothing hung.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn boot_rom_reset(&mut self) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "boot_rom_reset" }))
    }

    /// A debugger's reset, of the core alone: RAM, the watchdog's scratch registers and its last reason stay.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn debugger_reset(&mut self) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "debugger_reset" }))
    }
}
