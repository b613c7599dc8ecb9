//! The link log of a session holds every frame both ways, and it alone tells the session again.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use gait_player::GaitTable;
use host_link::Robot;
use host_link::port::{Direction, TracedFrame, TracedPort};
use link_protocol::{Decoder, Message, Request};
use swimmer_files::{LinkFrame, LinkLogWriter, SwimmerFile, read_link_log};
use twin::{Twin, TwinConfig, TwinPort, WireSpeed};

#[test]
fn a_log_tells_the_session_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("link.mcap");
    let seen: Arc<Mutex<Vec<LinkFrame>>> = Arc::default();
    let sink = Arc::clone(&seen);
    let twin = Twin::new(TwinConfig::new(&SwimmerFile::preset("robot").unwrap(), 1)).unwrap();
    let port = TracedPort::new(
        TwinPort::new(twin, WireSpeed::robot()),
        move |frame: TracedFrame<'_>| {
            sink.lock().unwrap().push(LinkFrame {
                direction: match frame.direction {
                    Direction::ToRobot => swimmer_files::Direction::ToRobot,
                    Direction::ToHost => swimmer_files::Direction::FromRobot,
                },
                host_time_ns: u64::try_from(frame.at.as_nanos()).unwrap(),
                robot_time_us: None,
                bytes: frame.bytes.to_vec(),
            });
        },
    );
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
    assert!(!path.exists(), "a log under way has no name yet");
    writer.finish().unwrap();
    let read = read_link_log(&path).unwrap();
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
        let to_robot = frame.direction == swimmer_files::Direction::ToRobot;
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
