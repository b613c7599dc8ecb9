//! All messages in one enum, and their bodies' decoding: the kind says which type, and every byte must be used.

use crate::{Heartbeat, Hello, HelloReply, Kind, Pong, Reply, Request, Telemetry};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A message of any kind.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // no heap to box it
pub enum Message {
    /// Opens a session.
    Hello(Hello),
    /// Answers it.
    HelloReply(HelloReply),
    /// Asks for something.
    Request(Request),
    /// Answers it.
    Reply(Reply),
    /// Sent by the robot without a request.
    Telemetry(Telemetry),
    /// Keep-alive: renews the lease while it is fresh, and requests the time.
    Heartbeat(Heartbeat),
    /// Answers it with the time.
    Pong(Pong),
}

/// All types whose structure enters the schema key.
#[derive(Schema)]
#[allow(dead_code)] // exists for its schema only
pub(crate) struct Schemas {
    hello: Hello,
    hello_reply: HelloReply,
    request: Request,
    reply: Reply,
    telemetry: Telemetry,
    heartbeat: Heartbeat,
    pong: Pong,
}

/// Reasons for which the body of a whole frame is not a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyError {
    /// The frame's version is outside [`crate::PROTOCOL_MIN`]`..=`[`crate::PROTOCOL_CURRENT`], and it is neither a greeting nor a
    /// stop nor the answer to one.
    Version(u8),
    /// No message has this kind.
    UnknownKind(u8),
    /// The body does not decode.
    Malformed,
    /// The body decodes and this many bytes are left over.
    TrailingBytes(usize),
}

impl Message {
    /// The kind byte of this message.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Hello(_) => Kind::Hello,
            Self::HelloReply(_) => Kind::HelloReply,
            Self::Request(_) => Kind::Request,
            Self::Reply(_) => Kind::Reply,
            Self::Telemetry(_) => Kind::Telemetry,
            Self::Heartbeat(_) => Kind::Heartbeat,
            Self::Pong(_) => Kind::Pong,
        }
    }

    /// Encodes the body into `out`.
    ///
    /// # Errors
    /// The body does not fit.
    pub fn encode_body<'a>(&self, out: &'a mut [u8]) -> Result<&'a mut [u8], postcard::Error> {
        match self {
            Self::Hello(body) => postcard::to_slice(body, out),
            Self::HelloReply(body) => postcard::to_slice(body, out),
            Self::Request(body) => postcard::to_slice(body, out),
            Self::Reply(body) => postcard::to_slice(body, out),
            Self::Telemetry(body) => postcard::to_slice(body, out),
            Self::Heartbeat(body) => postcard::to_slice(body, out),
            Self::Pong(body) => postcard::to_slice(body, out),
        }
    }

    /// Decodes the body of a frame whose CRC was right.
    ///
    /// # Errors
    /// See [`BodyError`].
    pub fn decode_body(version: u8, kind: u8, body: &[u8]) -> Result<Self, BodyError> {
        let kind = Kind::from_byte(kind).ok_or(BodyError::UnknownKind(kind))?;
        if let Some(frozen) = frozen(kind, body) {
            return Ok(frozen);
        }
        let understood = (crate::PROTOCOL_MIN..=crate::PROTOCOL_CURRENT).contains(&version);
        if !understood && !matches!(kind, Kind::Hello | Kind::HelloReply) {
            return Err(BodyError::Version(version));
        }
        match kind {
            Kind::Hello => whole(body).map(Self::Hello),
            Kind::HelloReply => whole(body).map(Self::HelloReply),
            Kind::Request => whole(body).map(Self::Request),
            Kind::Reply => whole(body).map(Self::Reply),
            Kind::Telemetry => whole(body).map(Self::Telemetry),
            Kind::Heartbeat => whole(body).map(Self::Heartbeat),
            Kind::Pong => whole(body).map(Self::Pong),
        }
    }
}

/// Messages that every version reads, whatever the version byte: a stop, an e-stop, and the answer to either.
/// Their bodies are one byte each, frozen like the greeting.
fn frozen(kind: Kind, body: &[u8]) -> Option<Message> {
    match (kind, body) {
        (Kind::Request, [14]) => Some(Message::Request(Request::Stop)),
        (Kind::Request, [15]) => Some(Message::Request(Request::EStop)),
        (Kind::Reply, [0]) => Some(Message::Reply(Reply::Done)),
        _ => None,
    }
}

fn whole<'a, T: Deserialize<'a> + Serialize>(body: &'a [u8]) -> Result<T, BodyError> {
    match postcard::take_from_bytes::<T>(body) {
        Ok((message, [])) => Ok(message),
        Ok((_, rest)) => Err(BodyError::TrailingBytes(rest.len())),
        Err(_) => Err(BodyError::Malformed),
    }
}
