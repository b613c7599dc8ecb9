//! External inputs of the board: cables, pins, buttons and the power switch.

use std::time::Duration;

use serde_json::json;

use super::{Board, EmulatorError};

impl Board {
    /// Sets the STATE pin of the radio.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_connected(&mut self, up: bool) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "connected", "up": up }))
    }

    /// Sets the voltage at the battery's ADC pin \[V\], 0 to 3.3.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_battery(&mut self, volts: f64) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "battery", "volts": volts }))
    }

    /// Cuts the power after `flash_bytes` more bytes of flash have been erased or programmed.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn cut_power_after(&mut self, flash_bytes: u32) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "cut", "flashBytes": flash_bytes }))
    }

    /// Sets the time that the flash chip takes to erase a sector; initially 45 ms.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_erase_time(&mut self, time: Duration) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "erase_time", "ns": time.as_nanos() as f64 }))
    }

    /// Plugs or unplugs a USB cable. If plugged, the computer enumerates the device and opens its port. It does not power the board.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_plugged(&mut self, plugged: bool) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "plugged", "in": plugged }))
    }

    /// Opens or closes the presence jumper, which connects its pin to ground.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_jumper(&mut self, closed: bool) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "jumper", "closed": closed }))
    }

    /// Presses or releases the BOOTSEL button of a Pico.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn set_button(&mut self, pressed: bool) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "button", "pressed": pressed }))
    }

    /// Switches the power off and on: RAM is lost, flash stays.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn power_cycle(&mut self) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "power_cycle" }))
    }

    /// Resets by the reset pin: RAM stays, the watchdog's scratch registers are cleared.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn pin_reset(&mut self) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "pin_reset" }))
    }

    /// Resets as the boot ROM does after flash was written over USB: by the watchdog, without a hung task.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn boot_rom_reset(&mut self) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "boot_rom_reset" }))
    }

    /// Resets the core alone, as a debugger does: RAM, the watchdog's scratch registers and its last reason stay.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn debugger_reset(&mut self) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "debugger_reset" }))
    }
}
