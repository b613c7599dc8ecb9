//! Redaction of keys in frames: logs and traces contain zeros instead.

use crate::{HEADER, KIND_SIGNED, Key, Kind, MAX_RAW, TRAILER, crc32c};

/// Variant of [`crate::Request::SetKey`] on the wire, followed by the variant of `Some`.
const SET_KEY: [u8; 2] = [19, 1];
/// Length of the COBS encoding of the longest frame: one byte more.
const MAX_COBS: usize = MAX_RAW + 1;

/// Replaces the key in every frame that carries one ([`crate::Request::SetKey`]) by zeros, in place. `wire` holds frames as on
/// the wire, with or without delimiters. A correct CRC is corrected; a signature no longer verifies. Returns true if a key was
/// replaced.
///
/// ```
/// use link_protocol::{Decoder, Header, Key, MAX_ENCODED, Message, Request, encode, redact_keys};
///
/// let secret = Message::Request(Request::SetKey(Some(Key([7; Key::LEN]))));
/// let mut frame = [0; MAX_ENCODED];
/// let length = encode(Header::new(1, 2), &secret, &mut frame).unwrap();
/// assert!(redact_keys(&mut frame[..length]));
///
/// let mut decoder = Decoder::new();
/// let received = frame[..length].iter().find_map(|&byte| decoder.push(byte)).unwrap();
/// let zeros = Request::SetKey(Some(Key([0; Key::LEN])));
/// assert_eq!(received.message, Ok(Message::Request(zeros)));
/// ```
pub fn redact_keys(wire: &mut [u8]) -> bool {
    let frames = wire.split_mut(|&byte| byte == 0);
    frames.fold(false, |any, frame| redact(frame) | any)
}

/// Redacts one frame between its zeros. Its length stays, because COBS adds one byte to any frame.
fn redact(frame: &mut [u8]) -> bool {
    let mut raw = [0; MAX_COBS];
    let Some(raw) = raw.get_mut(..frame.len()) else {
        return false;
    };
    raw.copy_from_slice(frame);
    let Ok(length) = cobs::decode_in_place(raw) else {
        return false;
    };
    let Some((covered, crc)) = raw[..length].split_last_chunk_mut::<TRAILER>() else {
        return false;
    };
    let sound = crc32c(covered) == u32::from_le_bytes(*crc);
    let Some((header, body)) = covered.split_first_chunk_mut::<HEADER>() else {
        return false;
    };
    let is_request = header[HEADER - 1] & !KIND_SIGNED == Kind::Request as u8;
    if !is_request || !body.starts_with(&SET_KEY) {
        return false;
    }
    body.iter_mut()
        .skip(SET_KEY.len())
        .take(Key::LEN)
        .for_each(|byte| *byte = 0);
    if sound {
        *crc = crc32c(covered).to_le_bytes();
    }
    let mut encoded = [0; MAX_COBS + 1];
    match cobs::try_encode(&raw[..length], &mut encoded) {
        Ok(written) if written == frame.len() => frame.copy_from_slice(&encoded[..written]),
        _ => frame.fill(1), // invalid frame, without a key
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Binding, Decoder, Header, MAX_ENCODED, Message, Received, Request, Seal, encode,
        encode_signed,
    };

    const KEY: Key = Key(*b"sixteen letters!");

    fn received(frame: &[u8]) -> Option<Received> {
        let mut decoder = Decoder::new();
        frame.iter().find_map(|&byte| decoder.push(byte))
    }

    fn holds_key(bytes: &[u8]) -> bool {
        bytes.windows(4).any(|window| KEY.0[..4] == *window)
    }

    #[test]
    fn a_key_becomes_zeros_and_nothing_else_changes() {
        let message = Message::Request(Request::SetKey(Some(KEY)));
        let zeros = Message::Request(Request::SetKey(Some(Key([0; Key::LEN]))));
        let header = Header::new(0x0102, 3);
        let binding = Binding {
            boot_nonce: 1,
            session: 2,
            host_nonce: 3,
        };
        let mut frame = [0; MAX_ENCODED];
        for signed in [false, true] {
            let length = if signed {
                let seal = Seal::new(&KEY, binding);
                encode_signed(header, &message, &seal, 9, &mut frame)
            } else {
                encode(header, &message, &mut frame)
            };
            let frame = &mut frame[..length.unwrap()];
            let before = received(frame).unwrap();
            // With and without delimiters, and among other frames.
            let others = [&[1, 1, 0][..], frame, frame, &[0, 5, 2, 3][..]].concat();
            for wire in [&frame[1..length.unwrap() - 1], frame, &others] {
                let mut wire = wire.to_vec();
                assert!(holds_key(&wire) && redact_keys(&mut wire) && !holds_key(&wire));
            }
            assert!(redact_keys(frame));
            let after = received(frame).unwrap();
            assert_eq!((after.header, &after.message), (header, &Ok(zeros.clone())));
            assert_eq!(after.signature, before.signature);
        }
    }

    #[test]
    fn a_damaged_frame_keeps_no_key_and_stays_damaged() {
        let message = Message::Request(Request::SetKey(Some(KEY)));
        let mut frame = [0; MAX_ENCODED];
        let length = encode(Header::new(1, 2), &message, &mut frame).unwrap();
        let frame = &mut frame[..length];
        frame[length - 2] ^= 0x10;
        assert!(redact_keys(frame) && !holds_key(frame) && received(frame).is_none());
    }

    #[test]
    fn frames_without_a_key_stay_as_they_are() {
        for request in [Request::SetKey(None), Request::Status, Request::Stop] {
            let mut frame = [0; MAX_ENCODED];
            let length = encode(Header::new(1, 2), &Message::Request(request), &mut frame).unwrap();
            let before = frame;
            assert!(!redact_keys(&mut frame[..length]));
            assert_eq!(frame, before);
        }
        for noise in [&[][..], &[0, 0], &[255; 300], &[3, 1]] {
            let mut wire = noise.to_vec();
            assert!(!redact_keys(&mut wire));
            assert_eq!(wire, noise);
        }
    }
}
