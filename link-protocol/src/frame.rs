//! Frame: header, body and checksum in COBS between zeros. Encoding writes to the caller's buffer.

use crate::{
    HEADER, KIND_SIGNED, MAX_ENCODED, MAX_RAW, Message, PROTOCOL_CURRENT, TRAILER, crc32c,
};

/// Direction of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Host to robot.
    ToRobot,
    /// Robot to host.
    ToHost,
}

/// Header of a frame, before its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Protocol version of the body.
    pub version: u8,
    /// Session of the frame.
    pub session: u16,
    /// Matches replies to requests; counts telemetry.
    pub sequence: u16,
}

impl Header {
    /// Header with the present protocol version.
    pub fn new(session: u16, sequence: u16) -> Self {
        Self {
            version: PROTOCOL_CURRENT,
            session,
            sequence,
        }
    }
}

/// Kind byte of a frame, without [`KIND_SIGNED`].
///
/// ```
/// use link_protocol::{Kind, Message, Request};
///
/// assert_eq!(Kind::from_byte(3), Some(Message::Request(Request::Stop).kind()));
/// assert_eq!(Kind::from_byte(99), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// [`crate::Hello`].
    Hello = 1,
    /// [`crate::HelloReply`].
    HelloReply = 2,
    /// [`crate::Request`].
    Request = 3,
    /// [`crate::Reply`].
    Reply = 4,
    /// [`crate::Telemetry`].
    Telemetry = 5,
    /// [`crate::Heartbeat`].
    Heartbeat = 6,
    /// [`crate::Pong`].
    Pong = 7,
}

impl Kind {
    /// Kind of this byte. Returns `None` if it is unknown.
    pub fn from_byte(byte: u8) -> Option<Self> {
        Some(match byte {
            1 => Self::Hello,
            2 => Self::HelloReply,
            3 => Self::Request,
            4 => Self::Reply,
            5 => Self::Telemetry,
            6 => Self::Heartbeat,
            7 => Self::Pong,
            _ => return None,
        })
    }
}

/// Signature of a frame, between body and CRC: a monotonic counter, and a truncated keyed tag over header, body and counter
/// ([`crate::Seal`]). A robot without a key skips it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signature {
    /// Counter, 48 bits. It never repeats under one key.
    pub counter: u64,
    /// Truncated tag.
    pub tag: [u8; 8],
}

impl Signature {
    /// Length in the frame, bytes.
    pub const LEN: usize = 14;
    /// Length of the tag, which ends the signature, bytes.
    pub const TAG: usize = 8;

    /// Encoded counter.
    pub(crate) fn counter_bytes(counter: u64) -> [u8; 6] {
        let [c0, c1, c2, c3, c4, c5, _, _] = counter.to_le_bytes();
        [c0, c1, c2, c3, c4, c5]
    }

    pub(crate) fn from_bytes(bytes: [u8; Self::LEN]) -> Self {
        let [c0, c1, c2, c3, c4, c5, tag @ ..] = bytes;
        Self {
            counter: u64::from_le_bytes([c0, c1, c2, c3, c4, c5, 0, 0]),
            tag,
        }
    }

    pub(crate) fn to_bytes(self) -> [u8; Self::LEN] {
        let mut bytes = [0; Self::LEN];
        bytes[..6].copy_from_slice(&Self::counter_bytes(self.counter));
        bytes[6..].copy_from_slice(&self.tag);
        bytes
    }
}

/// Encoded header.
pub(crate) fn header_bytes(header: Header, kind: u8) -> [u8; HEADER] {
    let [s0, s1] = header.session.to_le_bytes();
    let [q0, q1] = header.sequence.to_le_bytes();
    [header.version, s0, s1, q0, q1, kind]
}

/// Reason why a frame cannot be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncodeError {
    /// The body exceeds a frame.
    BodyTooLong,
    /// The buffer is shorter than [`MAX_ENCODED`].
    BufferTooShort,
}

/// Encodes `message` under `header` into `out`, with burst start and delimiter. Returns the number of bytes.
///
/// # Errors
/// `out` is shorter than [`MAX_ENCODED`]. The body of a message always fits.
pub fn encode(header: Header, message: &Message, out: &mut [u8]) -> Result<usize, EncodeError> {
    let mut body = [0; crate::MAX_BODY];
    let body = message
        .encode_body(&mut body)
        .map_err(|_| EncodeError::BodyTooLong)?;
    encode_body(header, message.kind() as u8, body, None, out)
}

/// Encodes an arbitrary body, signed or not: for stored replies, signatures and tests.
///
/// # Errors
/// `out` is shorter than [`MAX_ENCODED`], or body and signature exceed a frame.
///
/// ```
/// use link_protocol::{Decoder, Header, Kind, MAX_ENCODED, Message, Request, encode_body};
///
/// let mut frame = [0; MAX_ENCODED];
/// let length = encode_body(Header::new(1, 2), Kind::Request as u8, &[14], None, &mut frame).unwrap();
/// let mut decoder = Decoder::new();
/// let received = frame[..length].iter().find_map(|&byte| decoder.push(byte)).unwrap();
/// assert_eq!(received.message, Ok(Message::Request(Request::Stop)));
/// ```
pub fn encode_body(
    header: Header,
    kind: u8,
    body: &[u8],
    signature: Option<Signature>,
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    if out.len() < MAX_ENCODED {
        return Err(EncodeError::BufferTooShort);
    }
    let signed = if signature.is_some() {
        Signature::LEN
    } else {
        0
    };
    let covered = HEADER + body.len() + signed;
    if covered + TRAILER > MAX_RAW {
        return Err(EncodeError::BodyTooLong);
    }
    let mut raw = [0; MAX_RAW];
    raw[..HEADER].copy_from_slice(&header_bytes(header, kind & !KIND_SIGNED));
    raw[HEADER..HEADER + body.len()].copy_from_slice(body);
    if let Some(signature) = signature {
        raw[5] |= KIND_SIGNED;
        raw[HEADER + body.len()..covered].copy_from_slice(&signature.to_bytes());
    }
    let crc = crc32c(&raw[..covered]);
    raw[covered..covered + TRAILER].copy_from_slice(&crc.to_le_bytes());
    out[0] = 0;
    let written = cobs::try_encode(&raw[..covered + TRAILER], &mut out[1..])
        .map_err(|_| EncodeError::BufferTooShort)?;
    out[1 + written] = 0;
    Ok(written + 2)
}
