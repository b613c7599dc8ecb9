//! Frame decoder for arbitrary bytes: splits, noise and lost delimiters lose frames, but never yield a wrong message.
//!
//! ```text
//!              0x00                     byte
//!   Hunting ──────────► Collecting ◄──────────┐
//!      ▲                  │  │  └─────────────┘
//!      └──────────────────┘  └── 0x00: COBS, CRC, body ──► Received (or counted), then Collecting anew
//!        more than a frame holds
//! ```
//!
//! Each run of bytes between zeros increments exactly one counter of [`DecodeCounters`].

use crate::{
    BodyError, HEADER, Header, KIND_SIGNED, Kind, MAX_RAW, Message, Signature, TRAILER, crc32c,
};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Complete frame with a correct CRC.
#[derive(Clone, Debug, PartialEq)]
pub struct Received {
    /// Version, session and sequence number.
    pub header: Header,
    /// The message, or the error of its body.
    pub message: Result<Message, BodyError>,
    /// Signature of the frame, if any. It is not verified here.
    pub signature: Option<Signature>,
}

/// Outcomes of the runs of bytes between zeros.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct DecodeCounters {
    /// Complete frames with a message.
    pub ok: u32,
    /// Frames with a wrong CRC, or too short for one.
    pub bad_crc: u32,
    /// Runs that exceed a frame.
    pub overflow: u32,
    /// Runs that are no valid COBS.
    pub bad_cobs: u32,
    /// Complete frames with extra bytes after the message.
    pub trailing_bytes: u32,
    /// Complete frames whose body is no message of this version for another reason.
    pub not_understood: u32,
}

impl DecodeCounters {
    /// Total of all runs without a message.
    pub fn bad(&self) -> u32 {
        self.bad_crc
            .wrapping_add(self.overflow)
            .wrapping_add(self.bad_cobs)
            .wrapping_add(self.trailing_bytes)
            .wrapping_add(self.not_understood)
    }
}

/// Length of the COBS encoding of the longest frame: one byte more.
const MAX_COBS: usize = MAX_RAW + 1;

/// Decoder of messages from bytes in any split.
#[derive(Clone, Debug)]
pub struct Decoder {
    state: State,
    bytes: [u8; MAX_COBS],
    /// Length of the last frame, stored at the start of `bytes`.
    whole: usize,
    counters: DecodeCounters,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Discarding bytes until a zero.
    Hunting,
    /// Number of bytes since the last zero.
    Collecting(usize),
}

impl Decoder {
    /// Returns a decoder at the start of a stream.
    pub const fn new() -> Self {
        Self {
            state: State::Collecting(0),
            bytes: [0; MAX_COBS],
            whole: 0,
            counters: DecodeCounters {
                ok: 0,
                bad_crc: 0,
                overflow: 0,
                bad_cobs: 0,
                trailing_bytes: 0,
                not_understood: 0,
            },
        }
    }

    /// Counts so far.
    pub fn counters(&self) -> DecodeCounters {
        self.counters
    }

    /// Bytes of the last frame that its signature covers: everything before the tag. Empty for an unsigned frame; valid until
    /// the next byte.
    pub fn signed_bytes(&self) -> &[u8] {
        let (_, signature) = self.body_and_signature();
        let unsigned = if signature.is_some() {
            TRAILER + Signature::TAG
        } else {
            self.whole
        };
        let covered = self.whole.saturating_sub(unsigned);
        self.bytes.get(..covered).unwrap_or_default()
    }

    /// Kind and body of the last frame, also if it is no message of this version. Returns `None` for an unknown kind, or if the
    /// frame is too short for its signature. Valid until the next byte.
    pub fn kind_and_body(&self) -> Option<(Kind, &[u8])> {
        let kind = Kind::from_byte(self.kind() & !KIND_SIGNED)?;
        Some((kind, self.body_and_signature().0?))
    }

    /// Kind byte: the last byte of the header.
    fn kind(&self) -> u8 {
        self.bytes[HEADER - 1]
    }

    fn body_and_signature(&self) -> (Option<&[u8]>, Option<Signature>) {
        let end = self.whole.saturating_sub(TRAILER);
        split_signature(self.kind(), self.bytes.get(HEADER..end).unwrap_or_default())
    }

    /// Adds one byte. Returns the frame that it completes, if the CRC is correct.
    pub fn push(&mut self, byte: u8) -> Option<Received> {
        match (self.state, byte) {
            (State::Hunting, 0) => self.state = State::Collecting(0),
            (State::Collecting(len), 0) => {
                self.state = State::Collecting(0);
                if len > 0 {
                    return self.complete(len);
                }
            }
            (State::Hunting, _) => {}
            (State::Collecting(len), _) => {
                if let Some(place) = self.bytes.get_mut(len) {
                    *place = byte;
                    self.state = State::Collecting(len + 1);
                } else {
                    count(&mut self.counters.overflow);
                    self.state = State::Hunting;
                }
            }
        }
        None
    }

    fn complete(&mut self, len: usize) -> Option<Received> {
        let Ok(len) = cobs::decode_in_place(&mut self.bytes[..len]) else {
            count(&mut self.counters.bad_cobs);
            return None;
        };
        let raw = &self.bytes[..len];
        let Some((&[version, s0, s1, q0, q1, kind], body)) = checked(raw) else {
            count(&mut self.counters.bad_crc);
            return None;
        };
        let header = Header {
            version,
            session: u16::from_le_bytes([s0, s1]),
            sequence: u16::from_le_bytes([q0, q1]),
        };
        let (body, signature) = split_signature(kind, body);
        self.whole = len;
        let message = match body {
            Some(body) => Message::decode_body(version, kind & !KIND_SIGNED, body),
            None => Err(BodyError::Malformed),
        };
        count(match message {
            Ok(_) => &mut self.counters.ok,
            Err(BodyError::TrailingBytes(_)) => &mut self.counters.trailing_bytes,
            Err(_) => &mut self.counters.not_understood,
        });
        Some(Received {
            header,
            message,
            signature,
        })
    }
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

/// Splits raw bytes into header and body. Returns `None` if the CRC is wrong.
fn checked(raw: &[u8]) -> Option<(&[u8; HEADER], &[u8])> {
    let (covered, crc) = raw.split_last_chunk::<TRAILER>()?;
    let (header, body) = covered.split_first_chunk::<HEADER>()?;
    (crc32c(covered) == u32::from_le_bytes(*crc)).then_some((header, body))
}

fn split_signature(kind: u8, body: &[u8]) -> (Option<&[u8]>, Option<Signature>) {
    if kind & KIND_SIGNED == 0 {
        return (Some(body), None);
    }
    match body.split_last_chunk::<{ Signature::LEN }>() {
        Some((body, signature)) => (Some(body), Some(Signature::from_bytes(*signature))),
        None => (None, None),
    }
}

fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}
