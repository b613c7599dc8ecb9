//! Wire protocol between host and robot: every message of the serial link, the frame that carries it, and the version of both.
//! The crate has no behaviour; `gait-player` (the robot) and `host-link` (the host) implement the two ends.
//!
//! # A frame, byte by byte
//!
//! ```text
//!  00 | COBS( version u8 | session u16 | sequence u16 | kind u8 | postcard body | CRC-32C ) | 00
//!     |       \______________ header, little-endian __________/   0..=118 bytes   LE       |
//!     burst start                                                              delimiter
//! ```
//!
//! At most [`MAX_RAW`] bytes before COBS. The CRC covers header and body and is checked before the body is decoded; decoding
//! must consume the whole body. A leading zero terminates any garbage before the frame.
//!
//! # Versions
//!
//! This is version 1.0: the byte [`PROTOCOL_CURRENT`]. [`PROTOCOL_MIN`] is the oldest supported version. [`Hello`],
//! [`HelloReply`], [`Request::Stop`], [`Request::EStop`] and the [`Reply::Done`] to a stop have the same encoding in every
//! version, and are read regardless of the version byte of their frame. So incompatible ends can report the mismatch, and every
//! host can stop every robot. Enum variants are only appended. `tests/golden/` holds the bytes of every message: one file per
//! version, and one for the messages common to all versions. The files are never edited.
//!
//! # Authority
//!
//! [`Request::class`] gives each request its [`RequestClass`], and [`RequestClass::needs`] the conditions under which the robot
//! executes it. The robot checks them first; the tables of the documentation are generated from them.
//!
//! # Authentication
//!
//! The top bit of `kind` is [`KIND_SIGNED`]: such a frame carries a [`Signature`] (monotonic counter and truncated keyed tag)
//! between body and CRC. Robots without a key skip it; unsigned frames do not change. A [`Seal`] signs and verifies.
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

/// Lowest supported protocol version.
pub const PROTOCOL_MIN: u8 = 0x10;
/// Protocol version of this crate: 1.0. The upper four bits are the major number, the lower four the minor one. Builds before
/// the first release used 0.1 and 0.2 (the bytes 1 and 2), which are not supported.
pub const PROTOCOL_CURRENT: u8 = 0x10;
/// Longest scheduled motion without a host, µs.
pub const MAX_DETACHED_US: u64 = 3_600_000_000;
/// Largest frame before COBS, bytes: header, body and CRC.
pub const MAX_RAW: usize = 128;
/// Length of the header, bytes.
pub const HEADER: usize = 6;
/// Length of the CRC, bytes.
pub const TRAILER: usize = 4;
/// Largest body, bytes.
pub const MAX_BODY: usize = MAX_RAW - HEADER - TRAILER;
/// Largest frame on the wire, bytes: burst start, COBS of [`MAX_RAW`] bytes (one more), delimiter.
pub const MAX_ENCODED: usize = MAX_RAW + 3;
/// Most table bytes in one [`Chunk`].
pub const MAX_CHUNK: usize = 104;
/// Most table bytes in a signed [`Chunk`]. Chunks may split a knot.
pub const MAX_SIGNED_CHUNK: usize = MAX_CHUNK - Signature::LEN;
/// Largest number of knots of a gait table; a knot is two i16 of [`ANGLE_UNIT_RAD`], four bytes.
pub const MAX_KNOTS: usize = 512;
/// Largest gait table, bytes.
pub const MAX_TABLE: usize = 4 * MAX_KNOTS;
/// Unit of angles in tables and telemetry, rad.
pub const ANGLE_UNIT_RAD: f32 = 1e-4;
/// Top bit of the kind byte: the frame carries a [`Signature`].
pub const KIND_SIGNED: u8 = 0x80;
/// Identifier of the messages of version 1.0 by their structure ([`postcard_schema`]'s key of all messages as they were
/// frozen). Two ends with the same key read the same fields. Variants appended since do not change the encoding of earlier
/// ones; an end that does not know a variant reports it ([`Refusal::NotUnderstood`]).
pub const SCHEMA_KEY: [u8; 8] = [0x4D, 0x5F, 0x70, 0xF7, 0x8B, 0x7A, 0x68, 0x1C];
/// Key of the present structure of all messages, with appended variants: for the golden files, never on the wire.
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
