//! Promise R12: the bytes of a version never change, nor those of the messages common to all versions. If a test here fails, do
//! not change the file: the wire format broke.
use crate::samples;

use link_protocol::{
    Binding, Decoder, Header, KIND_SIGNED, Kind, MAX_ENCODED, Message, PROTOCOL_CURRENT, Reply,
    Request, SCHEMA_KEY, SCHEMA_NOW, Seal, encode, encode_signed,
};
use std::fmt::Write as _;

/// Version 1.0. Lines are appended with variants; then only the last line, the structure of all messages, changes.
const GOLDEN: &str = include_str!("../golden/v1.txt");
/// Greetings, stops and their replies, in frames of any version.
const EVERY_VERSION: &str = include_str!("../golden/every-version.txt");

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[test]
fn version_1_is_frozen() {
    let mut now = String::new();
    for (name, message) in samples::messages() {
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
    let header = Header::new(0xBEEF, 300);
    for (name, message) in samples::messages() {
        let mut out = [0; MAX_ENCODED];
        if [
            "heartbeat",
            "pong",
            "telemetry",
            "request/arm",
            "request/play",
            "reply/done",
        ]
        .contains(&name)
        {
            let len = encode_signed(header, &message, &seal, 0x0605_0403_0201, &mut out).unwrap();
            let _ = writeln!(now, "signed {name}: {}", hex(&out[1..len]));
        }
    }
    let _ = writeln!(now, "schema key: {}", hex(&SCHEMA_KEY));
    let _ = writeln!(now, "structure of all messages: {}", hex(&SCHEMA_NOW));
    assert!(
        now == GOLDEN,
        "the bytes of version 1 changed; they are now\n{now}"
    );
}

#[test]
fn the_golden_bytes_decode_to_the_messages() {
    let mut lines = GOLDEN.lines();
    for (name, message) in samples::messages() {
        let (golden_name, digits) = lines.next().unwrap().split_once(": ").unwrap();
        assert_eq!(golden_name, name);
        let mut decoder = Decoder::new();
        let bytes = (0..digits.len())
            .step_by(2)
            .map(|at| u8::from_str_radix(&digits[at..at + 2], 16).unwrap());
        let received: Vec<_> = bytes.filter_map(|byte| decoder.push(byte)).collect();
        assert_eq!(received.len(), 1, "{name}");
        assert_eq!(received[0].header, Header::new(0xBEEF, 300), "{name}");
        assert_eq!(received[0].message, Ok(message), "{name}");
    }
}

/// Builds before the first release used the bytes 1 and 2.
#[test]
fn the_version_byte_is_new() {
    assert_eq!(PROTOCOL_CURRENT, 0x10);
}

/// Messages that every robot and every host reads, in frames of every version.
#[test]
fn greetings_and_stops_are_the_same_in_every_version() {
    let frozen = samples::messages().into_iter().filter(|(name, _)| {
        [
            "hello",
            "hello reply",
            "request/stop",
            "request/estop",
            "reply/done",
        ]
        .contains(name)
    });
    let mut now = String::new();
    for (name, message) in frozen {
        for version in 0..=u8::MAX {
            let header = Header {
                version,
                session: 0xBEEF,
                sequence: 300,
            };
            let mut out = [0; MAX_ENCODED];
            let len = encode(header, &message, &mut out).unwrap();
            let mut decoder = Decoder::new();
            let received: Vec<_> = out[..len]
                .iter()
                .filter_map(|&byte| decoder.push(byte))
                .collect();
            assert_eq!(
                received[0].message,
                Ok(message.clone()),
                "{name}, version {version}"
            );
            if [0, 1, 0x10, 0x11, 255].contains(&version) {
                let _ = writeln!(now, "{name}, version {version}: {}", hex(&out[1..len]));
            }
        }
    }
    assert!(
        now == EVERY_VERSION,
        "messages of every version changed; they are now\n{now}"
    );
}

/// No other message of another version is accepted, including those of builds before version 1.0.
#[test]
fn other_versions_have_no_other_messages() {
    let frozen = |message: &Message| {
        matches!(
            message,
            Message::Hello(_)
                | Message::HelloReply(_)
                | Message::Request(Request::Stop | Request::EStop)
                | Message::Reply(Reply::Done)
        )
    };
    for (name, message) in samples::messages() {
        let mut body = [0; link_protocol::MAX_BODY];
        let body = message.encode_body(&mut body).unwrap();
        let kind = message.kind() as u8;
        for version in (0..=u8::MAX).filter(|&version| version != PROTOCOL_CURRENT) {
            let read = Message::decode_body(version, kind, body);
            assert_eq!(read.is_ok(), frozen(&message), "{name}, version {version}");
        }
    }
    // With an extra byte it is no stop.
    let longer = Message::decode_body(3, Kind::Request as u8, &[14, 0]);
    assert!(longer.is_err());
    assert!(Kind::from_byte(KIND_SIGNED).is_none());
}
