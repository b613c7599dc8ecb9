//! Robot with a shared key, and hosts with the correct key, a wrong one and no key, over faulty lines; and an adversary with a
//! complete recording.

use crate::tank_less;

use std::io;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use host_link::port::{TracedFrame, TracedPort};
use host_link::robot::{Callbacks, Halt};
use host_link::session::SessionConfig;
use host_link::testing::{FaultPlan, Faults};
use host_link::{LinkError, Port, Robot};
use link_protocol::{
    Binding, Direction, Flags, Header, Key, MAX_ENCODED, Message, Seal, StateName, Telemetry,
    encode, encode_signed,
};
use tank_less::{FaultyLine, circle, connect, faulty, upload};

const MS: Duration = Duration::from_millis(1);
const KEY: Key = Key(*b"sixteen letters!");

/// Returns a line to a robot that has the key.
fn keyed_line(seed: u64) -> FaultyLine {
    let mut robot = Robot::connect(faulty(Faults::none(), seed), seed).unwrap();
    robot.set_key(Some(KEY)).unwrap();
    let status = robot.status().unwrap();
    assert!(status.flags.contains(Flags::KEY_SET) && !status.flags.contains(Flags::UNSAVED));
    robot.into_port()
}

fn with_key(seed: u64, key: Key) -> SessionConfig {
    SessionConfig {
        key: Some(key),
        ..SessionConfig::new(seed)
    }
}

#[test]
fn without_the_key_or_with_a_wrong_one_the_error_says_so_and_stops_work() {
    let mut robot = Robot::connect(keyed_line(1), 2).unwrap();
    let error = robot.arm(false).unwrap_err().to_string();
    assert!(
        error.contains("has a key") && error.contains("--key FILE"),
        "{error}"
    );
    let table = circle(1.0);
    let error = upload(&mut robot, table.bytes()).unwrap_err().to_string();
    assert!(error.contains("--key FILE"), "{error}");
    let mut robot = Robot::connect_with(robot.into_port(), with_key(3, Key([1; 16]))).unwrap();
    let error = robot.status().unwrap_err().to_string();
    assert!(
        error.contains("another key") && error.contains("--key FILE"),
        "{error}"
    );
    robot.stop().unwrap();
    let (mut port, _) =
        Robot::stop_at_once(robot.into_port(), 4, Halt::EStop, Callbacks::default()).unwrap();
    port.inner_mut().pass(MS * 20);
    assert_eq!(
        port.inner().device().output.unwrap().state,
        StateName::EStopped
    );
    let mut robot = Robot::connect_with(port, with_key(5, KEY)).unwrap();
    robot.arm(true).unwrap();
}

#[test]
fn a_whole_session_with_the_key_over_a_bad_line() {
    let mut longest = Duration::ZERO;
    for seed in 0..30 {
        let mut robot = Robot::connect_with(keyed_line(seed), with_key(seed + 99, KEY)).unwrap();
        let faults = "drop=10%,flip=1%,duplicate=5%,reorder=2%,delay=50,clump=230,stale=300";
        robot
            .port_mut()
            .set_plan(FaultPlan::at_host(faults.parse().unwrap()));
        let table = circle(1.2);
        let began = robot.port().now();
        let info = upload(&mut robot, table.bytes()).unwrap_or_else(|e| panic!("{seed}: {e}"));
        assert_eq!(info.crc32, table.crc32(), "seed {seed}");
        longest = longest.max(robot.port().now().abs_diff(began));
        robot
            .port_mut()
            .set_plan(FaultPlan::at_host(Faults::none()));
        robot.arm(false).unwrap();
        robot.play(1, MS * 6000, false).unwrap();
        robot
            .wait_until_finished(|_| ControlFlow::Continue(()))
            .unwrap_or_else(|e| panic!("{seed}: {e}"));
        let acts = &robot.port().inner().device().acts;
        assert!(acts.values().all(|&times| times == 1), "seed {seed}");
    }
    println!(
        "signed uploads of 2 kB over 10 % loss, 1 % flips, 5 % duplicates, 2 % reordered, 50 ms, 230-byte lumps, 300 stale bytes: 30 of 30 seeds, {:.1} s at most",
        longest.as_secs_f64()
    );
}

#[test]
fn a_recording_played_back_at_any_later_time_moves_nothing() {
    let heard = Arc::new(Mutex::new(Vec::<Vec<u8>>::new()));
    let tape = Arc::clone(&heard);
    let port = TracedPort::new(keyed_line(1), move |frame: TracedFrame<'_>| {
        if frame.direction == Direction::ToRobot {
            tape.lock().unwrap().push(frame.bytes.to_vec());
        }
    });
    let mut robot = Robot::connect_with(port, with_key(2, KEY)).unwrap();
    robot
        .upload(circle(1.0).bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    robot.arm(false).unwrap();
    robot.play(1, MS * 6000, false).unwrap();
    robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap();
    let (mut port, _) = robot.into_port().into_parts();
    port.inner_mut().pass(MS * 2000);
    let rested = port.inner().device().powered;
    let frames = heard.lock().unwrap().clone();
    assert!(frames.len() > 150, "{}", frames.len());
    let mut buf = [0; 512];
    for frame in &frames {
        port.write(frame).unwrap();
        port.read(&mut buf, MS * 20).unwrap();
    }
    port.inner_mut().pass(MS * 2000);
    let device = port.inner().device();
    assert_eq!(device.powered, rested, "the recording armed the robot");
    println!(
        "{} recorded frames of a signed session played back: nothing armed, nothing moved",
        frames.len()
    );
}

#[test]
fn a_key_is_changed_and_removed_only_with_the_key() {
    let mut robot = Robot::connect_with(keyed_line(1), with_key(2, KEY)).unwrap();
    let new = Key([9; 16]);
    robot.set_key(Some(new)).unwrap();
    let mut old = Robot::connect_with(robot.into_port(), with_key(3, KEY)).unwrap();
    assert!(matches!(old.set_key(None), Err(LinkError::Refused { .. })));
    let mut robot = Robot::connect_with(old.into_port(), with_key(4, new)).unwrap();
    robot.set_key(None).unwrap();
    let mut anyone = Robot::connect(robot.into_port(), 5).unwrap();
    anyone.arm(false).unwrap();
}

#[test]
fn a_host_with_a_key_drives_a_robot_without() {
    let line = connect("", 1).into_port();
    let mut robot = Robot::connect_with(line, with_key(2, KEY)).unwrap();
    let table = circle(1.0);
    assert_eq!(
        upload(&mut robot, table.bytes()).unwrap().crc32,
        table.crc32()
    );
    robot.arm(false).unwrap();
}

/// Line with a second sender.
struct Overheard {
    line: FaultyLine,
    forged: Vec<u8>,
}

impl Port for Overheard {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let count = self.forged.len().min(buf.len());
        if count == 0 {
            return self.line.read(buf, timeout);
        }
        buf[..count].copy_from_slice(&self.forged[..count]);
        self.forged.drain(..count);
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.line.write(bytes)
    }

    fn now(&self) -> Duration {
        self.line.now()
    }
}

/// Telemetry of a fictitious e-stop, unsigned and signed with another key.
fn lies(told: &Telemetry, session: u16) -> [Vec<u8>; 2] {
    let lie = Message::Telemetry(Telemetry {
        robot_us: told.robot_us + 1,
        state: StateName::EStopped,
        ..*told
    });
    let header = Header::new(session, 9_999);
    let seal = Seal::new(
        &Key([1; 16]),
        Binding {
            boot_nonce: 0,
            session,
            host_nonce: 0,
        },
    );
    let mut bytes = [0; MAX_ENCODED];
    let unsigned = encode(header, &lie, &mut bytes).unwrap();
    let unsigned = bytes[..unsigned].to_vec();
    let signed = encode_signed(header, &lie, &seal, 1 << 40, &mut bytes).unwrap();
    [unsigned, bytes[..signed].to_vec()]
}

#[test]
fn a_false_robot_is_not_believed_once_the_true_one_has_signed() {
    let line = Overheard {
        line: keyed_line(1),
        forged: Vec::new(),
    };
    let mut robot = Robot::connect_with(line, with_key(2, KEY)).unwrap();
    robot.status().unwrap();
    robot
        .listen(MS * 200, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(robot.answers_signed(), Some(true));
    assert_eq!(robot.link_counters().forged, 0);
    let told = *robot.telemetry().unwrap();
    for (number, lie) in (1..).zip(lies(&told, robot.info().session)) {
        robot.port_mut().forged = lie;
        robot
            .listen(MS * 200, |told| {
                let stopped = told.is_none_or(|told| told.state == StateName::Stopped);
                assert!(stopped, "the lie was believed");
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!(robot.link_counters().forged, number);
    }
}

#[test]
fn a_robot_that_signs_nothing_is_told_from_one_that_does() {
    let mut robot = Robot::connect_with(connect("", 1).into_port(), with_key(2, KEY)).unwrap();
    robot.status().unwrap();
    assert_eq!(robot.answers_signed(), Some(false));
    assert!(robot.link_counters().unsigned > 0);
    let mut robot = Robot::connect(robot.into_port(), 3).unwrap();
    robot.status().unwrap();
    assert_eq!(robot.answers_signed(), None);
}
