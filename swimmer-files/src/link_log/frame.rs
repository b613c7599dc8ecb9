//! One frame of the link log, and its JSON.

use std::borrow::Cow;

use link_protocol::{Decoder, Direction, Message, Received, Telemetry};
use serde::Deserialize;
use serde_json::{Map, Value, json};

/// One frame as it crossed the wire.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkFrame {
    /// Direction of the frame.
    pub direction: Direction,
    /// When, on the host's clock \[ns\]; from which moment on is the caller's choice, the same for the whole log.
    pub host_time_ns: u64,
    /// When, on the robot's clock \[µs\], where known.
    pub robot_time_us: Option<u64>,
    /// The bytes on the wire, as sent or received: byte-stuffed, with or without the closing zero.
    pub bytes: Vec<u8>,
}

/// The topic of frames that go this way.
pub(super) fn topic(direction: Direction) -> &'static str {
    match direction {
        Direction::ToRobot => "/link/to_robot",
        Direction::ToHost => "/link/from_robot",
    }
}

/// The other way round; `None` for a topic of another program.
pub(super) fn direction_of(name: &str) -> Option<Direction> {
    [Direction::ToRobot, Direction::ToHost]
        .into_iter()
        .find(|direction| topic(*direction) == name)
}

impl LinkFrame {
    pub(super) fn to_json(&self, received: Option<&Received>) -> Value {
        let mut fields = Map::new();
        fields.insert("host_time_ns".to_owned(), json!(self.host_time_ns));
        if let Some(robot_time_us) = self.robot_time_us {
            fields.insert("robot_time_us".to_owned(), json!(robot_time_us));
        }
        fields.insert("raw_hex".to_owned(), json!(hexadecimal(&self.bytes)));
        if let Some(received) = received {
            fields.insert("decoded".to_owned(), decoded(received));
        }
        Value::Object(fields)
    }

    /// The frame as a receiver understands it; `None` where it is damaged.
    pub fn received(&self) -> Option<Received> {
        let mut decoder = Decoder::new();
        // A closing zero ends the frame where the bytes come without one.
        self.bytes
            .iter()
            .chain(&[0])
            .find_map(|&byte| decoder.push(byte))
    }

    pub(super) fn from_json(direction: Direction, data: &[u8]) -> Result<Self, String> {
        let stored: StoredFrame =
            serde_json::from_slice(data).map_err(|error| format!("no frame: {error}"))?;
        Ok(Self {
            direction,
            host_time_ns: stored.host_time_ns,
            robot_time_us: stored.robot_time_us,
            bytes: bytes_of(&stored.raw_hex)
                .ok_or("`raw_hex` is not pairs of hexadecimal digits")?,
        })
    }
}

/// The part of a frame's JSON that is read back; the rest is for people.
#[derive(Deserialize)]
struct StoredFrame<'a> {
    host_time_ns: u64,
    robot_time_us: Option<u64>,
    #[serde(borrow)]
    raw_hex: Cow<'a, str>,
}

/// Header and message for people to read. Telemetry has a topic of its own.
fn decoded(received: &Received) -> Value {
    let Received {
        header, message, ..
    } = received;
    let mut fields = Map::new();
    fields.insert("version".to_owned(), json!(header.version));
    fields.insert("session".to_owned(), json!(header.session));
    fields.insert("sequence".to_owned(), json!(header.sequence));
    let (kind, body) = match message {
        Ok(Message::Telemetry(_)) => ("Telemetry".to_owned(), None),
        Ok(message) => (format!("{:?}", message.kind()), Some(message_json(message))),
        Err(problem) => (
            "not understood".to_owned(),
            Some(json!(format!("{problem:?}"))),
        ),
    };
    fields.insert("kind".to_owned(), json!(kind));
    if let Some(body) = body {
        fields.insert("message".to_owned(), body);
    }
    Value::Object(fields)
}

/// Set-points of both joints, rad.
pub(super) fn set_point(telemetry: &Telemetry) -> [f64; 2] {
    telemetry
        .setpoint
        .map(|units| f64::from(units) / UNITS_PER_RADIAN)
}

/// A piece of telemetry in SI units.
pub(super) fn telemetry_json(telemetry: &Telemetry) -> Value {
    let [phi1, phi2] = set_point(telemetry);
    let [pulse1, pulse2] = telemetry.pulse_ns.map(|ns| f64::from(ns) / 1e3);
    let mut json = json!({
        "robot_time_s": telemetry.robot_us as f64 / 1e6,
        "state": format!("{:?}", telemetry.state),
        "cause": format!("{:?}", telemetry.cause),
        "flags": telemetry.flags.0,
        "cycle": telemetry.cycle,
        "cycles": telemetry.cycles,
        "phase": f64::from(telemetry.phase) / 65_536.0,
        "phi1_rad": phi1,
        "phi2_rad": phi2,
        "pulse1_us": pulse1,
        "pulse2_us": pulse2,
        "x_m": telemetry.pose.x,
        "y_m": telemetry.pose.y,
        "theta_rad": telemetry.pose.theta,
        "frames_ok": telemetry.frames_ok,
        "frames_bad": telemetry.frames_bad,
    });
    if let (Value::Object(fields), Some(millivolts)) = (&mut json, telemetry.battery_mv) {
        fields.insert("battery_v".to_owned(), json!(f64::from(millivolts) / 1e3));
    }
    json
}

/// The inverse of [`link_protocol::ANGLE_UNIT_RAD`]: divided by it, an angle has no more digits than the wire gives it.
const UNITS_PER_RADIAN: f64 = 1e4;

fn message_json(message: &Message) -> Value {
    let json = match message {
        Message::Hello(body) => serde_json::to_value(body),
        Message::HelloReply(body) => serde_json::to_value(body),
        Message::Request(body) => serde_json::to_value(body),
        Message::Reply(body) => serde_json::to_value(body),
        Message::Telemetry(body) => serde_json::to_value(body),
        Message::Pong(body) => serde_json::to_value(body),
        Message::Heartbeat(body) => serde_json::to_value(body),
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
