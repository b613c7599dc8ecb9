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
//! [`PROTOCOL_CURRENT`] is spoken, [`PROTOCOL_MIN`] still understood. [`Hello`] and [`HelloReply`] keep their encoding
//! for ever, in frames of any version, so that two ends that do not match can say so. Enum variants are only appended.
//! `tests/golden/v1.txt` holds the bytes of every message of version 1; it is never edited.
//!
//! # Authentication
//!
//! The top bit of `kind` is [`KIND_SIGNED`]: such a frame carries a [`Signature`] (monotonic counter and truncated
//! keyed tag) between body and CRC. Robots without a key read past it; unsigned frames are unchanged by it. What signs and
//! verifies is a [`Seal`].
#![cfg_attr(not(test), no_std)]

mod checksum;
mod configuration;
mod decoder;
mod frame;
mod hello;
mod message;
mod refusal;
mod reply;
mod request;
mod seal;
mod telemetry;

pub use checksum::{Checksum, crc32c};
pub use configuration::{Configuration, Joint, ServoSettings, TangentialDrag};
pub use decoder::{DecodeCounters, Decoder, Received};
pub use frame::{Direction, EncodeError, Header, Kind, Signature, encode, encode_body};
pub use hello::{
    Board, FirmwareVersion, Hello, HelloReply, HelloReplyStart, ResetReason, RobotLimits,
};
pub use message::{BodyError, Message};
pub use refusal::{CrossingPlace, Refusal};
pub use reply::{Counters, Reply, Status, TableInfo};
pub use request::{Arm, Begin, Chunk, Play, Request};
pub use seal::{Binding, Key, Seal, encode_signed};
pub use telemetry::{Flags, Ping, Pong, Pose, StateName, StopCause, Telemetry};

/// Lowest protocol version this crate understands.
pub const PROTOCOL_MIN: u8 = 1;
/// The protocol version this crate speaks.
pub const PROTOCOL_CURRENT: u8 = 1;
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
/// Identifies the set of messages by their structure: two ends with the same key read the same fields. It is that of
/// version 1 as it was frozen ([`postcard_schema`]'s key of all messages then); variants appended since change no byte of
/// what was there, and an end that does not know one says so ([`Refusal::NotUnderstood`]).
pub const SCHEMA_KEY: [u8; 8] = [0xC7, 0x47, 0x8B, 0x1F, 0x03, 0x22, 0x6B, 0x44];
/// The structure of all messages as they are now, appended variants too: for the golden files, never on the wire.
pub const SCHEMA_NOW: [u8; 8] =
    postcard_schema::key::Key::for_path::<message::Schemas>("swimmer/link/v1").to_bytes();
