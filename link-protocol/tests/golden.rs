//! Promise R12: the bytes of version 1 never change. If a test here fails, do not change the file: the wire broke.
#![allow(missing_docs)]
mod samples;

use link_protocol::{
    Binding, Decoder, SCHEMA_KEY, SCHEMA_NOW, Seal, Signature, encode_body, encode_signed,
};
use std::fmt::Write as _;

const GOLDEN: &str = include_str!("golden/v1.txt");
/// What came since: appended variants, and frames signed with a real key.
const APPENDED: &str = include_str!("golden/v1-appended.txt");

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[test]
fn version_1_is_frozen() {
    let mut now = String::new();
    for (name, message) in samples::frozen() {
        let _ = writeln!(now, "{name}: {}", hex(&samples::frame(&message)));
    }
    let _ = writeln!(now, "schema key: {}", hex(&SCHEMA_KEY));
    let header = link_protocol::Header {
        version: 1,
        session: 0xBEEF,
        sequence: 300,
    };
    let signature = Signature {
        counter: 0x0000_0605_0403_0201,
        tag: [0xA0, 0xA1, 0xA2, 0xA3, 0xA4, 0xA5, 0xA6, 0xA7],
    };
    let mut signed = [0; link_protocol::MAX_ENCODED];
    let len = encode_body(header, 6, &[], Some(signature), &mut signed).unwrap();
    let _ = writeln!(now, "signed keep-alive: {}", hex(&signed[1..len]));
    assert!(
        now == GOLDEN,
        "the bytes of version 1 changed; they are now\n{now}"
    );
}

#[test]
fn what_the_goldens_hold_decodes_to_what_was_meant() {
    let mut lines = GOLDEN.lines();
    for (name, message) in samples::frozen() {
        let (golden_name, digits) = lines.next().unwrap().split_once(": ").unwrap();
        assert_eq!(golden_name, name);
        let mut decoder = Decoder::new();
        let bytes = (0..digits.len())
            .step_by(2)
            .map(|at| u8::from_str_radix(&digits[at..at + 2], 16).unwrap());
        let received: Vec<_> = bytes.filter_map(|byte| decoder.push(byte)).collect();
        assert_eq!(received.len(), 1, "{name}");
        assert_eq!(
            (received[0].header.session, received[0].header.sequence),
            (0xBEEF, 300),
            "{name}"
        );
        assert_eq!(received[0].message, Ok(message), "{name}");
    }
}

/// Lines are appended here, and only the last one changes.
#[test]
fn what_was_appended_is_frozen_too() {
    let mut now = String::new();
    for (name, message) in samples::appended() {
        let _ = writeln!(now, "{name}: {}", hex(&samples::frame(&message)));
    }
    let seal = Seal::new(
        &samples::KEY,
        Binding {
            boot_nonce: 0xCAFE_F00D,
            session: 0xBEEF,
            host_nonce: 0x1234_5678,
        },
    );
    let header = link_protocol::Header {
        version: 1,
        session: 0xBEEF,
        sequence: 300,
    };
    for (name, message) in samples::messages() {
        let mut out = [0; link_protocol::MAX_ENCODED];
        if name.starts_with("request/arm") || name == "keep-alive" || name == "ping" {
            let len = encode_signed(header, &message, &seal, 0x0605_0403_0201, &mut out).unwrap();
            let _ = writeln!(now, "signed {name}: {}", hex(&out[1..len]));
        }
    }
    let _ = writeln!(now, "structure of all messages: {}", hex(&SCHEMA_NOW));
    assert!(
        now == APPENDED,
        "the bytes of what was appended to version 1 changed; they are now\n{now}"
    );
}
