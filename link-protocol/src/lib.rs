//! The contract of the wire between host and robot, and nothing else: every message that crosses the serial link,
//! the frame that carries it and the version of both. There is no behaviour here; who may send what, when, and what
//! happens then is decided in `gait-player` (the robot) and `host-link` (the host).
//!
//! # A frame, byte by byte
//!
//! ```text
//!  00 | COBS( version u8 | session u16 | sequence u16 | kind u8 | postcard body | CRC-32C ) | 00
//!     |       \______________ header, little-endian __________/   0..=118 bytes   LE       |
//!     burst start                                                              delimiter
//! ```
//!
//! At most [`MAX_RAW`] bytes before COBS. The CRC covers header and body and is checked before the body is looked at;
//! the body must then be used up to its last byte. A leading zero ends whatever garbage came before.
//!
//! # Versions
//!
//! This is version 1.0: the byte [`PROTOCOL_CURRENT`]. [`PROTOCOL_MIN`] is the oldest version still understood.
//! [`Hello`], [`HelloReply`], [`Request::Stop`], [`Request::EStop`] and the [`Reply::Done`] that answers a stop keep their
//! encoding in every version, and are read whatever the version byte of their frame. So two ends that do not match can report
//! it, and every host stops every robot. Enum variants are only appended. `tests/golden/` holds the bytes of every message,
//! one file per version and one for the messages of every version; the files are never edited.
//!
//! # Authority
//!
//! [`Request::class`] gives each request its [`RequestClass`], and [`RequestClass::needs`] the conditions under which the robot
//! lets it act. The robot enforces them before anything else; the tables of the documentation are generated from them.
//!
//! # Authentication
//!
//! The top bit of `kind` is [`KIND_SIGNED`]: such a frame carries a [`Signature`] (monotonic counter and truncated
//! keyed tag) between body and CRC. Robots without a key read past it; unsigned frames are unchanged by it. What signs and
//! verifies is a [`Seal`].
//!
//! # An example
//!
//! ```
//! use link_protocol::{Decoder, Header, MAX_ENCODED, Message, Request, encode};
//!
//! let status = Message::Request(Request::Status);
//! let mut frame = [0; MAX_ENCODED];
//! let length = encode(Header::new(1, 2), &status, &mut frame).unwrap();
//!
//! let mut decoder = Decoder::new();
//! let received = frame[..length].iter().find_map(|&byte| decoder.push(byte)).unwrap();
//! assert_eq!((received.header, received.message), (Header::new(1, 2), Ok(status)));
//!
//! frame[4] ^= 1;
//! assert!(frame[..length].iter().all(|&byte| decoder.push(byte).is_none()), "a flipped bit is noticed");
//! ```
#![cfg_attr(not(test), no_std)]

mod authority;
mod checksum;
mod configuration;
mod decoder;
mod frame;
mod hello;
mod message;
mod redact;
mod refusal;
mod reply;
mod request;
mod seal;
mod telemetry;

pub use authority::{Needs, RequestClass, SettingsHeld, StateNeeded};
pub use checksum::{Checksum, crc32c};
pub use configuration::{
    Configuration, Joint, PulseRange, ServoSettings, TangentialDrag, settings_crc32,
};
pub use decoder::{DecodeCounters, Decoder, Received};
pub use frame::{Direction, EncodeError, Header, Kind, Signature, encode, encode_body};
pub use hello::{
    Board, FirmwareVersion, Hello, HelloReply, HelloReplyStart, ResetReason, RobotLimits,
};
pub use message::{BodyError, Message};
pub use redact::redact_keys;
pub use refusal::{CrossingPlace, Refusal};
pub use reply::{BenchStatus, Counters, Reply, Status, TableInfo};
pub use request::{Begin, Checked, Chunk, Follow, Play, Request};
pub use seal::{Binding, Key, Seal, encode_signed};
pub use telemetry::{Flags, Heartbeat, Pong, Pose, StateName, StopCause, Telemetry};

/// Lowest protocol version this crate understands.
pub const PROTOCOL_MIN: u8 = 0x10;
/// The protocol version this crate speaks: 1.0. The upper four bits are the major number, the lower four the minor one.
/// Builds before the first release used 0.1 and 0.2 (the bytes 1 and 2); nothing reads them.
pub const PROTOCOL_CURRENT: u8 = 0x10;
/// Longest motion that a robot may have ahead of it without a host, µs.
pub const MAX_DETACHED_US: u64 = 3_600_000_000;
/// Most raw bytes of a frame: header, body and CRC, before COBS.
pub const MAX_RAW: usize = 128;
/// Bytes of the header.
pub const HEADER: usize = 6;
/// Bytes of the CRC.
pub const TRAILER: usize = 4;
/// Most bytes of a body.
pub const MAX_BODY: usize = MAX_RAW - HEADER - TRAILER;
/// Most bytes of a frame on the wire: burst start, COBS of [`MAX_RAW`] bytes (one more), delimiter.
pub const MAX_ENCODED: usize = MAX_RAW + 3;
/// Most bytes of table data in one [`Chunk`].
pub const MAX_CHUNK: usize = 104;
/// The same where the frame is signed. A whole number of knots is not needed: pieces may split one.
pub const MAX_SIGNED_CHUNK: usize = MAX_CHUNK - Signature::LEN;
/// Most knots of a gait table; a knot is two i16 of [`ANGLE_UNIT_RAD`], four bytes.
pub const MAX_KNOTS: usize = 512;
/// Most bytes of a gait table.
pub const MAX_TABLE: usize = 4 * MAX_KNOTS;
/// The unit of angles in tables and telemetry, in radians.
pub const ANGLE_UNIT_RAD: f32 = 1e-4;
/// Top bit of the kind byte: the frame carries a [`Signature`].
pub const KIND_SIGNED: u8 = 0x80;
/// Identifies the messages of version 1.0 by their structure ([`postcard_schema`]'s key of all messages as they were frozen).
/// Two ends with the same key read the same fields. Variants appended since change no byte of the earlier ones; an end that
/// does not know a variant reports it ([`Refusal::NotUnderstood`]).
pub const SCHEMA_KEY: [u8; 8] = [0x4D, 0x5F, 0x70, 0xF7, 0x8B, 0x7A, 0x68, 0x1C];
/// Key of the structure of all messages as they are now, appended variants included: for the golden files, never on the wire.
pub const SCHEMA_NOW: [u8; 8] =
    postcard_schema::key::Key::for_path::<message::Schemas>("swimmer/link/v1").to_bytes();

/// Name of a version byte.
///
/// ```
/// assert_eq!(link_protocol::VersionName(0x10).to_string(), "1.0");
/// assert_eq!(link_protocol::VersionName(2).to_string(), "0.2");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VersionName(pub u8);

impl core::fmt::Display for VersionName {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{}.{}", self.0 >> 4, self.0 & 15)
    }
}
