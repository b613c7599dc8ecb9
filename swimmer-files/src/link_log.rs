//! The link log: every frame that crossed the serial link, both ways, in an MCAP file.
//!
//! MCAP is read by Foxglove, by the `mcap` Python package and by many others. Two topics, `/link/to_robot` and
//! `/link/from_robot`; each message is JSON after the JSON schema `swimmer.LinkFrame` that the file carries: host time, robot
//! time where it is known, the decoded header and message where the frame is sound, and the raw bytes in hexadecimal,
//! so that nothing depends on this program's decoder. A third topic, `/robot/telemetry`, says again in SI units what the
//! telemetry frames tell, to be plotted; it is written for people and never read back.
//!
//! Foxglove reads no schema with alternatives, so every field has one type and what is not known is left out.

mod frame;
mod plays;
mod read;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

pub use frame::LinkFrame;
use frame::{telemetry_json, topic};
use link_protocol::{Direction, Message};
use mcap::records::MessageHeader;
pub use plays::{Play, plays};
pub use read::read_link_log;
use serde_json::Value;

use crate::FileError;
use crate::atomic::{Destination, beside, destination, make_folder_of};

/// The JSON schema of each message, as the file carries it.
const SCHEMA: &str = include_str!("link_log/schema.json");
const SCHEMA_NAME: &str = "swimmer.LinkFrame";
const TELEMETRY_SCHEMA: &str = include_str!("link_log/telemetry.json");
const TELEMETRY_SCHEMA_NAME: &str = "swimmer.Telemetry";
const TELEMETRY_TOPIC: &str = "/robot/telemetry";

/// Why a link log could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum LinkLogError {
    /// The file itself.
    #[error(transparent)]
    File(#[from] FileError),
    /// Nothing that a link log begins with.
    #[error(
        "{} is no link log: it {what}; a link log is the MCAP file of `swimmer robot log` or of --log",
        path.display()
    )]
    NoLinkLog {
        /// The file.
        path: PathBuf,
        /// What it is instead.
        what: &'static str,
    },
    /// The MCAP container.
    #[error("the link log {}: {problem}", path.display())]
    Container {
        /// The log.
        path: PathBuf,
        /// What the container's reader or writer said, in one line.
        problem: String,
    },
    /// A message in it is not a link frame.
    #[error("the link log {}, message {index}: {problem}", path.display())]
    Message {
        /// The log.
        path: PathBuf,
        /// Counted from 0 in the order of the file.
        index: usize,
        /// What is wrong.
        problem: String,
    },
}

impl LinkLogError {
    fn container(path: &Path, error: &mcap::McapError) -> Self {
        Self::Container {
            path: path.to_path_buf(),
            problem: first_line(&error.to_string()),
        }
    }
}

/// The first line that says something, in plain text: a record that cannot be parsed is told with frames, colours and where in
/// the library's own source it happened.
fn first_line(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text.chars();
    while let Some(letter) = rest.next() {
        if letter == '\u{1b}' {
            // An escape sequence ends with its first letter.
            rest.by_ref().find(char::is_ascii_alphabetic);
        } else {
            plain.push(letter);
        }
    }
    plain
        .lines()
        .map(|line| line.trim_matches(|letter: char| letter.is_whitespace() || is_frame(letter)))
        .find(|line| !line.is_empty() && *line != "Error" && *line != "Backtrace")
        .map_or("it is damaged", |line| {
            let line = line.strip_prefix("0: ").unwrap_or(line);
            line.strip_prefix("Error: ").unwrap_or(line)
        })
        .to_owned()
}

/// Lines, corners and ends of lines that frames are drawn with.
fn is_frame(letter: char) -> bool {
    ('\u{2500}'..='\u{257f}').contains(&letter)
}

/// Writes a link log. The file takes its name only when [`LinkLogWriter::finish`] succeeds; dropped before that, it is
/// removed.
pub struct LinkLogWriter {
    writer: Option<mcap::Writer<BufWriter<File>>>,
    temporary: PathBuf,
    path: PathBuf,
    /// To the robot, from it, and its telemetry.
    channels: [u16; 3],
    sequence: u32,
}

impl LinkLogWriter {
    /// Starts a log.
    ///
    /// # Errors
    /// When the file cannot be made in its folder.
    pub fn create(path: &Path) -> Result<Self, LinkLogError> {
        let write_error = |source| FileError::Write {
            path: path.to_path_buf(),
            source,
        };
        let place = match destination(path).map_err(write_error)? {
            Destination::File(place) => place,
            Destination::Stream => {
                return Err(write_error(io::Error::other("it is no file; name one")).into());
            }
        };
        make_folder_of(&place).map_err(write_error)?;
        let temporary = beside(&place, "partial");
        let file = File::create(&temporary).map_err(write_error)?;
        let start = || -> mcap::McapResult<_> {
            let mut writer = mcap::WriteOptions::new()
                .compression(Some(mcap::Compression::Lz4))
                .profile("")
                .library(concat!("swimmer-files ", env!("CARGO_PKG_VERSION")))
                .create(BufWriter::new(file))?;
            let schema = writer.add_schema(SCHEMA_NAME, "jsonschema", SCHEMA.as_bytes())?;
            let telemetry = writer.add_schema(
                TELEMETRY_SCHEMA_NAME,
                "jsonschema",
                TELEMETRY_SCHEMA.as_bytes(),
            )?;
            let empty = BTreeMap::new();
            let channels = [
                writer.add_channel(schema, topic(Direction::ToRobot), "json", &empty)?,
                writer.add_channel(schema, topic(Direction::ToHost), "json", &empty)?,
                writer.add_channel(telemetry, TELEMETRY_TOPIC, "json", &empty)?,
            ];
            Ok((writer, channels))
        };
        match start() {
            Ok((writer, channels)) => Ok(Self {
                writer: Some(writer),
                temporary,
                path: place,
                channels,
                sequence: 0,
            }),
            Err(source) => {
                let _ = std::fs::remove_file(&temporary);
                Err(LinkLogError::container(path, &source))
            }
        }
    }

    /// Adds a frame as it crossed the wire, sound or not.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn write(&mut self, frame: &LinkFrame) -> Result<(), LinkLogError> {
        let [to_robot, from_robot, telemetry] = self.channels;
        let channel = match frame.direction {
            Direction::ToRobot => to_robot,
            Direction::ToHost => from_robot,
        };
        let received = frame.received();
        self.add(channel, frame, &frame.to_json(received.as_ref()))?;
        match received.and_then(|received| received.message.ok()) {
            Some(Message::Telemetry(told)) => self.add(telemetry, frame, &telemetry_json(&told)),
            _ => Ok(()),
        }
    }

    fn add(&mut self, channel: u16, frame: &LinkFrame, json: &Value) -> Result<(), LinkLogError> {
        let header = MessageHeader {
            channel_id: channel,
            sequence: self.sequence,
            log_time: frame.host_time_ns,
            publish_time: frame.host_time_ns,
        };
        self.sequence = self.sequence.wrapping_add(1);
        let Some(writer) = &mut self.writer else {
            return Ok(());
        };
        writer
            .write_to_known_channel(&header, json.to_string().as_bytes())
            .map_err(|error| LinkLogError::container(&self.path, &error))
    }

    /// Closes the log and gives it its name.
    ///
    /// # Errors
    /// When the disk refuses; nothing stays behind then.
    pub fn finish(mut self) -> Result<(), LinkLogError> {
        let Some(mut writer) = self.writer.take() else {
            return Ok(());
        };
        let container = |error| LinkLogError::container(&self.path, &error);
        let finished = writer.finish().map_err(container).and_then(|_| {
            let write_error = |source| FileError::Write {
                path: self.path.clone(),
                source,
            };
            let file = writer
                .into_inner()
                .into_inner()
                .map_err(|error| write_error(error.into_error()))?;
            file.sync_all().map_err(write_error)?;
            std::fs::rename(&self.temporary, &self.path).map_err(write_error)?;
            Ok(())
        });
        if finished.is_err() {
            let _ = std::fs::remove_file(&self.temporary);
        }
        finished
    }
}

impl Drop for LinkLogWriter {
    fn drop(&mut self) {
        if self.writer.take().is_some() {
            let _ = std::fs::remove_file(&self.temporary);
        }
    }
}
