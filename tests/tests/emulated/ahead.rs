//! The emulated robot runs ahead of the line while no byte can arrive, which saves a call every millisecond. No observer may see
//! a difference.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use emulator::{EmulatedRobot, Events};
use host_link::port::{Device, VirtualPort, WireSpeed};
use host_link::{Port, Robot};
use link_protocol::Telemetry;
use twin::VirtualRobot as _;

use crate::rig::{self, Image};

/// The same robot, advanced every millisecond.
struct StepByStep(EmulatedRobot);

impl Device for StepByStep {
    fn advance(&mut self, to: Duration) {
        self.0.advance(to);
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.0.receive(bytes);
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        self.0.transmit(room, out);
    }
}

/// Telemetry of a session with its times, and the end of the session.
type SessionRecord = (Vec<(Telemetry, Duration)>, Duration);

fn session<P: Port>(port: P) -> (SessionRecord, P) {
    let mut robot = Robot::connect(port, 1).unwrap();
    let seen = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&seen);
    robot.observe(Box::new(move |telemetry, at| {
        sink.lock().unwrap().push((*telemetry, at));
    }));
    let table = rig::circle(40.0);
    robot
        .upload(table.bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    robot.arm(false).unwrap();
    robot.play(1, Duration::from_secs(3), false).unwrap();
    robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap();
    let port = robot.into_port();
    let seen = std::mem::take(&mut *seen.lock().unwrap());
    ((seen, port.now()), port)
}

#[test]
fn a_robot_that_lives_ahead_is_the_same_robot() {
    let (one, other) = (rig::device(Image::Nano), rig::device(Image::Nano));
    let (ahead, port) = session(VirtualPort::new(one, WireSpeed::robot()));
    let mut one = port.into_device();
    let (stepped, port) = session(VirtualPort::new(StepByStep(other), WireSpeed::robot()));
    let mut other = port.into_device().0;
    assert!(ahead.0.len() > 50, "{} pieces of telemetry", ahead.0.len());
    for (index, (a, s)) in ahead.0.iter().zip(&stepped.0).enumerate() {
        assert_eq!(a, s, "telemetry {index}");
    }
    assert_eq!((ahead.0.len(), ahead.1), (stepped.0.len(), stepped.1));
    assert_eq!(one.world().pose(), other.world().pose());
    let (one, other): (Events, Events) = (one.take_events(), other.take_events());
    assert!(one.periods.len() > 150, "{} periods", one.periods.len());
    assert_eq!(one.log, other.log);
    assert_eq!(one.led, other.led);
    for (ahead, stepped) in one.periods.iter().zip(&other.periods) {
        assert_eq!(ahead, stepped);
    }
    assert!(one == other, "edges, resets or counts differ");
}
