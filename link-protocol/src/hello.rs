//! Greeting: equal in all versions, so that ends of different versions can report the mismatch.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Host to robot: opens a session. A repeated `host_nonce` is a retransmission and keeps the session; a new one opens the next
/// session. The motion is not affected. The session number of its frame is ignored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Hello {
    /// Lowest protocol version that the host supports.
    pub protocol_min: u8,
    /// Protocol version of the host.
    pub protocol_current: u8,
    /// The host's [`crate::SCHEMA_KEY`].
    pub schema_key: [u8; 8],
    /// Random number of the host, new for each session.
    pub host_nonce: u32,
}

/// Robot to host: reply to [`Hello`]. Its frame carries the new session number and the Hello's sequence number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct HelloReply {
    /// Nonce of the [`Hello`].
    pub host_nonce: u32,
    /// Lowest protocol version that the robot supports.
    pub protocol_min: u8,
    /// Protocol version of the robot.
    pub protocol_current: u8,
    /// The robot's [`crate::SCHEMA_KEY`].
    pub schema_key: [u8; 8],
    /// Version and commit of the firmware.
    pub firmware: FirmwareVersion,
    /// Board type.
    pub board: Board,
    /// Cause of the last start.
    pub reset_reason: ResetReason,
    /// A crash message from before that start is available through [`crate::Request::CrashMessage`]. On the wire it is the
    /// lowest bit of a byte with seven spare bits: sent as 0, ignored on reception.
    #[serde(with = "lowest_bit")]
    pub crash_message: bool,
    /// Session that the greeting opened; every later frame carries it.
    pub session: u16,
    /// Random number of this start: it changes if the robot restarts.
    pub boot_nonce: u32,
    /// Limits in force.
    pub limits: RobotLimits,
    /// Capacity of the robot's receive buffer, bytes: the most that may be in flight.
    pub buffer: u16,
}

/// Start of a [`HelloReply`], which decodes even if the rest has a newer board or reset reason.
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
    /// Same as [`HelloReply::host_nonce`].
    pub host_nonce: u32,
    /// Same as [`HelloReply::protocol_min`].
    pub protocol_min: u8,
    /// Same as [`HelloReply::protocol_current`].
    pub protocol_current: u8,
    /// Same as [`HelloReply::schema_key`].
    pub schema_key: [u8; 8],
    /// Same as [`HelloReply::firmware`].
    pub firmware: FirmwareVersion,
}

impl HelloReplyStart {
    /// Decodes the start of a body. Returns `None` if the body is too short.
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

/// Flag in a byte with seven spare bits, for a message that must never grow.
mod lowest_bit {
    use serde::{Deserialize, Deserializer, Serializer};

    #[allow(clippy::trivially_copy_pass_by_ref)] // signature required by serde
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
    /// First eight hexadecimal digits of the commit in ASCII; zeros if unknown.
    pub commit: [u8; 8],
}

/// Board on which the brain runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Board {
    /// Digital twin on a host.
    Twin,
    /// Arduino Nano RP2040 Connect.
    NanoRp2040Connect,
    /// Raspberry Pi Pico.
    Pico,
}

/// Cause of the last start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ResetReason {
    /// Power was switched on, or failed for a moment.
    PowerOn,
    /// The watchdog detected a hung control task.
    Watchdog,
    /// The program crashed and reset itself.
    Crash,
    /// The reset pin or a debug probe.
    Pin,
}

/// Limits in force: the firmware's, tightened by the configuration.
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
    /// Largest number of knots of a table.
    pub max_knots: u16,
    /// Most bytes of chunks in flight.
    pub upload_window: u16,
}
