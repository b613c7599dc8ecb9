//! Frames, and the faults of a link.

use arbitrary::Arbitrary;
use link_protocol::{
    Header, Heartbeat, Hello, MAX_ENCODED, Message, SCHEMA_KEY, Seal, encode, encode_body,
    encode_signed,
};

/// One message as bytes on the wire.
pub fn frame(header: Header, message: &Message) -> Vec<u8> {
    let mut bytes = [0; MAX_ENCODED];
    let count =
        encode(header, message, &mut bytes).expect("every message of the protocol fits a frame");
    bytes[..count].to_vec()
}

/// One message as bytes on the wire, signed.
pub fn signed(header: Header, message: &Message, seal: &Seal, counter: u64) -> Vec<u8> {
    let mut bytes = [0; MAX_ENCODED];
    let count = encode_signed(header, message, seal, counter, &mut bytes)
        .expect("every story's message leaves room for a signature");
    bytes[..count].to_vec()
}

/// Any body in a frame whose checksum is right; nothing where it is too long.
pub fn sound(header: Header, kind: u8, body: &[u8]) -> Vec<u8> {
    let mut bytes = [0; MAX_ENCODED];
    let count = encode_body(header, kind, body, None, &mut bytes).unwrap_or(0);
    bytes[..count].to_vec()
}

/// A greeting with this nonce.
pub fn hello(host_nonce: u32) -> Message {
    Message::Hello(Hello {
        protocol_min: link_protocol::PROTOCOL_MIN,
        protocol_current: link_protocol::PROTOCOL_CURRENT,
        schema_key: SCHEMA_KEY,
        host_nonce,
    })
}

/// Heartbeat of a host with this time of the last received frame.
pub fn heartbeat(heard_us: u64) -> Message {
    Message::Heartbeat(Heartbeat {
        host_us: 0,
        heard_us,
    })
}

/// Faults of the link.
#[derive(Arbitrary, Debug, Clone, Copy)]
pub enum Weather {
    Fair,
    Lost,
    Flipped { bit: u16 },
    Twice,
    Cut { at: u16 },
    Held,
}

impl Weather {
    /// The part of `bytes` that arrives; held bytes stay in it.
    pub fn pass(self, bytes: &mut Vec<u8>) -> Vec<u8> {
        if let Self::Held = self {
            return Vec::new();
        }
        let mut sent = std::mem::take(bytes);
        if sent.is_empty() {
            return sent;
        }
        match self {
            Self::Fair | Self::Held => {}
            Self::Lost => sent.clear(),
            Self::Flipped { bit } => {
                let place = usize::from(bit) / 8 % sent.len();
                sent[place] ^= 1 << (bit % 8);
            }
            Self::Twice => sent.extend_from_within(..),
            Self::Cut { at } => sent.truncate(usize::from(at) % sent.len()),
        }
        sent
    }
}
