//! One frame of the link log, and its JSON.

use link_protocol::{Decoder, Message, Received};
use serde_json::{Value, json};

/// Which way a frame went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Host to robot.
    ToRobot,
    /// Robot to host.
    FromRobot,
}

/// One frame as it crossed the wire.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkFrame {
    /// Which way it went.
    pub direction: Direction,
    /// When, on the host's clock \[ns\]; from which moment on is the caller's choice, the same for the whole log.
    pub host_time_ns: u64,
    /// When, on the robot's clock \[µs\], where known.
    pub robot_time_us: Option<u64>,
    /// The bytes on the wire, as sent or received: byte-stuffed, with or without the closing zero.
    pub bytes: Vec<u8>,
}

impl Direction {
    /// The topic in the log.
    pub fn topic(self) -> &'static str {
        match self {
            Self::ToRobot => "/link/to_robot",
            Self::FromRobot => "/link/from_robot",
        }
    }

    pub(super) fn of_topic(topic: &str) -> Option<Self> {
        [Self::ToRobot, Self::FromRobot]
            .into_iter()
            .find(|one| one.topic() == topic)
    }
}

impl LinkFrame {
    pub(super) fn to_json(&self) -> Value {
        let mut object = json!({
            "host_time_ns": self.host_time_ns,
            "robot_time_us": self.robot_time_us,
            "raw_hex": hexadecimal(&self.bytes),
        });
        if let Value::Object(fields) = &mut object {
            fields.insert("decoded".to_owned(), self.decoded());
        }
        object
    }

    /// Header and message for people to read; null where the frame is damaged.
    fn decoded(&self) -> Value {
        let mut decoder = Decoder::new();
        // A closing zero ends the frame where the bytes come without one.
        let received = self
            .bytes
            .iter()
            .chain(&[0])
            .find_map(|&byte| decoder.push(byte));
        let Some(Received {
            header, message, ..
        }) = received
        else {
            return Value::Null;
        };
        let (kind, message) = match &message {
            Ok(message) => (format!("{:?}", message.kind()), message_json(message)),
            Err(problem) => ("not understood".to_owned(), json!(format!("{problem:?}"))),
        };
        json!({
            "version": header.version,
            "session": header.session,
            "sequence": header.sequence,
            "kind": kind,
            "message": message,
        })
    }

    pub(super) fn from_json(direction: Direction, data: &[u8]) -> Result<Self, String> {
        let value: Value =
            serde_json::from_slice(data).map_err(|error| format!("not JSON: {error}"))?;
        let field = |name: &str| value.get(name).ok_or_else(|| format!("no field `{name}`"));
        let robot_time = field("robot_time_us")?;
        Ok(Self {
            direction,
            host_time_ns: field("host_time_ns")?
                .as_u64()
                .ok_or("`host_time_ns` is not a whole number of nanoseconds")?,
            robot_time_us: match robot_time {
                Value::Null => None,
                time => Some(
                    time.as_u64()
                        .ok_or("`robot_time_us` is neither null nor whole microseconds")?,
                ),
            },
            bytes: field("raw_hex")?
                .as_str()
                .and_then(bytes_of)
                .ok_or("`raw_hex` is not pairs of hexadecimal digits")?,
        })
    }
}

fn message_json(message: &Message) -> Value {
    let json = match message {
        Message::Hello(body) => serde_json::to_value(body),
        Message::HelloReply(body) => serde_json::to_value(body),
        Message::Request(body) => serde_json::to_value(body),
        Message::Reply(body) => serde_json::to_value(body),
        Message::Telemetry(body) => serde_json::to_value(body),
        Message::KeepAlive => Ok(Value::Null),
        Message::Ping(body) => serde_json::to_value(body),
        Message::Pong(body) => serde_json::to_value(body),
    };
    // A body that JSON cannot hold is still in the raw bytes.
    json.unwrap_or(Value::Null)
}

fn hexadecimal(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes
        .iter()
        .fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
            let _ = write!(text, "{byte:02x}");
            text
        })
}

fn bytes_of(text: &str) -> Option<Vec<u8>> {
    if !text.len().is_multiple_of(2) || !text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    text.as_bytes()
        .chunks(2)
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok())
        .collect()
}
