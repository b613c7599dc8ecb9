//! Common contents of every link log, independent of the output: channels, schemas, chunks of two seconds.

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use link_protocol::{Direction, Message};
use mcap::records::MessageHeader;
use mcap::{McapResult, WriteOptions, Writer};
use serde_json::Value;

use super::LinkFrame;
use super::frame::{telemetry_json, topic};
use super::scene::{self, Scenes};

/// The JSON schema of each message, as the file carries it.
const SCHEMA: &str = include_str!("schema.json");
const SCHEMA_NAME: &str = "swimmer.LinkFrame";
const TELEMETRY_SCHEMA: &str = include_str!("telemetry.json");
const TELEMETRY_SCHEMA_NAME: &str = "swimmer.Telemetry";
const TELEMETRY_TOPIC: &str = "/robot/telemetry";

/// Duration of a chunk, ns of the host's clock. A log that is cut off lacks at most the last one; chunks of half a second make a log a
/// third longer.
const CHUNK_NS: u64 = 2_000_000_000;

/// Compression of chunks, in the calling thread: chunks are small.
#[cfg(feature = "compressed-logs")]
fn options() -> WriteOptions {
    WriteOptions::new()
        .compression(Some(mcap::Compression::Zstd))
        .compression_threads(0)
}

/// Plain chunks, for the lab page, whose module holds no compressor.
#[cfg(not(feature = "compressed-logs"))]
fn options() -> WriteOptions {
    WriteOptions::new().compression(None)
}

/// A log that has its head, and takes frames.
pub(super) struct Container<W: Write + Seek> {
    writer: Writer<W>,
    /// To the robot, from it, its telemetry, and the scene.
    channels: [u16; 4],
    scenes: Scenes,
    sequence: u32,
    /// Start time of the chunk being filled.
    chunk_began_ns: Option<u64>,
}

impl<W: Write + Seek> Container<W> {
    /// Writes the head.
    pub(super) fn begin(sink: W) -> McapResult<Self> {
        let mut writer = options()
            // A chunk is written when it is whole, instead of piece by piece with its length at the end.
            .disable_seeking(true)
            .profile("")
            .library(concat!("swimmer-files ", env!("CARGO_PKG_VERSION")))
            .create(sink)?;
        let schema = writer.add_schema(SCHEMA_NAME, "jsonschema", SCHEMA.as_bytes())?;
        let telemetry = writer.add_schema(
            TELEMETRY_SCHEMA_NAME,
            "jsonschema",
            TELEMETRY_SCHEMA.as_bytes(),
        )?;
        let scene =
            writer.add_schema(scene::SCHEMA_NAME, "jsonschema", scene::SCHEMA.as_bytes())?;
        let empty = BTreeMap::new();
        let channels = [
            writer.add_channel(schema, topic(Direction::ToRobot), "json", &empty)?,
            writer.add_channel(schema, topic(Direction::ToHost), "json", &empty)?,
            writer.add_channel(telemetry, TELEMETRY_TOPIC, "json", &empty)?,
            writer.add_channel(scene, scene::TOPIC, "json", &empty)?,
        ];
        Ok(Self {
            writer,
            channels,
            scenes: Scenes::default(),
            sequence: 0,
            chunk_began_ns: None,
        })
    }

    /// Adds a frame as it crossed the wire, sound or not.
    pub(super) fn write(&mut self, frame: &LinkFrame) -> McapResult<()> {
        let [to_robot, from_robot, telemetry, scene] = self.channels;
        let channel = match frame.direction {
            Direction::ToRobot => to_robot,
            Direction::ToHost => from_robot,
        };
        let received = frame.received();
        self.add(channel, frame, &frame.to_json(received.as_ref()))?;
        if let Some(message) = received.and_then(|received| received.message.ok()) {
            if let Message::Telemetry(received) = &message {
                self.add(telemetry, frame, &telemetry_json(received))?;
            }
            if let Some(update) = self.scenes.after(&message, frame.host_time_ns) {
                self.add(scene, frame, &update)?;
            }
        }
        let now = frame.host_time_ns;
        let began = *self.chunk_began_ns.get_or_insert(now);
        if self.sequence == 1 || now.saturating_sub(began) >= CHUNK_NS {
            self.chunk_began_ns = Some(now);
            self.writer.flush()?;
        }
        Ok(())
    }

    fn add(&mut self, channel: u16, frame: &LinkFrame, json: &Value) -> McapResult<()> {
        let header = MessageHeader {
            channel_id: channel,
            sequence: self.sequence,
            log_time: frame.host_time_ns,
            publish_time: frame.host_time_ns,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer
            .write_to_known_channel(&header, json.to_string().as_bytes())
    }

    /// Ends the log, and gives back where it went.
    pub(super) fn finish(mut self) -> McapResult<W> {
        self.writer.finish()?;
        Ok(self.writer.into_inner())
    }
}
