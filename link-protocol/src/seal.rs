//! Authentication: frames signed with a shared key (the scheme of `MAVLink` 2: a truncated keyed tag over header, body and a
//! monotonic counter). The tag is `SipHash-2-4`, a keyed hash for short messages. Its key has 128 bits and its tag the 64 bits
//! that fit a frame, and it is small and fast on a chip without a 64-bit multiplier.
//!
//! The tag also covers the parameters of the greeting: the robot's boot nonce, the session's number and the host's nonce. So a
//! frame recorded in another session, or before a restart, does not verify in a later one.

use crate::frame::{Kind, header_bytes};
use crate::{EncodeError, Header, KIND_SIGNED, Message, Signature, encode_body};
use core::hash::Hasher;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use siphasher::sip::SipHasher24;

/// Shared key. Debug output hides it.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Key(pub [u8; Key::LEN]);

impl Key {
    /// Length of a key, bytes.
    pub const LEN: usize = 16;
}

impl core::fmt::Debug for Key {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Key(not shown)")
    }
}

/// Parameters to which a session's signatures are bound: they are invalid in any other session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    /// Boot nonce of [`crate::HelloReply`].
    pub boot_nonce: u32,
    /// Number of the session.
    pub session: u16,
    /// Nonce of [`crate::Hello`].
    pub host_nonce: u32,
}

/// Key bound to a session: signs and verifies its frames.
///
/// ```
/// use link_protocol::{Binding, Decoder, Header, Key, MAX_ENCODED, Message, Request, Seal, encode_signed};
///
/// let binding = Binding { boot_nonce: 1, session: 2, host_nonce: 3 };
/// let seal = Seal::new(&Key([7; Key::LEN]), binding);
/// let mut frame = [0; MAX_ENCODED];
/// let status = Message::Request(Request::Status);
/// let length = encode_signed(Header::new(2, 1), &status, &seal, 10, &mut frame).unwrap();
///
/// let mut decoder = Decoder::new();
/// let received = frame[..length].iter().find_map(|&byte| decoder.push(byte)).unwrap();
/// let signature = received.signature.unwrap();
/// assert!(seal.verifies(decoder.signed_bytes(), &signature));
/// let another = Seal::new(&Key([8; Key::LEN]), binding);
/// assert!(!another.verifies(decoder.signed_bytes(), &signature));
/// ```
#[derive(Clone)]
pub struct Seal {
    keyed: SipHasher24,
}

impl core::fmt::Debug for Seal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Seal(not shown)")
    }
}

impl Seal {
    /// Binds the key to a session.
    pub fn new(key: &Key, binding: Binding) -> Self {
        let mut keyed = SipHasher24::new_with_key(&key.0);
        keyed.write(&binding.boot_nonce.to_le_bytes());
        keyed.write(&binding.session.to_le_bytes());
        keyed.write(&binding.host_nonce.to_le_bytes());
        Self { keyed }
    }

    /// Signature of a frame. `counter` (48 bits) must exceed that of every frame signed before in this session.
    pub fn sign(&self, header: Header, kind: Kind, body: &[u8], counter: u64) -> Signature {
        let mut hasher = self.keyed;
        hasher.write(&header_bytes(header, kind as u8 | KIND_SIGNED));
        hasher.write(body);
        hasher.write(&Signature::counter_bytes(counter));
        Signature {
            counter,
            tag: hasher.finish().to_le_bytes(),
        }
    }

    /// Returns true if a frame was signed with this key for this session. `signed` are its bytes before the tag:
    /// [`crate::Decoder::signed_bytes`].
    pub fn verifies(&self, signed: &[u8], signature: &Signature) -> bool {
        let mut hasher = self.keyed;
        hasher.write(signed);
        // One comparison of 64 bits, in constant time.
        hasher.finish() ^ u64::from_le_bytes(signature.tag) == 0
    }
}

/// Encodes like [`crate::encode`], with a signature.
///
/// # Errors
/// `out` is shorter than [`crate::MAX_ENCODED`], or message and signature exceed a frame.
pub fn encode_signed(
    header: Header,
    message: &Message,
    seal: &Seal,
    counter: u64,
    out: &mut [u8],
) -> Result<usize, EncodeError> {
    let mut body = [0; crate::MAX_BODY];
    let body = message
        .encode_body(&mut body)
        .map_err(|_| EncodeError::BodyTooLong)?;
    let kind = message.kind();
    let signature = seal.sign(header, kind, body, counter);
    encode_body(header, kind as u8, body, Some(signature), out)
}
