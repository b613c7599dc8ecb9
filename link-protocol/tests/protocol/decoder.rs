//! Decoder on valid and invalid bytes: every split, every counter, garbage before a frame (promises R2 and R3).
use crate::samples;

use link_protocol::*;
use proptest::prelude::*;

fn push_all(decoder: &mut Decoder, bytes: &[u8]) -> Vec<Received> {
    bytes
        .iter()
        .filter_map(|&byte| decoder.push(byte))
        .collect()
}

fn raw_frame(kind: u8, version: u8, body: &[u8]) -> Vec<u8> {
    let mut out = [0; MAX_ENCODED];
    let len = encode_body(
        Header {
            version,
            session: 1,
            sequence: 2,
        },
        kind,
        body,
        None,
        &mut out,
    )
    .unwrap();
    out[..len].to_vec()
}

#[test]
fn every_message_comes_back_and_fits() {
    for (name, message) in samples::messages() {
        let frame = samples::frame(&message);
        assert!(frame.len() < MAX_ENCODED, "{name}");
        let mut decoder = Decoder::new();
        let received = push_all(&mut decoder, &frame);
        assert_eq!(received.len(), 1, "{name}");
        assert_eq!(received[0].message, Ok(message), "{name}");
        assert_eq!(
            (received[0].header.version, received[0].signature),
            (PROTOCOL_CURRENT, None),
            "{name}"
        );
        assert_eq!(
            decoder.counters(),
            DecodeCounters {
                ok: 1,
                ..Default::default()
            },
            "{name}"
        );
    }
}

#[test]
fn kind_and_body_of_the_last_frame_can_be_told() {
    let signature = Some(Signature {
        counter: 1,
        tag: [3; 8],
    });
    for (name, message) in samples::messages() {
        let mut body = [0; MAX_BODY];
        let body = message.encode_body(&mut body).unwrap();
        for signature in [None, signature] {
            let mut frame = [0; MAX_ENCODED];
            let header = Header::new(1, 2);
            let Ok(len) = encode_body(header, message.kind() as u8, body, signature, &mut frame)
            else {
                continue;
            };
            let mut decoder = Decoder::new();
            push_all(&mut decoder, &frame[..len]);
            let told = decoder.kind_and_body();
            assert_eq!(told, Some((message.kind(), &*body)), "{name}");
        }
    }
    let mut decoder = Decoder::new();
    assert_eq!(decoder.kind_and_body(), None);
    // An invalid body is available too, but not one of an unknown kind or too short for its signature.
    push_all(&mut decoder, &raw_frame(4, 1, &[200]));
    assert_eq!(decoder.kind_and_body(), Some((Kind::Reply, &[200][..])));
    push_all(&mut decoder, &raw_frame(10, 1, &[200]));
    assert_eq!(decoder.kind_and_body(), None);
}

#[test]
fn the_start_of_a_greetings_answer_is_read_whatever_follows() {
    for (name, message) in samples::messages() {
        let Message::HelloReply(reply) = message else {
            continue;
        };
        let mut body = [0; MAX_BODY];
        let body = message.encode_body(&mut body).unwrap();
        let start = HelloReplyStart::from(&reply);
        let mut bytes = [0; MAX_BODY];
        let len = postcard::to_slice(&start, &mut bytes).unwrap().len();
        body[len..].fill(0xFF);
        assert_eq!(HelloReplyStart::of_body(body), Some(start), "{name}");
        assert_eq!(HelloReplyStart::of_body(&body[..len - 1]), None, "{name}");
    }
}

#[test]
fn the_largest_messages_fit_with_a_signature_where_they_must() {
    let signature = Some(Signature {
        counter: u64::MAX >> 16,
        tag: [0xFF; 8],
    });
    for (name, message) in samples::messages() {
        let mut body = [0; MAX_BODY];
        let body = message.encode_body(&mut body).unwrap();
        let mut out = [0; MAX_ENCODED];
        let encoded = encode_body(
            Header::new(1, 2),
            message.kind() as u8,
            body,
            signature,
            &mut out,
        );
        if name == "request/chunk, full" {
            assert_eq!(encoded, Err(EncodeError::BodyTooLong));
            continue;
        }
        let received = push_all(&mut Decoder::new(), &out[..encoded.unwrap()]);
        assert_eq!(received[0].signature, signature, "{name}");
        assert_eq!(received[0].message, Ok(message), "{name}");
    }
}

#[test]
fn the_largest_values_of_status_and_counters_fit() {
    let worst = u32::MAX;
    let frames = DecodeCounters {
        ok: worst,
        bad_crc: worst,
        overflow: worst,
        bad_cobs: worst,
        trailing_bytes: worst,
        not_understood: worst,
    };
    let counters = Counters {
        frames,
        acted: worst,
        replayed: worst,
        superseded: worst,
        stale: worst,
        refused: worst,
        dropped: worst,
        late_ticks: worst,
        clamped: worst,
    };
    let status = Status {
        robot_us: u64::MAX,
        state: StateName::Settling,
        cause: StopCause::EStop,
        flags: Flags(u16::MAX),
        cycle: worst,
        cycles: worst,
        period_us: worst,
        phase: u16::MAX,
        setpoint: [i16::MIN; 2],
        battery_mv: Some(u16::MAX),
        table: Some(TableInfo {
            knots: u16::MAX,
            crc32: worst,
            stored: true,
            min_period_us: worst,
        }),
        upload: Some(u16::MAX),
        settings_crc32: u32::MAX,
        estops: u32::MAX,
    };
    let crash = heapless::String::try_from("x".repeat(96).as_str()).unwrap();
    for reply in [
        Reply::Counters(counters),
        Reply::Status(status),
        Reply::CrashMessage(crash),
    ] {
        let mut out = [0; MAX_ENCODED];
        assert!(encode(Header::new(1, 2), &Message::Reply(reply), &mut out).is_ok());
    }
}

#[test]
fn every_split_point_decodes_the_same() {
    for (_, message) in samples::messages() {
        let frame = samples::frame(&message);
        for split in 0..=frame.len() {
            let mut decoder = Decoder::new();
            let mut received = push_all(&mut decoder, &frame[..split]);
            received.extend(push_all(&mut decoder, &frame[split..]));
            assert_eq!(received.len(), 1);
            assert_eq!(received[0].message.as_ref(), Ok(&message));
        }
    }
}

#[test]
fn each_fault_has_its_counter() {
    let good = samples::frame(&Message::Request(Request::Stop));
    let mut decoder = Decoder::new();
    // A flipped bit in the CRC.
    let mut flipped = good.clone();
    flipped[4] ^= 0x10;
    assert!(push_all(&mut decoder, &flipped).is_empty());
    // Too short for a CRC; too short for a header.
    assert!(push_all(&mut decoder, &[2, 7, 0, 6, 1, 2, 3, 4, 5, 0]).is_empty());
    assert_eq!(
        decoder.counters(),
        DecodeCounters {
            bad_crc: 3,
            ..Default::default()
        }
    );
    // A COBS code that points past the end.
    assert!(push_all(&mut decoder, &[9, 1, 2, 0]).is_empty());
    assert_eq!(decoder.counters().bad_cobs, 1);
    // Longer than any frame, then a tail that looks like a frame: both are dropped, the next one is accepted.
    let mut long = vec![1; MAX_RAW + 2];
    long.extend(&good);
    assert!(push_all(&mut decoder, &long).is_empty());
    assert_eq!(decoder.counters().overflow, 1);
    assert_eq!(push_all(&mut decoder, &good).len(), 1);
    // Complete frames without a valid message.
    let expect = |decoder: &mut Decoder, frame: &[u8], error: BodyError| {
        let received = push_all(decoder, frame);
        assert_eq!(received.len(), 1);
        assert_eq!(received[0].message, Err(error));
    };
    expect(
        &mut decoder,
        &raw_frame(7, PROTOCOL_CURRENT, &[0, 0, 0, 9]),
        BodyError::TrailingBytes(1),
    );
    expect(
        &mut decoder,
        &raw_frame(3, PROTOCOL_CURRENT, &[0, 0]),
        BodyError::TrailingBytes(1),
    );
    expect(
        &mut decoder,
        &raw_frame(3, PROTOCOL_CURRENT, &[200]),
        BodyError::Malformed,
    );
    expect(
        &mut decoder,
        &raw_frame(3, PROTOCOL_CURRENT, &[]),
        BodyError::Malformed,
    );
    expect(
        &mut decoder,
        &raw_frame(0, PROTOCOL_CURRENT, &[]),
        BodyError::UnknownKind(0),
    );
    expect(
        &mut decoder,
        &raw_frame(10, PROTOCOL_CURRENT, &[]),
        BodyError::UnknownKind(10),
    );
    expect(&mut decoder, &raw_frame(6, 3, &[]), BodyError::Version(3));
    expect(&mut decoder, &raw_frame(6, 0, &[]), BodyError::Version(0));
    let expected = DecodeCounters {
        ok: 1,
        bad_crc: 3,
        overflow: 1,
        bad_cobs: 1,
        trailing_bytes: 2,
        not_understood: 6,
    };
    assert_eq!(decoder.counters(), expected);
    assert_eq!(decoder.counters().bad(), 13);
}

#[test]
fn a_greeting_is_read_in_any_version() {
    let (_, hello) = samples::messages().remove(0);
    let mut body = [0; MAX_BODY];
    let body = hello.encode_body(&mut body).unwrap();
    for version in [0, 1, 2, 255] {
        let received = push_all(&mut Decoder::new(), &raw_frame(1, version, body));
        assert_eq!(received[0].message.as_ref(), Ok(&hello));
        assert_eq!(received[0].header.version, version);
    }
}

#[test]
fn spare_bits_of_the_frozen_greeting_are_ignored() {
    let (_, reply) = samples::messages().remove(1);
    let mut body = [0; MAX_BODY];
    let body = reply.encode_body(&mut body).unwrap();
    // Nonce 5, versions 2, key 8, firmware 3 + 8, board and reset reason 2; then the flags.
    assert_eq!(body[28], 1);
    body[28] = 0xFF;
    assert_eq!(
        Message::decode_body(1, Kind::HelloReply as u8, body),
        Ok(reply)
    );
}

#[test]
fn a_signed_frame_too_short_for_its_signature_is_no_message() {
    // Built by hand, because the encoder cannot produce such a frame.
    let mut raw = vec![1, 1, 0, 2, 0, 6 | KIND_SIGNED, 9, 9, 9];
    raw.extend(crc32c(&raw).to_le_bytes());
    let mut frame = vec![0; MAX_ENCODED];
    let len = cobs::encode(&raw, &mut frame);
    frame.truncate(len);
    frame.push(0);
    assert_eq!(
        push_all(&mut Decoder::new(), &frame)[0].message,
        Err(BodyError::Malformed)
    );
}

#[test]
fn encoding_needs_room() {
    let mut short = [0; MAX_ENCODED - 1];
    assert_eq!(
        encode(
            Header::new(0, 0),
            &Message::Request(Request::Stop),
            &mut short
        ),
        Err(EncodeError::BufferTooShort)
    );
    let mut out = [0; MAX_ENCODED];
    let most = [0xFF; MAX_BODY + 1];
    assert_eq!(
        encode_body(Header::new(0, 0), 3, &most, None, &mut out),
        Err(EncodeError::BodyTooLong)
    );
    assert_eq!(
        encode_body(Header::new(0, 0), 3, &most[1..], None, &mut out),
        Ok(MAX_ENCODED)
    );
}

#[test]
fn refusals_keep_their_numbers() {
    // The number is also the variant's index on the wire.
    for (name, message) in samples::messages() {
        let Message::Reply(Reply::Refused(refusal)) = message else {
            continue;
        };
        let mut body = [0; MAX_BODY];
        let body = Message::Reply(Reply::Refused(refusal))
            .encode_body(&mut body)
            .unwrap();
        assert_eq!(body[..2], [1, refusal.number()], "{name}");
        assert!(refusal.to_string().len() > 20, "{name}");
    }
}

#[test]
fn flags_are_bits() {
    let flags = Flags::default()
        .with(Flags::DETACHED, true)
        .with(Flags::UNSAVED, false);
    assert!(flags.contains(Flags::DETACHED) && !flags.contains(Flags::UNSAVED));
    assert!(!flags.contains(Flags(Flags::DETACHED.0 | Flags::UNSAVED.0)));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    /// Promise R3.
    #[test]
    fn after_any_garbage_the_next_frame_is_decoded(garbage in prop::collection::vec(any::<u8>(), 0..600), which in 0..60_usize) {
        let messages = samples::messages();
        let message = &messages[which % messages.len()].1;
        let mut decoder = Decoder::new();
        prop_assert!(push_all(&mut decoder, &garbage).is_empty());
        // The burst start terminates the garbage.
        prop_assert!(decoder.push(0).is_none());
        let received = push_all(&mut decoder, &samples::frame(message));
        prop_assert_eq!(received.len(), 1);
        prop_assert_eq!(received[0].message.as_ref(), Ok(message));
    }

    /// Each run of bytes between zeros increments exactly one counter.
    #[test]
    fn everything_is_counted(pieces in prop::collection::vec(prop::collection::vec(1_u8..=255, 1..300), 0..20)) {
        let mut decoder = Decoder::new();
        for piece in &pieces {
            push_all(&mut decoder, piece);
            decoder.push(0);
        }
        let counters = decoder.counters();
        prop_assert_eq!(counters.ok + counters.bad(), u32::try_from(pieces.len()).unwrap());
    }

    #[test]
    fn any_header_and_body_come_back(
        version in any::<u8>(), session in any::<u16>(), sequence in any::<u16>(), kind in 0..KIND_SIGNED,
        body in prop::collection::vec(any::<u8>(), 0..=MAX_BODY)
    ) {
        let mut out = [0; MAX_ENCODED];
        let header = Header { version, session, sequence };
        let len = encode_body(header, kind, &body, None, &mut out).unwrap();
        prop_assert!(out[1..len - 1].iter().all(|&byte| byte != 0));
        let received = push_all(&mut Decoder::new(), &out[..len]);
        prop_assert_eq!(received.len(), 1);
        prop_assert_eq!(received[0].header, header);
        prop_assert_eq!(received[0].message.clone(), Message::decode_body(version, kind, &body));
    }
}
