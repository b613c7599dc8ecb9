//! Promise R5 behind a slow uplink with a deep buffer: whatever a dead host left in it, the robot stops within the bound of
//! `docs/security.md`, and the sender of a stop learns the cause that ended the motion.

use crate::haste;
use crate::tank_less;

use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::time::Duration;

use gait_player::GaitTable;
use haste::fill;
use host_link::testing::{FaultPlan, Faults};
use host_link::{Port, Robot as HostRobot, StoppedBy};
use link_protocol::{StateName, StopCause};
use tank_less::{FaultyLine, circle, faulty};

const MS: Duration = Duration::from_millis(1);
const RATES: [u32; 6] = [200, 500, 1_000, 2_000, 5_000, 11_000];
const BUFFERS: [usize; 5] = [512, 1_024, 2_048, 4_096, 8_192];
/// From the last byte of a host to the ramp: freshness, lease, one tick.
const TO_RAMP: Duration = Duration::from_millis(1_480);
/// From the last fresh keep-alive to pulses off: lease, one tick, the longest ramp, half a second at neutral.
const TO_OFF: Duration = Duration::from_secs(2);

/// Returns a host whose robot plays endlessly, before the line degrades.
fn playing(seed: u64) -> HostRobot<FaultyLine> {
    let mut robot = HostRobot::connect(faulty(Faults::none(), seed), seed).unwrap();
    let table = GaitTable::from_fn(64, |u| {
        let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
        [1.2 * cos, 1.2 * sin]
    })
    .unwrap();
    tank_less::upload(&mut robot, table.bytes()).unwrap();
    robot.arm(false).unwrap();
    robot.play(0, Duration::from_secs(8), false).unwrap();
    listen(&mut robot, MS * 3_000);
    assert_eq!(state(&robot), StateName::Playing);
    robot
}

fn state(robot: &HostRobot<FaultyLine>) -> StateName {
    robot.port().inner().device().output.unwrap().state
}

fn listen(robot: &mut HostRobot<FaultyLine>, time: Duration) {
    robot.listen(time, |_| ControlFlow::Continue(())).unwrap();
}

fn worsen(robot: &mut HostRobot<FaultyLine>, rate: u32, buffer: usize) {
    let slow = Faults {
        rate: Some(rate),
        buffer,
        ..Faults::none()
    };
    robot.port_mut().set_plan(FaultPlan::at_host(slow));
}

/// Time to the ramp, and from the last fresh keep-alive to pulses off, without a host.
fn left_alone(robot: HostRobot<FaultyLine>, from: Duration) -> (Duration, Duration) {
    let mut port = robot.into_port();
    let mut bytes = [0; 512];
    let end = port.now() + Duration::from_mins(1);
    while port.now() < end {
        port.read(&mut bytes, MS * 20).unwrap();
    }
    let device = port.inner().device();
    assert_eq!(device.output.unwrap().state, StateName::Stopped);
    (
        device.ramp.saturating_sub(from),
        device.powered.saturating_sub(device.fresh),
    )
}

/// Kills the host at a moment, with its buffer full: once idle, once during an upload.
fn killed(rate: u32, buffer: usize, moment: u32) -> (Duration, Duration) {
    let mut robot = playing(u64::from(moment));
    worsen(&mut robot, rate, buffer);
    let until = robot.port().now() + MS * 170 * moment;
    if moment.is_multiple_of(2) {
        listen(&mut robot, MS * 170 * moment);
    } else {
        let clock = std::rc::Rc::new(std::cell::Cell::new(0));
        let turns = clock.clone();
        let began = robot.port().now();
        let _ = robot.upload(circle(1.2).bytes(), Duration::from_mins(1), |_| {
            turns.set(turns.get() + 1);
            // A turn is 20 ms at most.
            if began + MS * 20 * turns.get() >= until {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
    }
    fill(&mut robot, buffer);
    let from = robot.port().now();
    left_alone(robot, from)
}

/// Time from a stop behind a full buffer to the ramp, and the cause that the host reports.
fn stopped(rate: u32, buffer: usize, moment: u32) -> (Duration, StoppedBy) {
    let mut robot = playing(u64::from(moment));
    worsen(&mut robot, rate, buffer);
    listen(&mut robot, MS * 170 * moment);
    fill(&mut robot, buffer);
    let from = robot.port().now();
    let by = robot.stop().unwrap();
    (left_alone(robot, from).0, by)
}

#[test]
fn behind_a_slow_uplink_the_robot_stops_in_time() {
    let mut text = String::from(
        "uplink of so many bytes a second, with a buffer that a host filled before it died (d) or sent a stop (s), at ten moments\nd: worst time to the ramp / from the last fresh keep-alive to no pulses, s; s: worst time to the ramp, s, and how often it was the stop's answer\n",
    );
    let _ = write!(text, "\n{:>8}", "buffer");
    for rate in RATES {
        let _ = write!(text, " {:>26}", format!("{rate} B/s"));
    }
    for buffer in BUFFERS {
        let _ = write!(text, "\n{buffer:>8}");
        for rate in RATES {
            let (mut ramp, mut off, mut stop, mut answered) =
                (Duration::ZERO, Duration::ZERO, Duration::ZERO, 0);
            for moment in 0..10 {
                let (to_ramp, to_off) = killed(rate, buffer, moment);
                assert!(to_ramp <= TO_RAMP, "{rate} B/s, {buffer} B: {to_ramp:?}");
                assert!(to_off <= TO_OFF, "{rate} B/s, {buffer} B: {to_off:?}");
                (ramp, off) = (ramp.max(to_ramp), off.max(to_off));
                let (to_ramp, by) = stopped(rate, buffer, moment);
                assert!(to_ramp <= TO_RAMP, "{rate} B/s, {buffer} B: {to_ramp:?}");
                stop = stop.max(to_ramp);
                match by {
                    StoppedBy::Request => answered += 1,
                    StoppedBy::Itself(cause) => assert_eq!(cause, StopCause::LinkLost),
                }
            }
            let seconds = Duration::as_secs_f64;
            let _ = write!(
                text,
                " {:>26}",
                format!(
                    "d {:.2}/{:.2} s {:.2} {answered:>2}/10",
                    seconds(&ramp),
                    seconds(&off),
                    seconds(&stop)
                )
            );
        }
    }
    println!("{text}");
    insta::assert_snapshot!(text);
}

/// The uplink is dead, the downlink works: telemetry ends the wait soon.
#[test]
fn a_link_loss_that_was_told_ends_the_wait_within_two_seconds() {
    let mut robot = playing(1);
    let deaf = FaultPlan {
        written: Faults {
            drop: 1.0,
            ..Faults::none()
        },
        read: Faults::none(),
    };
    robot.port_mut().set_plan(deaf);
    let error = robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap_err();
    assert!(
        error.to_string().contains("it lost the link") && error.to_string().contains("without end"),
        "{error}"
    );
    let took = robot
        .port()
        .now()
        .abs_diff(robot.port().inner().device().ramp);
    println!(
        "told {:.2} s after the ramp began: {error}",
        took.as_secs_f64()
    );
    assert!(took <= Duration::from_secs(2), "{took:?}");
}
