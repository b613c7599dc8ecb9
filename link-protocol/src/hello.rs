//! The greeting, which is the same in all versions, so that two ends of different versions can report it.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Host to robot: opens a session. The same `host_nonce` again is the same greeting (a retransmission) and keeps the
/// session; a new one opens the next session. Changes no state of motion. Its frame's session number is ignored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Hello {
    /// Lowest protocol version the host understands.
    pub protocol_min: u8,
    /// Protocol version the host speaks.
    pub protocol_current: u8,
    /// The host's [`crate::SCHEMA_KEY`].
    pub schema_key: [u8; 8],
    /// Drawn anew by the host for each session it wants.
    pub host_nonce: u32,
}

/// Robot to host: the answer to [`Hello`]; its frame carries the new session number and the Hello's sequence number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct HelloReply {
    /// The nonce of the [`Hello`] this answers.
    pub host_nonce: u32,
    /// Lowest protocol version the robot understands.
    pub protocol_min: u8,
    /// Protocol version the robot speaks.
    pub protocol_current: u8,
    /// The robot's [`crate::SCHEMA_KEY`].
    pub schema_key: [u8; 8],
    /// Version and commit of the firmware.
    pub firmware: FirmwareVersion,
    /// What carries the brain.
    pub board: Board,
    /// Why the robot last started.
    pub reset_reason: ResetReason,
    /// A message of a crash before that start waits for [`crate::Request::CrashMessage`]. On the wire it is the lowest
    /// bit of a byte whose other bits are spare: sent as 0, ignored here.
    #[serde(with = "lowest_bit")]
    pub crash_message: bool,
    /// The session this greeting opened; every later frame carries it.
    pub session: u16,
    /// Drawn at boot: a change tells the host that the robot restarted.
    pub boot_nonce: u32,
    /// What the robot allows at present.
    pub limits: RobotLimits,
    /// Bytes the robot's receive buffer holds: the most that may be in flight.
    pub buffer: u16,
}

/// How a [`HelloReply`] begins: what it tells of itself even where the rest names a board or a reason that was appended
/// since, and is no message to this end.
///
/// ```
/// use link_protocol::{FirmwareVersion, HelloReplyStart};
///
/// let firmware = FirmwareVersion { major: 1, minor: 2, patch: 3, commit: *b"abcdef01" };
/// let start = HelloReplyStart { host_nonce: 5, protocol_min: 1, protocol_current: 9, schema_key: [0; 8], firmware };
/// let mut body = [0xFF; 64]; // what a later version says after the start is not looked at
/// postcard::to_slice(&start, &mut body).unwrap();
/// assert_eq!(HelloReplyStart::of_body(&body), Some(start));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HelloReplyStart {
    /// As [`HelloReply::host_nonce`].
    pub host_nonce: u32,
    /// As [`HelloReply::protocol_min`].
    pub protocol_min: u8,
    /// As [`HelloReply::protocol_current`].
    pub protocol_current: u8,
    /// As [`HelloReply::schema_key`].
    pub schema_key: [u8; 8],
    /// As [`HelloReply::firmware`].
    pub firmware: FirmwareVersion,
}

impl HelloReplyStart {
    /// The start of a body; `None` where it is too short.
    pub fn of_body(body: &[u8]) -> Option<Self> {
        let (start, _) = postcard::take_from_bytes(body).ok()?;
        Some(start)
    }
}

impl From<&HelloReply> for HelloReplyStart {
    fn from(reply: &HelloReply) -> Self {
        Self {
            host_nonce: reply.host_nonce,
            protocol_min: reply.protocol_min,
            protocol_current: reply.protocol_current,
            schema_key: reply.schema_key,
            firmware: reply.firmware,
        }
    }
}

/// A flag in a byte that leaves room for seven more, in a message that may never grow.
mod lowest_bit {
    use serde::{Deserialize, Deserializer, Serializer};

    #[allow(clippy::trivially_copy_pass_by_ref)] // serde's signature
    pub(super) fn serialize<S: Serializer>(flag: &bool, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u8(u8::from(*flag))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<bool, D::Error> {
        Ok(u8::deserialize(deserializer)? & 1 != 0)
    }
}

/// Version and commit of the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct FirmwareVersion {
    /// Major version.
    pub major: u8,
    /// Minor version.
    pub minor: u8,
    /// Patch version.
    pub patch: u8,
    /// First eight hexadecimal digits of the commit in ASCII; zeros where unknown.
    pub commit: [u8; 8],
}

/// What carries the brain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Board {
    /// The twin on a host.
    Twin,
    /// Arduino Nano RP2040 Connect.
    NanoRp2040Connect,
    /// Raspberry Pi Pico.
    Pico,
}

/// Why the robot last started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ResetReason {
    /// Power was applied, or failed for a moment.
    PowerOn,
    /// The watchdog found the control task hung.
    Watchdog,
    /// The program crashed and reset itself.
    Crash,
    /// The reset pin or the probe.
    Pin,
}

/// What the robot allows: the firmware's limits, tightened by the configuration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct RobotLimits {
    /// Largest |φ|, rad.
    pub max_angle: f32,
    /// Largest |dφ/dt|, rad/s.
    pub max_rate: f32,
    /// Shortest pulse, ns.
    pub pulse_min_ns: u32,
    /// Longest pulse, ns.
    pub pulse_max_ns: u32,
    /// Most knots of a table.
    pub max_knots: u16,
    /// Bytes of chunks that may be in flight.
    pub upload_window: u16,
}
