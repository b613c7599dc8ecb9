//! The link log of a session holds every frame in both directions, and is sufficient to repeat the session.

use crate::traced;

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Duration;

use gait_player::GaitTable;
use host_link::Robot;
use link_protocol::{Decoder, Direction, Message, Request};
use swimmer_files::{LinkLogWriter, SwimmerFile, read_link_log};
use traced::traced;
use twin::TwinConfig;

#[test]
fn a_log_tells_the_session_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("link.mcap");
    let swimmer = SwimmerFile::preset("robot").unwrap();
    let (port, seen) = traced(TwinConfig::new(&swimmer, 1));
    let mut robot = Robot::connect(port, 1).unwrap();
    let table = GaitTable::from_fn(64, |u| {
        [
            (std::f64::consts::TAU * u).cos(),
            (std::f64::consts::TAU * u).sin(),
        ]
    })
    .unwrap();
    robot
        .upload(table.bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    robot.arm(false).unwrap();
    robot.play(1, Duration::from_secs(5), false).unwrap();
    robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap();
    drop(robot);

    let frames = Arc::into_inner(seen).unwrap().into_inner().unwrap();
    let mut writer = LinkLogWriter::create(&path).unwrap();
    for frame in &frames {
        writer.write(frame).unwrap();
    }
    assert!(path.exists(), "a log grows under its own name");
    writer.finish().unwrap();
    let read = read_link_log(&path).unwrap().frames;
    assert_eq!(read.len(), frames.len());
    assert!(
        read.iter()
            .zip(&frames)
            .all(|(a, b)| a.bytes == b.bytes && a.direction == b.direction)
    );

    // Decoded again, the log holds the table that was sent and the telemetry of the play.
    let (mut sent, mut telemetry) = (Vec::new(), 0);
    let mut decoders = [Decoder::new(), Decoder::new()];
    for frame in &read {
        let to_robot = frame.direction == Direction::ToRobot;
        for &byte in &frame.bytes {
            let message = decoders[usize::from(to_robot)]
                .push(byte)
                .map(|received| received.message.unwrap());
            match message {
                Some(Message::Request(Request::Chunk(chunk))) => {
                    assert_eq!(
                        usize::from(chunk.offset),
                        sent.len(),
                        "a clean line needs no repeats"
                    );
                    sent.extend_from_slice(&chunk.data);
                }
                Some(Message::Telemetry(_)) => telemetry += 1,
                _ => {}
            }
        }
    }
    assert_eq!(sent, table.bytes());
    assert!(
        telemetry > 100,
        "{telemetry} pieces of telemetry in more than 5 s"
    );
}
