//! Writes a link log as it grows: whatever happens to the program or the disk, what was written stays and can be read.
//!
//! Frames go to the file in chunks of half a second of the log's own time, each at once; so a log that is cut off ends with a
//! whole chunk, or with a piece of one, which the reader passes over.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use link_protocol::{Direction, Message};
use mcap::records::MessageHeader;
use serde_json::Value;

use super::frame::{telemetry_json, topic};
use super::{LinkFrame, LinkLogError};
use crate::FileError;
use crate::atomic::{Destination, destination, make_folder_of};

/// The JSON schema of each message, as the file carries it.
const SCHEMA: &str = include_str!("schema.json");
const SCHEMA_NAME: &str = "swimmer.LinkFrame";
const TELEMETRY_SCHEMA: &str = include_str!("telemetry.json");
const TELEMETRY_SCHEMA_NAME: &str = "swimmer.Telemetry";
const TELEMETRY_TOPIC: &str = "/robot/telemetry";

/// Fast enough for a robot's log to be written as it happens.
#[cfg(feature = "lz4")]
const COMPRESSION: Option<mcap::Compression> = Some(mcap::Compression::Lz4);
#[cfg(not(feature = "lz4"))]
const COMPRESSION: Option<mcap::Compression> = None;

/// A chunk holds the frames of so long, ns of the host's clock.
const CHUNK_NS: u64 = 500_000_000;

/// Writes a link log, which grows under its own name. Dropped before [`LinkLogWriter::finish`], it ends all the same; without a
/// single frame it leaves no file.
///
/// ```
/// use std::time::Duration;
/// use swimmer_files::{LinkLogWriter, read_link_log};
///
/// # let path = std::env::temp_dir().join(format!("link-log-{}.mcap", std::process::id()));
/// LinkLogWriter::create(&path)?.finish()?;
/// assert!(read_link_log(&path)?.frames.is_empty());
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), swimmer_files::LinkLogError>(())
/// ```
pub struct LinkLogWriter {
    /// Before the first frame.
    file: Option<File>,
    writer: Option<mcap::Writer<BufWriter<Growing>>>,
    path: PathBuf,
    /// Whether the file was there before.
    replaces: bool,
    /// To the robot, from it, and its telemetry.
    channels: [u16; 3],
    sequence: u32,
    /// When the chunk being filled began.
    chunk_began_ns: Option<u64>,
}

/// A file that takes nothing more once it refused something: what the container's writer has still to say must not follow a piece
/// that is missing.
struct Growing {
    file: File,
    broken: bool,
}

impl Write for Growing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.broken {
            return Err(io::Error::other("it ended earlier"));
        }
        let written = self.file.write(bytes);
        self.broken = match &written {
            Ok(count) => *count == 0 && !bytes.is_empty(),
            Err(error) => error.kind() != io::ErrorKind::Interrupted,
        };
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Growing {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

impl LinkLogWriter {
    /// Starts a log. What is there already is replaced with the first frame.
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
        let replaces = place.exists();
        let file = File::options()
            .write(true)
            .create(true)
            .truncate(false)
            .open(&place)
            .map_err(write_error)?;
        Ok(Self {
            file: Some(file),
            writer: None,
            path: place,
            replaces,
            channels: [0; 3],
            sequence: 0,
            chunk_began_ns: None,
        })
    }

    /// Writes the head, in place of what was there.
    fn begin(&mut self, file: File) -> mcap::McapResult<()> {
        file.set_len(0)?;
        let growing = Growing {
            file,
            broken: false,
        };
        let mut writer = mcap::WriteOptions::new()
            .compression(COMPRESSION)
            // A chunk is written when it is whole, instead of piece by piece with its length at the end.
            .disable_seeking(true)
            .profile("")
            .library(concat!("swimmer-files ", env!("CARGO_PKG_VERSION")))
            .create(BufWriter::new(growing))?;
        let schema = writer.add_schema(SCHEMA_NAME, "jsonschema", SCHEMA.as_bytes())?;
        let telemetry = writer.add_schema(
            TELEMETRY_SCHEMA_NAME,
            "jsonschema",
            TELEMETRY_SCHEMA.as_bytes(),
        )?;
        let empty = BTreeMap::new();
        self.channels = [
            writer.add_channel(schema, topic(Direction::ToRobot), "json", &empty)?,
            writer.add_channel(schema, topic(Direction::ToHost), "json", &empty)?,
            writer.add_channel(telemetry, TELEMETRY_TOPIC, "json", &empty)?,
        ];
        self.writer = Some(writer);
        Ok(())
    }

    fn begun(&mut self) -> Result<(), LinkLogError> {
        match self.file.take() {
            Some(file) => self
                .begin(file)
                .map_err(|error| LinkLogError::container(&self.path, &error)),
            None => Ok(()),
        }
    }

    /// Adds a frame as it crossed the wire, sound or not.
    ///
    /// # Errors
    /// When the disk refuses; what was written before stays, and nothing more is taken.
    pub fn write(&mut self, frame: &LinkFrame) -> Result<(), LinkLogError> {
        self.begun()?;
        let [to_robot, from_robot, telemetry] = self.channels;
        let channel = match frame.direction {
            Direction::ToRobot => to_robot,
            Direction::ToHost => from_robot,
        };
        let received = frame.received();
        self.add(channel, frame, &frame.to_json(received.as_ref()))?;
        if let Some(Message::Telemetry(told)) = received.and_then(|received| received.message.ok())
        {
            self.add(telemetry, frame, &telemetry_json(&told))?;
        }
        let now = frame.host_time_ns;
        let began = *self.chunk_began_ns.get_or_insert(now);
        if self.sequence == 1 || now.saturating_sub(began) >= CHUNK_NS {
            self.chunk_began_ns = Some(now);
            if let Some(writer) = &mut self.writer {
                let flushed = writer.flush();
                flushed.map_err(|error| LinkLogError::container(&self.path, &error))?;
            }
        }
        Ok(())
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

    /// Ends the log.
    ///
    /// # Errors
    /// When the disk refuses; what was written before stays.
    pub fn finish(mut self) -> Result<(), LinkLogError> {
        self.begun()?;
        let Some(mut writer) = self.writer.take() else {
            return Ok(());
        };
        writer
            .finish()
            .map_err(|error| LinkLogError::container(&self.path, &error))?;
        let write_error = |source| FileError::Write {
            path: self.path.clone(),
            source,
        };
        let growing = writer
            .into_inner()
            .into_inner()
            .map_err(|error| write_error(error.into_error()))?;
        Ok(growing.file.sync_all().map_err(write_error)?)
    }
}

impl Drop for LinkLogWriter {
    fn drop(&mut self) {
        if self.file.is_some() && !self.replaces {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}
