//! Common contents of every link log, independent of the output: channels, schemas, chunks of half a second.

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use link_protocol::{Direction, Message};
use mcap::records::MessageHeader;
use mcap::{McapResult, WriteOptions, Writer};
use serde_json::Value;

use super::LinkFrame;
use super::frame::{telemetry_json, topic};

/// The JSON schema of each message, as the file carries it.
const SCHEMA: &str = include_str!("schema.json");
const SCHEMA_NAME: &str = "swimmer.LinkFrame";
const TELEMETRY_SCHEMA: &str = include_str!("telemetry.json");
const TELEMETRY_SCHEMA_NAME: &str = "swimmer.Telemetry";
const TELEMETRY_TOPIC: &str = "/robot/telemetry";

/// A chunk holds the frames of so long, ns of the host's clock.
const CHUNK_NS: u64 = 500_000_000;

/// A log that has its head, and takes frames.
pub(super) struct Container<W: Write + Seek> {
    writer: Writer<W>,
    /// To the robot, from it, and its telemetry.
    channels: [u16; 3],
    sequence: u32,
    /// Start time of the chunk being filled.
    chunk_began_ns: Option<u64>,
}

impl<W: Write + Seek> Container<W> {
    /// Writes the head.
    pub(super) fn begin(sink: W) -> McapResult<Self> {
        let mut writer = WriteOptions::new()
            .compression(None)
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
        let empty = BTreeMap::new();
        let channels = [
            writer.add_channel(schema, topic(Direction::ToRobot), "json", &empty)?,
            writer.add_channel(schema, topic(Direction::ToHost), "json", &empty)?,
            writer.add_channel(telemetry, TELEMETRY_TOPIC, "json", &empty)?,
        ];
        Ok(Self {
            writer,
            channels,
            sequence: 0,
            chunk_began_ns: None,
        })
    }

    /// Adds a frame as it crossed the wire, sound or not.
    pub(super) fn write(&mut self, frame: &LinkFrame) -> McapResult<()> {
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
