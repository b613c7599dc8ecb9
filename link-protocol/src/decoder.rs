//! From bytes to messages, whatever the bytes: splits, noise and lost delimiters cost frames, never a wrong message.
//!
//! ```text
//!              0x00                     byte
//!   Hunting ──────────► Collecting ◄──────────┐
//!      ▲                  │  │  └─────────────┘
//!      └──────────────────┘  └── 0x00: COBS, CRC, body ──► Received (or counted), then Collecting anew
//!        more than a frame holds
//! ```
//!
//! Each run of bytes between zeros ends in exactly one counter of [`DecodeCounters`].

use crate::{
    BodyError, HEADER, Header, KIND_SIGNED, Kind, MAX_RAW, Message, Signature, TRAILER, crc32c,
};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A whole frame: its CRC was right.
#[derive(Clone, Debug, PartialEq)]
pub struct Received {
    /// Version, session and sequence number.
    pub header: Header,
    /// The message, or why the body is none.
    pub message: Result<Message, BodyError>,
    /// The signature, where the frame carried one. It is not checked here.
    pub signature: Option<Signature>,
}

/// What became of the bytes between zeros.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct DecodeCounters {
    /// Whole frames with a message.
    pub ok: u32,
    /// Frames whose CRC is wrong, or too short to have one.
    pub bad_crc: u32,
    /// More bytes than a frame holds.
    pub overflow: u32,
    /// Bytes that are no COBS.
    pub bad_cobs: u32,
    /// Whole frames whose body left bytes over.
    pub trailing_bytes: u32,
    /// Whole frames that are no message of this version otherwise.
    pub not_understood: u32,
}

impl DecodeCounters {
    /// Everything that was no message.
    pub fn bad(&self) -> u32 {
        self.bad_crc
            .wrapping_add(self.overflow)
            .wrapping_add(self.bad_cobs)
            .wrapping_add(self.trailing_bytes)
            .wrapping_add(self.not_understood)
    }
}

/// COBS of a frame: one byte more.
const MAX_COBS: usize = MAX_RAW + 1;

/// Takes bytes in any split and gives messages.
#[derive(Clone, Debug)]
pub struct Decoder {
    state: State,
    bytes: [u8; MAX_COBS],
    /// Bytes of the frame received last, which stand first in `bytes`.
    whole: usize,
    counters: DecodeCounters,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Dropping bytes until a zero.
    Hunting,
    /// This many bytes since the last zero.
    Collecting(usize),
}

impl Decoder {
    /// A decoder at the start of a stream.
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

    /// What was counted so far.
    pub fn counters(&self) -> DecodeCounters {
        self.counters
    }

    /// What the signature of the frame that came last covers: all before its tag. Empty where it was not signed; holds
    /// until the next byte.
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

    /// Kind and body of the frame that came last: what can be told of one that is no message of this version. `None` where
    /// no message has its kind, or where it is too short for its signature; holds until the next byte.
    pub fn kind_and_body(&self) -> Option<(Kind, &[u8])> {
        let kind = Kind::from_byte(self.kind() & !KIND_SIGNED)?;
        Some((kind, self.body_and_signature().0?))
    }

    /// The last byte of the header.
    fn kind(&self) -> u8 {
        self.bytes[HEADER - 1]
    }

    fn body_and_signature(&self) -> (Option<&[u8]>, Option<Signature>) {
        let end = self.whole.saturating_sub(TRAILER);
        split_signature(self.kind(), self.bytes.get(HEADER..end).unwrap_or_default())
    }

    /// Takes one byte; gives a frame where this byte completed one whose CRC is right.
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

/// Header and body of raw bytes whose CRC is right.
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
