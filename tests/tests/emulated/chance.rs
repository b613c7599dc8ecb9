//! Random numbers that differ between starts, so that a recording of one session does not act in another.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use host_link::port::{TracedFrame, TracedPort};
use host_link::session::SessionConfig;
use host_link::{Port as _, Robot};
use link_protocol::{Direction, Key, ResetReason, StateName};

use crate::promise::seen;
use crate::rig::{self, Image, Port};

const MS: Duration = Duration::from_millis(1);

/// Power cycles after which the recording is tried.
const STARTS: usize = 4;

/// Every kind of start, twice: power, reset pin, watchdog.
#[test]
fn no_start_has_the_numbers_of_another() {
    let mut robot = rig::robot();
    let mut told = vec![numbers(&robot)];
    for _ in 0..2 {
        rig::board_of(&mut robot).power_cycle().unwrap();
        told.push(started(&mut robot, ResetReason::PowerOn));
        rig::board_of(&mut robot).pin_reset().unwrap();
        told.push(started(&mut robot, ResetReason::Pin));
        rig::reset_by_hanging(&mut robot);
        told.push(started(&mut robot, ResetReason::Watchdog));
    }
    let nonces: BTreeSet<u32> = told.iter().map(|(nonce, _)| *nonce).collect();
    let sessions: BTreeSet<u16> = told.iter().map(|(_, session)| *session).collect();
    assert_eq!(nonces.len(), told.len(), "{told:x?}");
    assert_eq!(sessions.len(), told.len(), "{told:x?}");
    seen(
        "two starts each by power, reset pin and watchdog",
        "another boot nonce and another session number each",
    );
}

/// The replay protection that hangs on those numbers: a robot with a key, its power off and on.
#[test]
fn a_signed_recording_played_back_after_a_power_cycle_acts_nothing() {
    let key = Key(*b"sixteen letters!");
    let port = rig::port(Image::Nano);
    let mut robot = Robot::connect(port, 1).unwrap();
    rig::board_of(&mut robot).set_jumper(true).unwrap();
    rig::pass(&mut robot, MS * 100);
    robot.reconnect().unwrap();
    robot.set_key(Some(key)).unwrap();
    rig::board_of(&mut robot).set_jumper(false).unwrap();
    rig::pass(&mut robot, MS * 500); // stored while stopped
    // The recording holds the first session of its start, as the playing back will be.
    rig::board_of(&mut robot).power_cycle().unwrap();
    rig::pass(&mut robot, MS * 200);
    let heard = Arc::new(Mutex::new(Vec::<Vec<u8>>::new()));
    let tape = Arc::clone(&heard);
    let port = TracedPort::new(robot.into_port(), move |frame: TracedFrame<'_>| {
        if frame.direction == Direction::ToRobot {
            tape.lock().unwrap().push(frame.bytes.to_vec());
        }
    });
    let config = |seed| SessionConfig {
        key: Some(key),
        ..SessionConfig::new(seed)
    };
    let mut robot = Robot::connect_with(port, config(2)).unwrap();
    robot.arm(false).unwrap();
    assert_eq!(robot.status().unwrap().state, StateName::Holding);
    let (mut port, _) = robot.into_port().into_parts();
    let frames = heard.lock().unwrap().clone();
    let mut buf = [0; 512];
    for _ in 0..STARTS {
        port.device_mut().board_mut().power_cycle().unwrap();
        port.pass(MS * 200);
        port.device_mut().take_events();
        for frame in &frames {
            port.write(frame).unwrap();
            port.read(&mut buf, MS * 50).unwrap();
        }
        port.pass(MS * 500);
        let events = port.device_mut().take_events();
        assert!(events.periods.len() > 20, "it was not running");
        assert!(events.periods.iter().all(|period| !period.powered()));
    }
    let mut robot = Robot::connect_with(port, config(3)).unwrap();
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
    seen(
        "a signed session with its arming, recorded and played back after each of 4 power cycles",
        "nothing acts: no pulses, Stopped",
    );
}

/// Boot nonce and session number of the greeting after a start, whose reason is checked.
fn started(robot: &mut Robot<Port>, reason: ResetReason) -> (u32, u16) {
    rig::pass(robot, MS * 300);
    robot.reconnect().unwrap();
    assert_eq!(robot.info().reset_reason, reason);
    numbers(robot)
}

fn numbers(robot: &Robot<Port>) -> (u32, u16) {
    let info = robot.info();
    (info.boot_nonce, info.session)
}
