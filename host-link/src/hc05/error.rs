//! Errors of the HC-05 setup, one per fault at a bench, each with the next step.

use std::io;

use super::BAUDS;

/// Reason why the module could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum Hc05Error {
    /// The port failed.
    #[error(
        "while talking to the HC-05: the port failed: {source}; check the adapter's cable and try again"
    )]
    Port {
        /// The system's error.
        source: io::Error,
    },
    /// No byte was received.
    #[error(
        "the HC-05 says nothing to `AT`, tried {tries} times. Look at its LED: if it blinks fast, it is not in AT mode: take its power away, hold its button (or its KEY or EN pin at 3.3 V), give it power again and try again. If it blinks slowly (2 s on, 2 s off), it waits for AT: exchange the wires at TXD and RXD (its TXD goes to the adapter's RXD), and join the grounds. If it is dark, it has no power"
    )]
    Silent {
        /// Number of attempts.
        tries: u32,
    },
    /// The received bytes are not readable.
    #[error(
        "the HC-05 answers `AT` with {bytes} bytes that cannot be read: it speaks at another speed. In AT mode from power-up (button held while power comes, LED 2 s on, 2 s off) it speaks at 38400; when the button was pressed later it keeps its data speed: begin again with the button held, or try --at-baud 9600"
    )]
    Noise {
        /// Number of received bytes.
        bytes: usize,
    },
    /// Only our own bytes were received (an echo).
    #[error(
        "`AT` comes straight back and nothing answers it: the adapter's TX and RX touch, or this is not the adapter's port; take the HC-05 off: where the echo stays, look at the adapter"
    )]
    Echo,
    /// Only error replies were received.
    #[error(
        "the device at this port answers `AT` with ERROR {code}, {tries} times: it is no HC-05 in AT mode; take its power away, hold its button, give it power again and try again"
    )]
    NoAtMode {
        /// The module's code.
        code: String,
        /// Number of attempts.
        tries: u32,
    },
    /// An earlier command succeeded, but this one got no reply.
    #[error(
        "the HC-05 answered before, but not to `{command}`: keep its button (or KEY) held all the time, check the wires and try again; settings made so far stay"
    )]
    Stopped {
        /// Last command.
        command: String,
    },
    /// The module replied ERROR.
    #[error(
        "the HC-05 refuses `{command}` with ERROR ({code}){}",
        code_advice(code)
    )]
    Refused {
        /// Last command.
        command: String,
        /// The module's code: hexadecimal digits, or empty.
        code: String,
    },
    /// The module replied OK but kept another value.
    #[error(
        "the HC-05 said OK to its new {setting} but now reads {found} instead of {wanted}: keep its button (or KEY) held all the time and try again; some makers' modules keep nothing in the AT mode that a late press gives"
    )]
    NotKept {
        /// Setting that differs.
        setting: &'static str,
        /// Requested value.
        wanted: String,
        /// Value that was read back.
        found: String,
    },
}

/// Advice for the error codes of the makers' common list, for the commands that are used here.
fn code_advice(code: &str) -> &'static str {
    match code {
        "0" => {
            ", it does not know the command: keep its button (or KEY) held all the time; some makers answer less without it"
        }
        "2" => ", it could not write its memory: take its power away and try again",
        "3" => ", the name is too long for it: choose a shorter one",
        "10" => ", the PIN is too long for it: choose one of four digits",
        "1D" => ", it will not have the PIN in quotes nor without: choose one of four digits",
        _ => ": see its maker's list of codes",
    }
}

/// Reason why requested settings are invalid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ModuleSettingsError {
    /// The speed is not supported by both ends.
    #[error("{baud} baud: the HC-05 and the robot share {}", BAUDS.map(|baud| baud.to_string()).join(", "))]
    Baud {
        /// Requested speed.
        baud: u32,
    },
    /// The name is not accepted by all makers' modules.
    #[error(
        "the name {0:?}: give 1 to 31 letters, digits, spaces or signs of ASCII, no quote and no comma"
    )]
    Name(String),
    /// The PIN is invalid.
    #[error("the PIN {0:?}: give 4 to 16 digits; Windows and phones ask for four")]
    Pin(String),
}
