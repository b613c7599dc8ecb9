//! Decoder of the firmware's defmt log: the board writes indices, and the ELF file has the format strings.

use std::fmt;
use std::path::Path;
use std::time::Duration;

use defmt_decoder::{DecodeError, Frame, Table};
use serde::Deserialize;

use crate::events::nanos;

/// Severity of a log line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogLevel {
    /// Single steps.
    Trace,
    /// Details for development of the firmware.
    Debug,
    /// Normal events.
    Info,
    /// Faults that were handled.
    Warn,
    /// Faults that were not handled, crashes included.
    Error,
}

/// Line of the firmware's log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogLine {
    /// Emulated time at which it was written.
    pub at: Duration,
    /// Severity.
    pub level: LogLevel,
    /// Text.
    pub text: String,
}

impl fmt::Display for LogLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let level = match self.level {
            LogLevel::Trace => "TRACE",
            LogLevel::Debug => "DEBUG",
            LogLevel::Info => "INFO",
            LogLevel::Warn => "WARN",
            LogLevel::Error => "ERROR",
        };
        let (seconds, text) = (self.at.as_secs_f64(), &self.text);
        write!(f, "{seconds:10.6} s {level:<5} {text}")
    }
}

/// Bytes of the log as the emulator returns them.
#[derive(Debug, Deserialize)]
pub(crate) struct Chunk {
    at: f64,
    bytes: Vec<u8>,
}

/// Decoder with the format strings and the incomplete last frame.
#[derive(Debug)]
pub(crate) struct Log {
    words: Words,
    begun: Vec<u8>,
}

#[derive(Debug)]
enum Words {
    /// Boxed for its size.
    Known(Box<Table>),
    /// The firmware has no log.
    None,
    /// The log has an unsupported encoding; the text is the reason.
    Unreadable(String),
}

impl Log {
    /// Reads the format strings from the firmware's ELF file.
    pub(crate) fn of_firmware(elf: &Path) -> Self {
        let words = match std::fs::read(elf) {
            Ok(elf) => Words::of(&elf),
            Err(error) => Words::Unreadable(error.to_string()),
        };
        Self {
            words,
            begun: Vec::new(),
        }
    }

    /// Returns the lines that end within a chunk.
    pub(crate) fn read(&mut self, chunk: &Chunk) -> Vec<LogLine> {
        let at = nanos(chunk.at);
        let table = match &self.words {
            Words::Known(table) => table,
            Words::None => return Vec::new(),
            Words::Unreadable(why) => {
                let text = format!("the log is there and cannot be read: {why}");
                self.words = Words::None;
                return vec![warning(at, text)];
            }
        };
        self.begun.extend_from_slice(&chunk.bytes);
        // A zero byte ends a frame.
        let Some(end) = self.begun.iter().rposition(|byte| *byte == 0) else {
            return Vec::new();
        };
        let whole: Vec<u8> = self.begun.drain(..=end).collect();
        let mut decoder = table.new_stream_decoder();
        decoder.received(&whole);
        let mut lines = Vec::new();
        loop {
            match decoder.decode() {
                Ok(frame) => lines.push(LogLine {
                    at,
                    level: level(&frame),
                    text: frame.display_message().to_string(),
                }),
                Err(DecodeError::UnexpectedEof) => return lines,
                Err(DecodeError::Malformed) => {
                    lines.push(warning(at, "a line of the log is damaged".to_owned()));
                }
            }
        }
    }
}

impl Words {
    fn of(elf: &[u8]) -> Self {
        match Table::parse(elf) {
            Ok(Some(table)) => Self::Known(Box::new(table)),
            Ok(None) => Self::None,
            Err(error) => Self::Unreadable(error.to_string()),
        }
    }
}

fn warning(at: Duration, text: String) -> LogLine {
    LogLine {
        at,
        level: LogLevel::Warn,
        text,
    }
}

/// Level of a frame; plain prints have no level.
fn level(frame: &Frame<'_>) -> LogLevel {
    let Some(level) = frame.level() else {
        return LogLevel::Info;
    };
    match level.as_str() {
        "trace" => LogLevel::Trace,
        "debug" => LogLevel::Debug,
        "info" => LogLevel::Info,
        "warn" => LogLevel::Warn,
        _ => LogLevel::Error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chunk(bytes: &[u8]) -> Chunk {
        Chunk {
            at: 1.5e9,
            bytes: bytes.to_vec(),
        }
    }

    #[test]
    fn a_firmware_without_a_log_says_nothing() {
        let mut log = Log {
            words: Words::None,
            begun: Vec::new(),
        };
        assert_eq!(log.read(&chunk(&[1, 2, 0])), []);
    }

    #[test]
    fn words_that_cannot_be_read_are_told_once() {
        let mut log = Log::of_firmware(Path::new("no such file"));
        let [line] = &log.read(&chunk(&[1, 0]))[..] else {
            panic!("one line");
        };
        assert_eq!(line.level, LogLevel::Warn);
        assert!(
            line.to_string()
                .starts_with("  1.500000 s WARN  the log is there"),
            "{line}"
        );
        assert_eq!(log.read(&chunk(&[1, 0])), []);
    }
}
