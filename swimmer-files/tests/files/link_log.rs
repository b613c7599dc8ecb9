//! The link log: written as MCAP, read back frame by frame, readable without us.

use link_protocol::Direction;
use proptest::prelude::*;
use swimmer_files::{LinkFrame, LinkLogWriter, link_log_bytes, parse_link_log, read_link_log};

fn frame(index: u64) -> LinkFrame {
    LinkFrame {
        direction: if index.is_multiple_of(2) {
            Direction::ToRobot
        } else {
            Direction::ToHost
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
    assert!(path.exists(), "the log grows under its own name");
    log.finish().unwrap();
    assert_eq!(read_link_log(&path).unwrap().frames, frames);
    let in_memory = link_log_bytes(&frames).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), in_memory);
    assert_eq!(
        std::fs::read_dir(path.parent().unwrap()).unwrap().count(),
        1
    );
}

/// The container's reader reports a damaged record with colours, frames and its own source.
#[test]
fn a_damaged_log_is_told_of_in_one_plain_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("link.mcap");
    let mut log = LinkLogWriter::create(&path).unwrap();
    log.write(&frame(3)).unwrap();
    log.finish().unwrap();
    let good = std::fs::read(&path).unwrap();
    let mut told = std::collections::BTreeSet::new();
    for at in 0..good.len().min(300) {
        let mut damaged = good.clone();
        damaged[at] ^= 0x80;
        std::fs::write(&path, &damaged).unwrap();
        let Err(error) = read_link_log(&path) else {
            continue;
        };
        let mut cause: Option<&dyn std::error::Error> = Some(&error);
        while let Some(one) = cause {
            let text = one.to_string();
            assert!(
                !text.contains(char::is_control) && !text.contains('\u{2501}'),
                "byte {at}: {text:?}"
            );
            cause = one.source();
        }
        let text = error.to_string();
        told.insert(text.rsplit_once("link.mcap").unwrap().1.to_owned());
    }
    assert!(
        told.iter().all(|text| text.len() > ": x".len()),
        "{told:#?}"
    );
}

#[cfg(unix)]
#[test]
fn a_symbolic_link_to_a_log_stays() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("latest.mcap");
    std::os::unix::fs::symlink("today.mcap", &link).unwrap();
    LinkLogWriter::create(&link).unwrap().finish().unwrap();
    assert!(link.is_symlink());
    assert_eq!(
        read_link_log(&folder.path().join("today.mcap"))
            .unwrap()
            .frames,
        []
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
    let message = link_protocol::Message::Request(link_protocol::Request::Stop);
    let len = link_protocol::encode(header, &message, &mut wire).unwrap();
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
    assert_eq!(decoded[0]["kind"], "Request");
    assert_eq!(
        decoded[1], decoded[0],
        "with or without the zeros around it"
    );
    assert!(decoded[2].is_null(), "a cut frame");
}

/// Telemetry is there twice: as the frame that it was, and in SI units to be plotted.
#[test]
fn telemetry_has_a_topic_of_its_own() {
    let telemetry = link_protocol::Telemetry {
        robot_us: 2_500_000,
        state: link_protocol::StateName::Playing,
        cause: link_protocol::StopCause::Boot,
        flags: link_protocol::Flags::DETACHED,
        cycle: 3,
        cycles: 10,
        phase: 16_384,
        setpoint: [10_000, -2_500],
        pulse_ns: [1_536_000, 0],
        battery_mv: None,
        pose: link_protocol::Pose {
            x: 0.5,
            y: -0.25,
            theta: 0.125,
        },
        frames_ok: 7,
        frames_bad: 1,
    };
    let mut wire = [0; link_protocol::MAX_ENCODED];
    let message = link_protocol::Message::Telemetry(telemetry);
    let len = link_protocol::encode(link_protocol::Header::new(7, 1), &message, &mut wire).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("link.mcap");
    let mut log = LinkLogWriter::create(&path).unwrap();
    let frame = LinkFrame {
        bytes: wire[..len].to_vec(),
        ..frame(1)
    };
    log.write(&frame).unwrap();
    log.finish().unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let told: Vec<(String, serde_json::Value)> = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(|message| {
            let message = message.unwrap();
            let json = serde_json::from_slice(&message.data).unwrap();
            (message.channel.topic.clone(), json)
        })
        .collect();
    let [(_, link), (topic, plotted)] = told.as_slice() else {
        panic!("{told:?}");
    };
    assert_eq!(link["decoded"]["kind"], "Telemetry");
    assert_eq!(topic, "/robot/telemetry");
    assert_eq!(plotted["state"], "Playing");
    for (key, value) in [
        ("robot_time_s", 2.5),
        ("phase", 0.25),
        ("phi1_rad", 1.0),
        ("phi2_rad", -0.25),
        ("pulse1_us", 1536.0),
        ("x_m", 0.5),
        ("theta_rad", 0.125),
    ] {
        let told = plotted[key].as_f64().unwrap();
        assert!((told - value).abs() < 1e-9, "{key}: {told}");
    }
    assert!(plotted.get("battery_v").is_none(), "not measured");
    assert_eq!(read_link_log(&path).unwrap().frames, [frame]);
}

/// Foxglove takes a field of one plain type, an object with properties or an array of one such type, and refuses the whole
/// topic else.
#[test]
fn the_schemas_are_such_as_foxglove_reads() {
    fn check(schema: &serde_json::Value, place: &str) {
        match schema["type"].as_str() {
            Some("boolean" | "string" | "number" | "integer") => {}
            Some("object") => {
                for (name, field) in schema["properties"].as_object().unwrap() {
                    check(field, &format!("{place}.{name}"));
                }
            }
            Some("array") => check(&schema["items"], place),
            other => panic!("{place} has the type {other:?}"),
        }
        assert!(schema.get("oneOf").is_none(), "{place}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("link.mcap");
    LinkLogWriter::create(&path).unwrap().finish().unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.channels.len(), 4);
    for channel in summary.channels.values() {
        let schema = channel.schema.as_ref().unwrap();
        let json = serde_json::from_slice(&schema.data).unwrap();
        check(&json, &schema.name);
    }
}

/// Logs from before this field was left out where nothing is known.
#[test]
fn a_null_robot_time_is_read_as_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.mcap");
    let mut writer = mcap::Writer::new(std::fs::File::create(&path).unwrap()).unwrap();
    let channel = writer
        .add_channel(
            0,
            "/link/to_robot",
            "json",
            &std::collections::BTreeMap::new(),
        )
        .unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: channel,
        sequence: 0,
        log_time: 5,
        publish_time: 5,
    };
    let json = br#"{"host_time_ns":5,"robot_time_us":null,"raw_hex":"0102","decoded":null}"#;
    writer.write_to_known_channel(&header, json).unwrap();
    writer.finish().unwrap();
    let frames = read_link_log(&path).unwrap().frames;
    assert_eq!(
        (frames[0].robot_time_us, frames[0].bytes.as_slice()),
        (None, &[1, 2][..])
    );
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

fn sound_frames(count: u64) -> Vec<LinkFrame> {
    (0..count)
        .map(|at| LinkFrame {
            host_time_ns: at * 50_000_000,
            ..frame(at)
        })
        .collect()
}

/// A log that is never closed, as after `kill -9`, contains all but the last two seconds.
#[test]
fn a_log_grows_and_needs_no_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("link.mcap");
    let frames = sound_frames(115);
    let mut log = LinkLogWriter::create(&path).unwrap();
    for frame in &frames {
        log.write(frame).unwrap();
    }
    let copy = folder.path().join("copy.mcap");
    std::fs::copy(&path, &copy).unwrap();
    let cut = read_link_log(&copy).unwrap();
    // Two seconds hold 40 frames.
    assert!(
        !cut.ended && cut.frames.len() + 40 >= frames.len(),
        "{}",
        cut.frames.len()
    );
    assert_eq!(cut.frames, frames[..cut.frames.len()]);
    log.finish().unwrap();
    let whole = read_link_log(&path).unwrap();
    assert!(whole.ended && whole.frames == frames);
    // Cut off anywhere, as where the disk was full: what was whole is read.
    let bytes = std::fs::read(&path).unwrap();
    let mut most = 0;
    for end in (8..bytes.len()).step_by(97).chain([bytes.len()]) {
        std::fs::write(&copy, &bytes[..end]).unwrap();
        let cut = read_link_log(&copy).unwrap_or_else(|error| panic!("{end}: {error}"));
        assert_eq!(cut.frames, frames[..cut.frames.len()], "{end}");
        assert!(cut.frames.len() >= most, "{end}");
        most = cut.frames.len();
    }
    assert_eq!(most, frames.len());
}

#[test]
fn without_a_frame_nothing_changes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("link.mcap");
    drop(LinkLogWriter::create(&path).unwrap());
    assert!(!path.exists());
    std::fs::write(&path, "an old log").unwrap();
    drop(LinkLogWriter::create(&path).unwrap());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "an old log");
    let mut log = LinkLogWriter::create(&path).unwrap();
    log.write(&frame(1)).unwrap();
    log.finish().unwrap();
    assert_eq!(read_link_log(&path).unwrap().frames.len(), 1);
}

/// The same frames, in chunks of this compression, as another program writes them.
fn foreign_log(frames: &[LinkFrame], compression: Option<mcap::Compression>) -> Vec<u8> {
    let plain = link_log_bytes(frames).unwrap();
    let mut writer = mcap::WriteOptions::new()
        .compression(compression)
        .create(std::io::Cursor::new(Vec::new()))
        .unwrap();
    for message in mcap::MessageStream::new(&plain).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

#[test]
fn compressed_logs_hold_the_same_frames() {
    let frames = sound_frames(200);
    let plain = foreign_log(&frames, None);
    let compressed = foreign_log(&frames, Some(mcap::Compression::Zstd));
    assert!(2 * compressed.len() < plain.len(), "{}", compressed.len());
    for bytes in [plain, compressed] {
        let log = parse_link_log(&bytes, "link.mcap".as_ref()).unwrap();
        assert!(log.ended && log.frames == frames);
    }
}

/// Where the chunk of a compressed log names its compression.
fn compression_name(bytes: &[u8]) -> usize {
    let at = bytes
        .windows(8)
        .position(|window| window == b"\x04\0\0\0zstd");
    at.unwrap() + 4
}

#[test]
fn another_compression_is_refused_with_a_way_on() {
    let mut bytes = foreign_log(&sound_frames(3), Some(mcap::Compression::Zstd));
    let name = compression_name(&bytes);
    bytes[name..name + 4].copy_from_slice(b"lz4 ");
    let refused = parse_link_log(&bytes, "link.mcap".as_ref()).unwrap_err();
    let refused = refused.to_string();
    assert!(
        refused.contains("mcap compress --compression zstd"),
        "{refused}"
    );
}

/// A chunk that holds more or less than it declares is refused, and a size that fits no memory is not allocated.
#[test]
fn a_compressed_chunk_of_another_size_is_refused() {
    let sound = foreign_log(&sound_frames(3), Some(mcap::Compression::Zstd));
    // Length of the name, checksum and size are before the name.
    let size_at = compression_name(&sound) - 4 - 4 - 8;
    let size = u64::from_le_bytes(*sound[size_at..].first_chunk().unwrap());
    for declared in [0, size - 1, size + 1, 1 << 40, u64::MAX] {
        let mut bytes = sound.clone();
        bytes[size_at..size_at + 8].copy_from_slice(&declared.to_le_bytes());
        let refused = parse_link_log(&bytes, "link.mcap".as_ref()).unwrap_err();
        assert!(refused.to_string().contains("chunk"), "{refused}");
    }
}
