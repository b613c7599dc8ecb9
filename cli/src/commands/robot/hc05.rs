//! `swimmer robot hc05`: sets up the robot's Bluetooth module once, through a USB serial adapter.

use std::fmt;

use host_link::hc05::{
    self, AT_BAUD, Hc05Error, Module, ModuleSettings, ModuleSettingsError, Setting, Uart,
};
use host_link::port::SerialPort;
use serde::Serialize;

use super::access::Access;
use super::outputs::print_refusal;
use super::port::is_a_path;
use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::quantity::Rows;

/// Set up the Bluetooth module on a USB serial adapter: speed, name, PIN
///
/// Take the module off the robot. Adapter at 3.3 V: its RXD to the module's TXD, its TXD to RXD, GND to GND, 5 V to VCC.
/// Hold the module's button (or KEY, EN at 3.3 V) while it gets its power and until this command has ended: its LED goes
/// 2 s on, 2 s off. Correct settings are left alone, and changed ones are read back.
#[derive(Debug, clap::Args)]
pub(super) struct Hc05 {
    /// The name that computers see; left out, it stays
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// The PIN for pairing, 4 to 16 digits; left out, it stays (1234 from the maker)
    #[arg(long, value_name = "DIGITS")]
    pin: Option<String>,
    /// Only check, and exit with 1 if a setting differs
    #[arg(long)]
    check: bool,
    /// Speed of the module's AT mode: 38400 unless its button was pressed after power came
    #[arg(long, value_name = "BAUD", default_value_t = AT_BAUD)]
    at_baud: u32,
}

/// Does it.
pub(super) fn run(access: &Access, arguments: &Hc05, output: Output) -> Outcome {
    let wanted = ModuleSettings::new(access.baud(), arguments.name.clone(), arguments.pin.clone())?;
    let path = match access.bare_port() {
        Some(path) if is_a_path(path) => path,
        _ => {
            return Err(Failure::BadInput(
                "name the one USB serial adapter that the HC-05 hangs on: --port with its serial port, as /dev/ttyUSB0 or COM5; without --log, for no frames pass"
                    .to_owned(),
            ));
        }
    };
    let mut port =
        SerialPort::open(path, arguments.at_baud).map_err(|error| Failure::tried(&error))?;
    let outcome = hc05::converse(&mut port, &wanted, arguments.check)?;
    let answer = Hc05Output::new(&outcome, arguments.check);
    if arguments.check && !answer.differed.is_empty() {
        let reason = format!(
            "the HC-05 is not as wanted: {}; set it up with the same command without --check",
            answer.differed.join(", ")
        );
        return print_refusal(output, &answer, reason);
    }
    output.print(&answer);
    Ok(())
}

/// Settings found and changed.
#[derive(Debug, Serialize)]
struct Hc05Output {
    version: Option<String>,
    before: Settings,
    after: Settings,
    /// Names of the settings that differed.
    differed: Vec<&'static str>,
    checked_only: bool,
}

#[derive(Debug, Serialize)]
struct Settings {
    role: Option<u8>,
    name: Option<String>,
    pin: Option<String>,
    baud: Option<u32>,
    stop_bits: Option<u8>,
    parity: Option<&'static str>,
}

impl Settings {
    fn new(module: &Module) -> Self {
        Self {
            role: module.role,
            name: module.name.clone(),
            pin: module.pin.clone(),
            baud: module.uart.map(|uart| uart.baud),
            stop_bits: module.uart.map(|uart| uart.stop.saturating_add(1)),
            parity: module.uart.map(parity),
        }
    }
}

fn parity(uart: Uart) -> &'static str {
    match uart.parity {
        0 => "none",
        1 => "odd",
        _ => "even",
    }
}

impl Hc05Output {
    fn new(outcome: &hc05::Outcome, checked_only: bool) -> Self {
        Self {
            version: outcome.before.version.clone(),
            before: Settings::new(&outcome.before),
            after: Settings::new(&outcome.after),
            differed: outcome
                .differed
                .iter()
                .map(|setting| setting.word())
                .collect(),
            checked_only,
        }
    }
}

impl fmt::Display for Hc05Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reported =
            |value: &Option<String>| value.clone().unwrap_or_else(|| "not reported".to_owned());
        let speed = |settings: &Settings| match (settings.baud, settings.stop_bits, settings.parity)
        {
            (Some(baud), Some(stop), Some(parity)) => {
                format!("{baud} baud, {stop} stop bit(s), parity {parity}")
            }
            _ => "not reported".to_owned(),
        };
        let role = |settings: &Settings| match settings.role {
            Some(0) => "waits to be called".to_owned(),
            Some(role) => format!("{role}, does not wait to be called"),
            None => "not reported".to_owned(),
        };
        let mut rows = Rows::default();
        rows.row("firmware", reported(&self.version));
        let (before, after) = (&self.before, &self.after);
        for (setting, label, was, is) in [
            (Setting::Role, "role", role(before), role(after)),
            (
                Setting::Name,
                "name",
                reported(&before.name),
                reported(&after.name),
            ),
            (
                Setting::Pin,
                "PIN",
                reported(&before.pin),
                reported(&after.pin),
            ),
            (Setting::Uart, "speed", speed(before), speed(after)),
        ] {
            let text = if !self.differed.contains(&setting.word()) {
                is
            } else if self.checked_only {
                format!("{is}  <- not as wanted")
            } else {
                format!("{is} (was {was})")
            };
            rows.row(label, text);
        }
        write!(f, "{rows}")?;
        if self.checked_only {
            return Ok(());
        }
        write!(
            f,
            "\nThe HC-05 is set up: let its button go, take its power away and build it in."
        )
    }
}

impl From<ModuleSettingsError> for Failure {
    fn from(error: ModuleSettingsError) -> Self {
        Self::bad_input(&error)
    }
}

impl From<Hc05Error> for Failure {
    fn from(error: Hc05Error) -> Self {
        Self::tried(&error)
    }
}
