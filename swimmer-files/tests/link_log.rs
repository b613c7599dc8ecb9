//! The link log: written as MCAP, read back frame by frame, readable without us.

use proptest::prelude::*;
use swimmer_files::{Direction, LinkFrame, LinkLogWriter, read_link_log};

fn frame(index: u64) -> LinkFrame {
    LinkFrame {
        direction: if index.is_multiple_of(2) {
            Direction::ToRobot
        } else {
            Direction::FromRobot
        },
        host_time_ns: 1_000 * index,
        robot_time_us: index.is_multiple_of(3).then_some(index),
        bytes: (0..index)
            .map(|byte| u8::try_from(byte * 37 % 256).unwrap())
            .collect(),
    }
}

#[test]
fn every_frame_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log/link.mcap");
    let frames: Vec<_> = (0..100).map(frame).collect();
    let mut log = LinkLogWriter::create(&path).unwrap();
    for frame in &frames {
        log.write(frame).unwrap();
    }
    assert!(!path.exists(), "the log takes its name when it is whole");
    log.finish().unwrap();
    assert_eq!(read_link_log(&path).unwrap(), frames);
    assert_eq!(
        std::fs::read_dir(path.parent().unwrap()).unwrap().count(),
        1
    );
}

#[test]
fn other_programs_find_schema_topics_and_times() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("link.mcap");
    let mut log = LinkLogWriter::create(&path).unwrap();
    log.write(&frame(3)).unwrap();
    log.finish().unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let message = mcap::MessageStream::new(&bytes)
        .unwrap()
        .next()
        .unwrap()
        .unwrap();
    assert_eq!(message.channel.topic, "/link/from_robot");
    assert_eq!(message.channel.message_encoding, "json");
    let schema = message.channel.schema.as_ref().unwrap();
    assert_eq!(
        (schema.name.as_str(), schema.encoding.as_str()),
        ("swimmer.LinkFrame", "jsonschema")
    );
    assert!(
        serde_json::from_slice::<serde_json::Value>(&schema.data)
            .unwrap()
            .is_object()
    );
    assert_eq!(message.log_time, 3_000);
    let json: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
    assert_eq!(json["raw_hex"], "00254a");
    assert_eq!(json["robot_time_us"], 3);
}

#[test]
fn a_sound_frame_is_decoded_for_people() {
    let mut wire = [0; link_protocol::MAX_ENCODED];
    let header = link_protocol::Header::new(7, 42);
    let len = link_protocol::encode(header, &link_protocol::Message::KeepAlive, &mut wire).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("link.mcap");
    let mut log = LinkLogWriter::create(&path).unwrap();
    for bytes in [&wire[..len], &wire[1..len - 1], &wire[..len - 3]] {
        log.write(&LinkFrame {
            bytes: bytes.to_vec(),
            ..frame(0)
        })
        .unwrap();
    }
    log.finish().unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let decoded: Vec<_> = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(|message| {
            serde_json::from_slice::<serde_json::Value>(&message.unwrap().data).unwrap()["decoded"]
                .clone()
        })
        .collect();
    assert_eq!(decoded[0]["session"], 7);
    assert_eq!(decoded[0]["sequence"], 42);
    assert_eq!(decoded[0]["kind"], "KeepAlive");
    assert_eq!(
        decoded[1], decoded[0],
        "with or without the zeros around it"
    );
    assert!(decoded[2].is_null(), "a cut frame");
}

#[test]
fn an_abandoned_log_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut log = LinkLogWriter::create(&folder.path().join("link.mcap")).unwrap();
    log.write(&frame(3)).unwrap();
    drop(log);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

proptest! {
    #[test]
    fn damaged_logs_are_errors_not_panics(at in 0..2000usize, flip in 1..=255u8, cut in any::<bool>()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("link.mcap");
        let mut log = LinkLogWriter::create(&path).unwrap();
        (0..5).try_for_each(|index| log.write(&frame(index))).unwrap();
        log.finish().unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let at = at % bytes.len();
        if cut { bytes.truncate(at) } else { bytes[at] ^= flip }
        std::fs::write(&path, bytes).unwrap();
        let _ = read_link_log(&path);
    }
}
