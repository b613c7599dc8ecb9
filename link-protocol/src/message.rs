//! All messages in one enum, and the decoder of bodies: the kind selects the type, and every byte must be consumed.

use crate::{Heartbeat, Hello, HelloReply, Kind, Pong, Reply, Request, Telemetry};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A message of any kind.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // no heap to box it
pub enum Message {
    /// Opens a session.
    Hello(Hello),
    /// Reply to the greeting.
    HelloReply(HelloReply),
    /// Request of the host.
    Request(Request),
    /// Reply to a request.
    Reply(Reply),
    /// Sent by the robot without a request.
    Telemetry(Telemetry),
    /// Keep-alive: renews the lease if it is fresh, and requests the robot's time.
    Heartbeat(Heartbeat),
    /// Reply to a keep-alive, with the robot's time.
    Pong(Pong),
}

/// All types that determine the schema key.
#[derive(Schema)]
#[allow(dead_code)] // only its schema is used
pub(crate) struct Schemas {
    hello: Hello,
    hello_reply: HelloReply,
    request: Request,
    reply: Reply,
    telemetry: Telemetry,
    heartbeat: Heartbeat,
    pong: Pong,
}

/// Reason why the body of a complete frame is not a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyError {
    /// The frame's version is outside [`crate::PROTOCOL_MIN`]`..=`[`crate::PROTOCOL_CURRENT`], and it is neither a greeting nor
    /// a stop nor a reply to one.
    Version(u8),
    /// The kind is unknown.
    UnknownKind(u8),
    /// The body does not decode.
    Malformed,
    /// The body decodes, but this many bytes follow.
    TrailingBytes(usize),
}

impl Message {
    /// Kind byte of this message.
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
    /// The buffer is too short.
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

    /// Decodes the body of a frame with a correct CRC.
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

/// Messages that every version reads: a stop, an e-stop, and the reply to either. Their bodies are one byte each, frozen like
/// the greeting.
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
