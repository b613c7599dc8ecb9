//! Signed frames: accepted and rejected signatures.
use crate::samples;

use link_protocol::*;
use samples::KEY;

const BINDING: Binding = Binding {
    boot_nonce: 0xCAFE_F00D,
    session: 7,
    host_nonce: 42,
};

fn received(decoder: &mut Decoder, frame: &[u8]) -> Received {
    let mut received = frame.iter().filter_map(|&byte| decoder.push(byte));
    received.next().unwrap()
}

fn verifies(seal: &Seal, frame: &[u8]) -> bool {
    let mut decoder = Decoder::new();
    let signature = received(&mut decoder, frame).signature;
    signature.is_some_and(|signature| seal.verifies(decoder.signed_bytes(), &signature))
}

fn signed(message: &Message, seal: &Seal, counter: u64) -> Vec<u8> {
    let mut out = [0; MAX_ENCODED];
    let len = encode_signed(Header::new(7, 300), message, seal, counter, &mut out).unwrap();
    out[..len].to_vec()
}

/// Test vector of the authors of `SipHash`: key 00 … 0f, input 00 … 0e, of which the first ten bytes are the binding here.
#[test]
fn the_tag_is_siphash_2_4() {
    let key = Key([0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]);
    let binding = Binding {
        boot_nonce: 0x0302_0100,
        session: 0x0504,
        host_nonce: 0x0908_0706,
    };
    let signature = Signature {
        counter: 0,
        tag: 0xa129_ca61_49be_45e5_u64.to_le_bytes(),
    };
    let seal = Seal::new(&key, binding);
    assert!(seal.verifies(&[10, 11, 12, 13, 14], &signature));
    assert!(!seal.verifies(&[10, 11, 12, 13, 15], &signature));
}

#[test]
fn only_the_same_key_in_the_same_session_verifies() {
    let seal = Seal::new(&KEY, BINDING);
    let mut other_key = KEY;
    other_key.0[15] ^= 1;
    let others = [
        Seal::new(&other_key, BINDING),
        Seal::new(
            &KEY,
            Binding {
                boot_nonce: 0,
                ..BINDING
            },
        ),
        Seal::new(
            &KEY,
            Binding {
                session: 8,
                ..BINDING
            },
        ),
        Seal::new(
            &KEY,
            Binding {
                host_nonce: 43,
                ..BINDING
            },
        ),
    ];
    for (name, message) in samples::messages() {
        if name == "request/chunk, full" {
            continue;
        }
        let frame = signed(&message, &seal, 9);
        assert!(verifies(&seal, &frame), "{name}");
        assert!(
            others.iter().all(|other| !verifies(other, &frame)),
            "{name}"
        );
        assert!(!verifies(&seal, &samples::frame(&message)), "{name}");
    }
}

/// An adversary can correct the CRC, so the tag must cover every bit of header, body, counter and itself.
#[test]
fn every_flipped_bit_under_a_mended_crc_is_noticed() {
    let seal = Seal::new(&KEY, BINDING);
    let mut tried = 0;
    for (name, message) in samples::messages() {
        if name == "request/chunk, full" {
            continue;
        }
        let frame = signed(&message, &seal, 0x0605_0403_0201);
        let mut raw = [0; MAX_ENCODED];
        let len = cobs::decode(&frame[1..frame.len() - 1], &mut raw).unwrap();
        for bit in 0..8 * (len - TRAILER) {
            let mut broken = raw[..len].to_vec();
            broken[bit / 8] ^= 1 << (bit % 8);
            let crc = crc32c(&broken[..len - TRAILER]);
            broken[len - TRAILER..].copy_from_slice(&crc.to_le_bytes());
            let mut frame = [0; MAX_ENCODED];
            let len = cobs::encode(&broken, &mut frame);
            frame[len] = 0;
            assert!(!verifies(&seal, &frame[..=len]), "{name}, bit {bit}");
            tried += 1;
        }
    }
    println!("{tried} signed frames with one bit flipped under a mended CRC: none verified");
}

#[test]
fn a_key_is_not_shown() {
    let shown = format!("{:?}", Request::SetKey(Some(KEY)));
    assert_eq!(shown, "SetKey(Some(Key(not shown)))");
    // The derived hash state is hidden too, because it is equivalent to the key.
    let shown = format!("{:?}", Seal::new(&KEY, BINDING));
    assert_eq!(shown, "Seal(not shown)");
}

#[test]
fn the_longest_signed_chunk_fills_a_frame() {
    let chunk = |len| {
        let data = heapless::Vec::from_slice(&[0xA5; MAX_CHUNK][..len]).unwrap();
        Message::Request(Request::Chunk(Chunk {
            upload: u16::MAX,
            offset: u16::MAX,
            data,
        }))
    };
    let seal = Seal::new(&KEY, BINDING);
    let mut out = [0; MAX_ENCODED];
    let header = Header::new(7, 300);
    let mut fits = |len| encode_signed(header, &chunk(len), &seal, 1, &mut out).is_ok();
    assert!(fits(MAX_SIGNED_CHUNK) && !fits(MAX_CHUNK));
}
