//! What ends motion, measured at the pins: a silent link, Stop, e-stop.

use std::ops::ControlFlow;
use std::time::Duration;

use emulator::Period;
use host_link::Robot;
use link_protocol::StateName;

use crate::rig::{self, Port};

const PERIOD: Duration = Duration::from_secs(10);
const TICK: Duration = Duration::from_millis(20);
/// From a byte on the wire to the pins: a frame's line time, the tick that sees it, and the period that latches it.
const WIRE_AND_LATCH: Duration = Duration::from_millis(30);

/// A robot in a powered state.
fn powered(state: StateName) -> Option<Robot<Port>> {
    let mut robot = rig::robot()?;
    rig::upload(&mut robot, &rig::circle(60.0));
    robot.arm(false).unwrap();
    if state != StateName::Holding {
        robot.play(0, PERIOD, false).unwrap();
        listen_for(&mut robot, StateName::Playing);
        robot
            .listen(Duration::from_secs(2), |_| ControlFlow::Continue(()))
            .unwrap();
    }
    if state == StateName::Paused {
        robot.pause(false).unwrap();
        listen_for(&mut robot, StateName::Paused);
    }
    rig::events(&mut robot);
    Some(robot)
}

fn listen_for(robot: &mut Robot<Port>, state: StateName) {
    robot
        .listen(Duration::from_secs(10), |telemetry| match telemetry {
            Some(telemetry) if telemetry.state == state => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        })
        .unwrap();
}

/// Time of the last period with pulses.
fn last_pulse(periods: &[Period]) -> Duration {
    periods
        .iter()
        .rev()
        .find(|period| period.powered())
        .map_or(Duration::ZERO, Period::at)
}

/// R5: a silent link: the ramp starts within 500 ms and takes the largest angle over the
/// largest rate; pulses off 0.5 s later; latched.
#[test]
fn a_silent_link_ramps_and_lets_go() {
    for state in [StateName::Holding, StateName::Playing, StateName::Paused] {
        let Some(mut robot) = powered(state) else {
            return;
        };
        let silent = host_link::Port::now(robot.port());
        rig::pass(&mut robot, Duration::from_secs(4));
        let off = last_pulse(&rig::events(&mut robot).periods).saturating_sub(silent);
        println!(
            "{state:?}: link silent, last pulse {} ms later",
            off.as_millis()
        );
        let ramp = Duration::from_millis(800); // 2.8 rad at 3.5 rad/s
        let most = Duration::from_millis(500) + ramp + Duration::from_millis(500) + WIRE_AND_LATCH;
        assert!(off <= most, "{state:?}: {off:?}");
        robot.reconnect().unwrap();
        assert_eq!(
            robot.status().unwrap().state,
            StateName::Stopped,
            "{state:?}: latched"
        );
        rig::pass(&mut robot, Duration::from_secs(1));
        assert!(
            rig::events(&mut robot)
                .periods
                .last()
                .is_some_and(|period| !period.powered())
        );
    }
}

/// R5: an e-stop takes the pulses away within a tick, also in the middle of an upload.
#[test]
fn an_estop_takes_the_pulses_away() {
    for uploading in [false, true] {
        let Some(mut robot) = powered(StateName::Playing) else {
            return;
        };
        if uploading {
            let table = rig::circle(50.0);
            let mut steps = 0;
            let _ = robot.upload(table.bytes(), Duration::from_mins(1), |_| {
                steps += 1;
                if steps > 3 {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            });
        }
        let asked = host_link::Port::now(robot.port());
        robot.estop().unwrap();
        rig::pass(&mut robot, Duration::from_secs(1));
        let off = last_pulse(&rig::events(&mut robot).periods).saturating_sub(asked);
        println!(
            "e-stop (uploading: {uploading}): last pulse began {} ms after the request",
            off.as_millis()
        );
        assert!(off <= TICK + WIRE_AND_LATCH, "{off:?}");
        assert_eq!(robot.status().unwrap().state, StateName::EStopped);
        assert!(robot.arm(false).is_err(), "latched");
    }
}

/// R5: Stop starts its ramp within a tick.
#[test]
fn a_stop_starts_its_ramp_within_a_tick() {
    let Some(mut robot) = powered(StateName::Paused) else {
        return;
    };
    let rest = {
        rig::pass(&mut robot, TICK);
        rig::events(&mut robot)
            .periods
            .last()
            .map(rig::angles)
            .unwrap()
    };
    let asked = host_link::Port::now(robot.port());
    robot.stop().unwrap();
    rig::pass(&mut robot, Duration::from_secs(2));
    let periods = rig::events(&mut robot).periods;
    let moved = periods
        .iter()
        .find(|period| {
            period.powered()
                && rig::angles(period)
                    .iter()
                    .zip(rest)
                    .any(|(now, then)| (now - then).abs() > 0.012)
        })
        .map(|period| period.at().saturating_sub(asked))
        .unwrap();
    println!(
        "Stop: the ramp began {} ms after the request",
        moved.as_millis()
    );
    assert!(moved <= TICK + WIRE_AND_LATCH, "{moved:?}");
    assert!(periods.last().is_some_and(|period| !period.powered()));
}
