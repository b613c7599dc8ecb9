//! All messages in one enum, and their bodies' decoding: the kind says which type, and every byte must be used.

use crate::{Heartbeat, Hello, HelloReply, Kind, Ping, Pong, Reply, Request, Telemetry};
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
    /// Tells unasked.
    Telemetry(Telemetry),
    /// Version 1's: says nothing but that a host lives. The body is empty.
    KeepAlive,
    /// Asks for the time.
    Ping(Ping),
    /// Tells it.
    Pong(Pong),
    /// Feeds the lease while it is fresh, and asks for the time.
    Heartbeat(Heartbeat),
}

/// Everything whose structure the schema key vouches for.
#[derive(Schema)]
#[allow(dead_code)] // exists for its schema only
pub(crate) struct Schemas {
    hello: Hello,
    hello_reply: HelloReply,
    request: Request,
    reply: Reply,
    telemetry: Telemetry,
    ping: Ping,
    pong: Pong,
    heartbeat: Heartbeat,
}

/// Why the body of a whole frame is no message.
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
            Self::KeepAlive => Kind::KeepAlive,
            Self::Ping(_) => Kind::Ping,
            Self::Pong(_) => Kind::Pong,
            Self::Heartbeat(_) => Kind::Heartbeat,
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
            Self::KeepAlive => Ok(&mut out[..0]),
            Self::Ping(body) => postcard::to_slice(body, out),
            Self::Pong(body) => postcard::to_slice(body, out),
            Self::Heartbeat(body) => postcard::to_slice(body, out),
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
            Kind::KeepAlive if body.is_empty() => Ok(Self::KeepAlive),
            Kind::KeepAlive => Err(BodyError::TrailingBytes(body.len())),
            Kind::Ping => whole(body).map(Self::Ping),
            Kind::Pong => whole(body).map(Self::Pong),
            Kind::Heartbeat => whole(body).map(Self::Heartbeat),
        }
    }
}

/// What every version obeys and reads, whatever the frame's version says: a stop, an e-stop, and the answer to either.
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
