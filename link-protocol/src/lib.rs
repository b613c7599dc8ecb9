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
//! for ever, in frames of any version, so that two ends that do not match can say so; so do [`Request::Stop`],
//! [`Request::EStop`] and the [`Reply::Done`] that answers them, so that every end stops every robot. Enum variants are only
//! appended. `tests/golden/` holds the bytes of every message, a file for each version and one for what is for ever; they
//! are never edited.
//!
//! Version 2 is version 1 with another keep-alive, the [`Heartbeat`], and with signed answers where there is a key. A host of
//! version 1 may read and stop a robot of version 2; to power the servos takes [`POWER_SINCE`].
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
//! use link_protocol::{Decoder, Header, MAX_ENCODED, Message, Ping, encode};
//!
//! let ping = Message::Ping(Ping { host_us: 7 });
//! let mut frame = [0; MAX_ENCODED];
//! let length = encode(Header::new(1, 2), &ping, &mut frame).unwrap();
//!
//! let mut decoder = Decoder::new();
//! let received = frame[..length].iter().find_map(|&byte| decoder.push(byte)).unwrap();
//! assert_eq!((received.header, received.message), (Header::new(1, 2), Ok(ping)));
//!
//! frame[4] ^= 1;
//! assert!(frame[..length].iter().all(|&byte| decoder.push(byte).is_none()), "a flipped bit is noticed");
//! ```
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
pub use configuration::{Configuration, Joint, PulseRange, ServoSettings, TangentialDrag};
pub use decoder::{DecodeCounters, Decoder, Received};
pub use frame::{Direction, EncodeError, Header, Kind, Signature, encode, encode_body};
pub use hello::{
    Board, FirmwareVersion, Hello, HelloReply, HelloReplyStart, ResetReason, RobotLimits,
};
pub use message::{BodyError, Message};
pub use refusal::{CrossingPlace, Refusal};
pub use reply::{BenchStatus, Counters, Reply, Status, TableInfo};
pub use request::{Arm, Begin, Chunk, Follow, Play, Request};
pub use seal::{Binding, Key, Seal, encode_signed};
pub use telemetry::{Flags, Heartbeat, Ping, Pong, Pose, StateName, StopCause, Telemetry};

/// Lowest protocol version this crate understands.
pub const PROTOCOL_MIN: u8 = 1;
/// The protocol version this crate speaks.
pub const PROTOCOL_CURRENT: u8 = 2;
/// Lowest version whose requests may power the servos: keep-alives before it could be old without anybody knowing.
pub const POWER_SINCE: u8 = 2;
/// The version of the frames that stops go out in: every robot there is reads them.
pub const STOP_VERSION: u8 = 1;
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
/// Identifies the set of messages of version 1 by their structure ([`postcard_schema`]'s key of all messages as they were
/// frozen): what a robot or host of that version says of itself.
pub const SCHEMA_KEY_V1: [u8; 8] = [0xC7, 0x47, 0x8B, 0x1F, 0x03, 0x22, 0x6B, 0x44];
/// The same of version 2: two ends with the same key read the same fields. Variants appended since change no byte of what was
/// there, and an end that does not know one says so ([`Refusal::NotUnderstood`]).
pub const SCHEMA_KEY: [u8; 8] = [0xCF, 0x6C, 0x35, 0xBC, 0x8D, 0x1E, 0x81, 0xB9];
/// The structure of all messages as they are now, appended variants too: for the golden files, never on the wire.
pub const SCHEMA_NOW: [u8; 8] =
    postcard_schema::key::Key::for_path::<message::Schemas>("swimmer/link/v2").to_bytes();
