//! Emulated board: a child process driven by commands. Emulated time advances only during a command, so the caller controls it.

mod config;
mod error;
mod hands;

use std::collections::{BTreeMap, VecDeque};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use host_link::testing::Character;
use serde_json::{Value, json};

use crate::events::{EmulatorReply, Events, Stack, nanos};
use crate::log::Log;

pub use config::{BoardConfig, BoardKind};
pub use error::EmulatorError;

/// Tolerance for the rounding of times that are floats in nanoseconds.
const ROUNDING: Duration = Duration::from_nanos(10);

/// Connection between the board and a computer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BoardLine {
    /// The UART to the HC-05.
    #[default]
    Uart,
    /// The USB cable.
    Usb,
}

/// Emulated board with the unmodified firmware in its flash.
#[derive(Debug)]
pub struct Board {
    child: Child,
    commands: ChildStdin,
    answers: BufReader<ChildStdout>,
    now: Duration,
    powered: bool,
    events: Events,
    /// Bytes sent by the UART and the USB port, with their times.
    sent: [VecDeque<(Duration, u8)>; 2],
    log: Log,
}

impl Board {
    /// Starts a board at emulated time zero, with the radio not connected and no battery voltage.
    ///
    /// # Errors
    /// [`EmulatorError`] with the missing file and the command that creates it.
    pub fn start(config: &BoardConfig) -> Result<Self, EmulatorError> {
        if let Some(missing) = config.missing() {
            return Err(missing);
        }
        let log = Log::of_firmware(&config.firmware);
        let mut child = Command::new("node")
            .arg(config.scripts.join("serve.mjs"))
            .arg(&config.firmware)
            .arg(config.kind.word())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(EmulatorError::Node)?;
        let (Some(commands), Some(answers)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(EmulatorError::Gone {
                command: "start".to_owned(),
                why: "it has no standard input and output".to_owned(),
            });
        };
        Ok(Self {
            child,
            commands,
            answers: BufReader::new(answers),
            now: Duration::ZERO,
            powered: true,
            events: Events::default(),
            sent: Default::default(),
            log,
        })
    }

    /// Emulated time since the first power-on; it continues over resets and power cycles.
    pub fn now(&self) -> Duration {
        self.now
    }

    /// Returns `true` if the board has power: `false` after a power cut until [`Self::power_cycle`].
    pub fn powered(&self) -> bool {
        self.powered
    }

    /// Runs until emulated time `until`; a time in the past has no effect.
    ///
    /// # Errors
    /// [`EmulatorError`]; the same for all methods below.
    pub fn run(&mut self, until: Duration) -> Result<(), EmulatorError> {
        self.run_command(
            until,
            &json!({ "do": "run", "until": until.as_nanos() as f64 }),
        )
    }

    /// Like [`Self::run`], but ends at the latest `after_byte` after the first byte that the board sends.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_past_byte(
        &mut self,
        until: Duration,
        after_byte: Duration,
    ) -> Result<(), EmulatorError> {
        let command = json!({
            "do": "run", "until": until.as_nanos() as f64, "afterByte": after_byte.as_nanos() as f64,
        });
        self.run_command(until, &command)
    }

    fn run_command(&mut self, until: Duration, command: &Value) -> Result<(), EmulatorError> {
        if until <= self.now {
            return Ok(());
        }
        let before = self.now;
        let answer = self.ask(command)?;
        // The run ends with the instruction that reaches the time: slightly later or, by rounding, earlier.
        let reached = nanos(answer.now);
        self.now = if reached + ROUNDING >= until {
            until
        } else {
            reached.max(before)
        };
        self.take_in(answer);
        Ok(())
    }

    /// Sends bytes to the board's UART; they arrive one after the other at its baud rate.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn feed(&mut self, bytes: &[u8]) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "feed", "characters": bytes }))
    }

    /// Sends bytes to the board's USB port; they wait until it is plugged in and open.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn feed_usb(&mut self, bytes: &[u8]) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "feed_usb", "bytes": bytes }))
    }

    /// Like [`Self::feed`], with the errors that a UART detects; [`heard`](host_link::testing::heard) gives those of a wrong baud rate.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn feed_characters(&mut self, characters: &[Character]) -> Result<(), EmulatorError> {
        let characters: Vec<u16> = characters.iter().copied().map(data_register).collect();
        self.perform(&json!({ "do": "feed", "characters": characters }))
    }

    /// Writes the content of the flash chip to a file.
    ///
    /// # Errors
    /// As [`Self::run`]; the file cannot be written.
    pub fn save_flash(&mut self, path: &Path) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "save_flash", "path": path }))
    }

    /// Restarts the board with the flash content of such a file.
    ///
    /// # Errors
    /// As [`Self::run`]; the file cannot be read or does not have the size of the chip.
    pub fn load_flash(&mut self, path: &Path) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "load_flash", "path": path }))
    }

    /// Stack use of the firmware since power-on.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn stack(&mut self) -> Result<Stack, EmulatorError> {
        let answer = self.ask(&json!({ "do": "stack" }))?;
        Ok(answer.stack)
    }

    /// Restarts the board with an emulated flash cache, whose misses take time. Without it every read is a hit, as if the program
    /// were in RAM. Runs at about half the speed.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn put_flash_behind_cache(&mut self) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "cache" }))
    }

    /// Changes two bytes of the running code, until the next reset.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn patch(&mut self, address: u32, halfword: u16) -> Result<(), EmulatorError> {
        self.perform(&json!({ "do": "patch", "address": address, "halfword": halfword }))
    }

    /// Addresses of the firmware's symbols whose names contain `containing`.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn symbols(&mut self, containing: &str) -> Result<BTreeMap<String, u32>, EmulatorError> {
        let answer = self.ask(&json!({ "do": "symbols", "containing": containing }))?;
        Ok(answer.symbols)
    }

    /// Reads bytes of the address space.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn peek(&mut self, address: u32, count: u32) -> Result<Vec<u8>, EmulatorError> {
        let answer = self.ask(&json!({ "do": "peek", "address": address, "count": count }))?;
        Ok(answer.bytes)
    }

    /// Returns the events since the last call.
    pub fn take_events(&mut self) -> Events {
        std::mem::take(&mut self.events)
    }

    /// Takes at most `room` bytes that the board has sent over a line until `now`.
    pub fn take_sent(&mut self, line: BoardLine, now: Duration, room: usize, out: &mut Vec<u8>) {
        let queue = &mut self.sent[line as usize];
        let sent = queue.iter().take_while(|(at, _)| *at <= now).count();
        out.extend(queue.drain(..sent.min(room)).map(|(_, byte)| byte));
    }

    fn take_in(&mut self, answer: EmulatorReply) {
        for (queue, times, bytes) in [
            (BoardLine::Uart, answer.uart_at, answer.uart),
            (BoardLine::Usb, answer.usb_at, answer.usb),
        ] {
            self.sent[queue as usize].extend(times.into_iter().map(nanos).zip(bytes));
        }
        self.events.append(answer.events);
        for chunk in &answer.log {
            self.events.log.extend(self.log.read(chunk));
        }
    }

    /// Performs a command whose reply has only events.
    fn perform(&mut self, command: &Value) -> Result<(), EmulatorError> {
        let answer = self.ask(command)?;
        self.take_in(answer);
        Ok(())
    }

    fn ask(&mut self, command: &Value) -> Result<EmulatorReply, EmulatorError> {
        let name = || command["do"].as_str().unwrap_or("?").to_owned();
        let gone = |why: String| EmulatorError::Gone {
            command: name(),
            why,
        };
        writeln!(self.commands, "{command}")
            .and_then(|()| self.commands.flush())
            .map_err(|error| gone(error.to_string()))?;
        let mut line = String::new();
        let count = self
            .answers
            .read_line(&mut line)
            .map_err(|error| gone(error.to_string()))?;
        if count == 0 {
            return Err(gone("its words on standard error say why".to_owned()));
        }
        let answer: Value =
            serde_json::from_str(&line).map_err(|error| gone(format!("{error} in {line:.200}")))?;
        if let Some(why) = answer["error"].as_str() {
            return Err(EmulatorError::Failed {
                command: name(),
                why: why.to_owned(),
            });
        }
        let answer: EmulatorReply =
            serde_json::from_value(answer).map_err(|error| gone(error.to_string()))?;
        self.powered = answer.powered;
        self.now = self.now.max(nanos(answer.now));
        Ok(answer)
    }
}

/// Encodes a character with the error bits of the PL011's data register.
fn data_register(heard: Character) -> u16 {
    u16::from(heard.byte) | u16::from(heard.framing) << 8 | u16::from(heard.silent) << 10
}

impl Drop for Board {
    fn drop(&mut self) {
        // The child ends when its input closes; one that hangs must be killed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
