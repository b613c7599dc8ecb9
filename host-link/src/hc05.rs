//! One-time setup of the HC-05 through a USB serial adapter, with the AT commands common to all makers: speed, name, PIN.
//!
//! [`Dialogue`] is the state machine over bytes and times; [`converse`] runs it over a [`Port`]. Correct settings stay
//! untouched. New settings are read back, because some modules reply OK and keep the old value.

mod dialogue;
mod error;
mod reply;

use std::fmt;
use std::time::Duration;

use crate::Port;

pub use dialogue::{Action, Dialogue};
pub use error::{Hc05Error, ModuleSettingsError};

/// Speed of the AT mode if KEY was held at power-on \[baud\].
pub const AT_BAUD: u32 = 38_400;
/// Speeds common to the module and the robot's UART \[baud\].
pub const BAUDS: [u32; 7] = [9_600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800];
/// Longest name that all makers' modules accept.
const MAX_NAME: usize = 31;

/// Requested settings of the module; `None` leaves a setting unchanged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModuleSettings {
    name: Option<String>,
    pin: Option<String>,
    baud: u32,
}

impl ModuleSettings {
    /// Validates a speed (one of [`BAUDS`]), a name of 1 to 31 printable ASCII characters and a PIN of 4 to 16 digits.
    ///
    /// # Errors
    /// [`ModuleSettingsError`] if the module would refuse a value.
    pub fn new(
        baud: u32,
        name: Option<String>,
        pin: Option<String>,
    ) -> Result<Self, ModuleSettingsError> {
        if !BAUDS.contains(&baud) {
            return Err(ModuleSettingsError::Baud { baud });
        }
        // A quote or a comma ends a name on some modules and is part of it on others.
        let plain = |c: char| (c.is_ascii_graphic() || c == ' ') && c != '"' && c != ',';
        if let Some(name) = &name
            && !((1..=MAX_NAME).contains(&name.len()) && name.chars().all(plain))
        {
            return Err(ModuleSettingsError::Name(name.clone()));
        }
        if let Some(pin) = &pin
            && !((4..=16).contains(&pin.len()) && pin.chars().all(|c| c.is_ascii_digit()))
        {
            return Err(ModuleSettingsError::Pin(pin.clone()));
        }
        Ok(Self { name, pin, baud })
    }
}

/// Settings reported by the module; `None` if it did not report one.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Module {
    /// Firmware version, such as `2.0-20100601`.
    pub version: Option<String>,
    /// Role: 0 waits for connections (as the robot must), 1 initiates them, 2 echoes.
    pub role: Option<u8>,
    /// Name shown to computers.
    pub name: Option<String>,
    /// PIN for pairing.
    pub pin: Option<String>,
    /// Speed, stop bits and parity of its data mode.
    pub uart: Option<Uart>,
}

/// Speed, stop bits and parity, in the module's encoding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Uart {
    /// Speed \[baud\].
    pub baud: u32,
    /// 0: one stop bit, 1: two.
    pub stop: u8,
    /// 0: no parity, 1: odd, 2: even.
    pub parity: u8,
}

impl Uart {
    /// Settings of the robot's UART: one stop bit, no parity.
    pub const fn at(baud: u32) -> Self {
        Self {
            baud,
            stop: 0,
            parity: 0,
        }
    }
}

impl fmt::Display for Uart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{}", self.baud, self.stop, self.parity)
    }
}

/// A setting of the module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// Role: waits for connections.
    Role,
    /// Name.
    Name,
    /// PIN.
    Pin,
    /// Speed, stop bits, parity.
    Uart,
}

impl Setting {
    /// Word for this setting in messages.
    pub fn word(self) -> &'static str {
        match self {
            Self::Role => "role",
            Self::Name => "name",
            Self::Pin => "pin",
            Self::Uart => "uart",
        }
    }
}

/// Result of a dialogue.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outcome {
    /// Settings before the dialogue.
    pub before: Module,
    /// Settings after the dialogue.
    pub after: Module,
    /// Settings that differed from the requested ones, in the order in which they are set.
    pub differed: Vec<Setting>,
}

/// Sets the module up, or only reads its settings with `only_check`.
///
/// # Errors
/// [`Hc05Error`], with one variant per fault at the bench.
pub fn converse(
    port: &mut impl Port,
    wanted: &ModuleSettings,
    only_check: bool,
) -> Result<Outcome, Hc05Error> {
    let mut dialogue = Dialogue::new(wanted.clone(), only_check);
    let mut bytes = [0; 256];
    loop {
        match dialogue.poll(port.now()) {
            Action::Send(command) => port
                .write(command.as_bytes())
                .map_err(|source| Hc05Error::Port { source })?,
            Action::WaitUntil(until) => {
                let timeout = until
                    .saturating_sub(port.now())
                    .max(Duration::from_millis(1));
                let count = port
                    .read(&mut bytes, timeout)
                    .map_err(|source| Hc05Error::Port { source })?;
                dialogue.receive(&bytes[..count]);
            }
            Action::Done(outcome) => return outcome,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_module_takes_is_refused_before_anything_is_sent() {
        let with = |name: &str| ModuleSettings::new(115_200, Some(name.to_owned()), None);
        assert!(with("swimmer 1").is_ok() && with(&"x".repeat(31)).is_ok());
        for bad in ["", "a\"b", "a,b", "a\r\nAT+ORGL", "näme", &"x".repeat(32)] {
            assert_eq!(with(bad), Err(ModuleSettingsError::Name(bad.to_owned())));
        }
        let pin = |pin: &str| ModuleSettings::new(115_200, None, Some(pin.to_owned()));
        assert!(pin("1234").is_ok() && pin("1234567890123456").is_ok());
        for bad in ["", "123", "12a4", "12345678901234567"] {
            assert_eq!(pin(bad), Err(ModuleSettingsError::Pin(bad.to_owned())));
        }
        assert_eq!(
            ModuleSettings::new(115_201, None, None),
            Err(ModuleSettingsError::Baud { baud: 115_201 })
        );
    }
}
