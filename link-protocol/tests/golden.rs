//! Promise R12: the bytes of a version never change, nor those of what is for ever. If a test here fails, do not change the file: the wire broke.
#![allow(missing_docs)]
mod samples;

use link_protocol::{
    Binding, Decoder, Header, KIND_SIGNED, Kind, Message, Reply, Request, SCHEMA_KEY,
    SCHEMA_KEY_V1, SCHEMA_NOW, Seal, Signature, encode, encode_body, encode_signed,
};
use std::fmt::Write as _;

const GOLDEN: &str = include_str!("golden/v1.txt");
/// What came since: appended variants, and frames signed with a real key.
const APPENDED: &str = include_str!("golden/v1-appended.txt");
const GOLDEN_2: &str = include_str!("golden/v2.txt");
/// What came since: appended variants.
const APPENDED_2: &str = include_str!("golden/v2-appended.txt");
/// Greetings, stops and their answer, in frames of any version.
const FOR_EVER: &str = include_str!("golden/for-ever.txt");

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
        let _ = writeln!(now, "{name}: {}", hex(&samples::frame(1, &message)));
    }
    let _ = writeln!(now, "schema key: {}", hex(&SCHEMA_KEY_V1));
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
        let _ = writeln!(now, "{name}: {}", hex(&samples::frame(1, &message)));
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
    for (name, message) in samples::version_1() {
        let mut out = [0; link_protocol::MAX_ENCODED];
        if name.starts_with("request/arm") || name == "keep-alive" || name == "ping" {
            let len = encode_signed(header, &message, &seal, 0x0605_0403_0201, &mut out).unwrap();
            let _ = writeln!(now, "signed {name}: {}", hex(&out[1..len]));
        }
    }
    // The last line is the structure as it was when version 2 began.
    let (appended, _) = APPENDED.trim_end().rsplit_once('\n').unwrap();
    assert!(
        now.trim_end() == appended,
        "the bytes of what was appended to version 1 changed; they are now\n{now}"
    );
}

/// Every message in a frame of version 2, and what the robot signs.
#[test]
fn version_2_is_frozen() {
    let mut now = String::new();
    for (name, message) in samples::version_2_frozen() {
        let _ = writeln!(now, "{name}: {}", hex(&samples::frame(2, &message)));
    }
    let binding = Binding {
        boot_nonce: 0xCAFE_F00D,
        session: 0xBEEF,
        host_nonce: 0x1234_5678,
    };
    let seal = Seal::new(&samples::KEY, binding);
    for (name, message) in samples::version_2_frozen() {
        let mut out = [0; link_protocol::MAX_ENCODED];
        if [
            "heartbeat",
            "pong",
            "telemetry",
            "reply/done",
            "reply/crash message",
        ]
        .contains(&name)
        {
            let header = Header {
                version: 2,
                session: 0xBEEF,
                sequence: 300,
            };
            let len = encode_signed(header, &message, &seal, 0x0605_0403_0201, &mut out).unwrap();
            let _ = writeln!(now, "signed {name}: {}", hex(&out[1..len]));
        }
    }
    let _ = writeln!(now, "schema key: {}", hex(&SCHEMA_KEY));
    // The last line is the structure as it was when this was frozen.
    let (frozen, _) = GOLDEN_2.trim_end().rsplit_once('\n').unwrap();
    assert!(
        now.trim_end() == frozen,
        "the bytes of version 2 changed; they are now\n{now}"
    );
}

/// Lines are appended here, and only the last one changes.
#[test]
fn what_was_appended_to_version_2_is_frozen_too() {
    let mut now = String::new();
    for (name, message) in samples::version_2_appended() {
        let _ = writeln!(now, "{name}: {}", hex(&samples::frame(2, &message)));
    }
    let _ = writeln!(now, "structure of all messages: {}", hex(&SCHEMA_NOW));
    assert!(
        now == APPENDED_2,
        "the bytes of what was appended to version 2 changed; they are now\n{now}"
    );
}

/// In frames of every version: what every robot obeys, and every host reads.
#[test]
fn greetings_and_stops_are_for_ever() {
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
            let mut out = [0; link_protocol::MAX_ENCODED];
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
            if [0, 1, 2, 3, 255].contains(&version) {
                let _ = writeln!(now, "{name}, version {version}: {}", hex(&out[1..len]));
            }
        }
    }
    assert!(
        now == FOR_EVER,
        "what is for ever changed; it is now\n{now}"
    );
}

/// Nothing else of another version is read: not even what these would be.
#[test]
fn of_other_versions_nothing_but_that_is_a_message() {
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
        for version in [0, 3, 255] {
            let read = Message::decode_body(version, kind, body);
            assert_eq!(read.is_ok(), frozen(&message), "{name}, version {version}");
        }
    }
    // A byte more is no stop.
    let longer = Message::decode_body(3, Kind::Request as u8, &[14, 0]);
    assert!(longer.is_err());
    assert!(Kind::from_byte(KIND_SIGNED).is_none());
}
