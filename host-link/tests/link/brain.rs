//! Session and blocking robot against the real brain over faulty lines, in virtual time.

use crate::tank_less;

use std::ops::ControlFlow;
use std::time::Duration;

use host_link::robot::{Callbacks, Halt, time_left};
use host_link::testing::{FaultPlan, FaultyPort, Outage};
use host_link::{LinkError, Port, Robot};
use link_protocol::{StateName, StopCause};
use tank_less::{FaultyLine, circle, configuration, connect, faulty, upload};

const MS: Duration = Duration::from_millis(1);

#[test]
fn a_whole_play_from_greeting_to_rest() {
    let mut robot = connect("", 2);
    assert_eq!(robot.firmware(), "0.1.0");
    robot.configure(configuration(2.0)).unwrap();
    assert!((robot.configuration().unwrap().max_angle - 2.0).abs() < 1e-6);
    robot.trim(link_protocol::Joint::Front, 0.02).unwrap();
    assert_eq!(robot.servo(link_protocol::Joint::Front).unwrap().trim, 200);
    upload(&mut robot, circle(1.0).bytes()).unwrap();
    let refused = robot.play(2, MS * 8000, false).unwrap_err();
    assert!(refused.to_string().contains("arm it first"), "{refused}");
    robot.arm(false).unwrap();
    robot.play(2, MS * 8000, false).unwrap();
    let began = robot.port().now();
    let mut seen = Vec::new();
    let end = robot
        .wait_until_finished(|telemetry| {
            seen.extend(telemetry.map(|telemetry| telemetry.state));
            ControlFlow::Continue(())
        })
        .unwrap();
    seen.dedup();
    assert_eq!((end.cause, end.cycle), (StopCause::Finished, 2));
    assert_eq!(seen[..2], [StateName::Starting, StateName::Playing]);
    let took = robot.port().now().abs_diff(began);
    assert!(took > MS * 16_000 && took < MS * 18_500, "{took:?}");
    let clock = robot.clock().unwrap();
    assert!(clock.pings >= 8 && clock.uncertainty < 0.02, "{clock:?}");
    let error = clock.robot_time(robot.port().now()) - robot.port().now().as_secs_f64();
    assert!(
        error.abs() < clock.uncertainty,
        "{error} against {}",
        clock.uncertainty
    );
}

#[test]
fn an_operator_breaks_off_and_the_robot_stops() {
    let mut robot = connect("drop=5%,flip=1%,delay=50", 3);
    upload(&mut robot, circle(1.0).bytes()).unwrap();
    robot.arm(false).unwrap();
    robot.play(0, MS * 8000, false).unwrap();
    let asked = robot.port().now() + MS * 5000;
    let mut stopped_at = Duration::ZERO;
    let mut now = robot.port().now();
    let error = robot
        .wait_until_finished(|_| {
            now += MS;
            stopped_at = now;
            if stopped_at > asked {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })
        .unwrap_err();
    assert!(matches!(error, LinkError::Interrupted { .. }), "{error}");
    let stopped = robot.port().now();
    robot
        .listen(MS * 3000, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
    // Ramp of at most 0.8 s and half a second at neutral.
    let powered = robot.port().inner().device().powered;
    assert!(
        powered < stopped + MS * 1400,
        "{powered:?} after {stopped:?}"
    );
    let refused = robot.resume().unwrap_err();
    assert!(matches!(refused, LinkError::Refused { .. }), "{refused}");
}

#[test]
fn stops_act_through_a_fifth_of_all_frames_lost() {
    let mut worst = Duration::ZERO;
    for seed in 0..30 {
        let mut robot = connect("", seed);
        upload(&mut robot, circle(1.0).bytes()).unwrap();
        robot.arm(false).unwrap();
        robot.play(0, MS * 8000, false).unwrap();
        robot
            .listen(MS * 3000, |_| ControlFlow::Continue(()))
            .unwrap();
        let mut robot = spoil(robot, "drop=20%,flip=1%,delay=30,clump=230", seed);
        let asked = robot.port().now();
        robot
            .stop()
            .unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        robot
            .listen(MS * 2500, |_| ControlFlow::Continue(()))
            .unwrap();
        let device = robot.port().inner().inner().device();
        assert!(device.output.unwrap().pulses_ns.is_none(), "seed {seed}");
        worst = worst.max(device.powered.saturating_sub(asked));
    }
    println!(
        "stop through 20 % loss: pulses off after {} ms at most",
        worst.as_millis()
    );
    // Ramp of at most 0.8 s, half a second at neutral, and repeats of 0.2 s each.
    assert!(worst < MS * 2400, "{worst:?}");
}

/// Adds faults to a line and keeps the session.
fn spoil(robot: Robot<FaultyLine>, faults: &str, seed: u64) -> Robot<FaultyPort<FaultyLine>> {
    use host_link::testing::FaultPlan;
    robot.map_port(|port| FaultyPort::new(port, FaultPlan::at_host(faults.parse().unwrap()), seed))
}

#[test]
fn a_second_program_takes_over_and_the_first_is_told() {
    let mut first = connect("", 7);
    first.status().unwrap();
    let mut port = first.into_port();
    let mut second = Robot::connect(&mut port, 77).unwrap();
    second.status().unwrap();
    // Frames of the first session arrive late, after the second greeting.
    drop(second);
    let mut third = Robot::connect(&mut port, 78).unwrap();
    assert_eq!(third.status().unwrap().state, StateName::Stopped);
}

#[test]
fn a_stop_works_without_a_greeting() {
    let mut robot = connect("", 8);
    upload(&mut robot, circle(1.0).bytes()).unwrap();
    robot.arm(false).unwrap();
    robot.play(3, MS * 9000, true).unwrap();
    robot
        .listen(MS * 2000, |_| ControlFlow::Continue(()))
        .unwrap();
    let (mut port, _) =
        Robot::stop_at_once(robot.into_port(), 80, Halt::Stop, Callbacks::default()).unwrap();
    port.inner_mut().pass(MS * 1600);
    assert!(port.inner().device().output.unwrap().pulses_ns.is_none());
    let (mut port, _) = Robot::stop_at_once(port, 81, Halt::EStop, Callbacks::default()).unwrap();
    port.inner_mut().pass(MS * 20);
    assert_eq!(
        port.inner().device().output.unwrap().state,
        StateName::EStopped
    );
}

/// The uplink is dead, the downlink works: telemetry of the stop ends the wait at once, with its cause.
#[test]
fn a_lost_link_that_telemetry_tells_ends_the_wait_at_once() {
    for (cycles, words) in [(3, "0 of 3 cycles"), (0, "0 cycles of a play without end")] {
        let mut robot = connect("", 13);
        upload(&mut robot, circle(1.0).bytes()).unwrap();
        robot.arm(false).unwrap();
        robot.play(cycles, MS * 8000, false).unwrap();
        robot
            .listen(MS * 3000, |_| ControlFlow::Continue(()))
            .unwrap();
        let deaf = FaultPlan {
            written: "drop=100%".parse().unwrap(),
            ..FaultPlan::default()
        };
        let mut robot = robot.map_port(|port| FaultyPort::new(port, deaf, 1));
        let mut told = None;
        let mut now = robot.port().now();
        let error = loop {
            let waited = robot.wait_while(|telemetry| {
                let over =
                    telemetry.is_some_and(|telemetry| telemetry.cause == StopCause::LinkLost);
                if told.is_none() && over {
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(())
            });
            now = robot.port().now().max(now);
            match waited {
                Ok(None) => told = Some(now),
                Ok(Some(status)) => panic!("{status:?}"),
                Err(error) => break error,
            }
        };
        let waited = now.saturating_sub(told.unwrap());
        assert!(waited < MS * 2000, "{waited:?}");
        let said = error.to_string();
        assert!(
            said.contains("it lost the link") && said.contains(words),
            "{said}"
        );
    }
}

/// Plays three cycles of eight seconds; the link is interrupted from 3 s after the start on.
fn play_through_an_outage(
    detached: bool,
    duration: Duration,
) -> (Result<link_protocol::Status, LinkError>, Duration) {
    let mut robot = connect("", 12);
    upload(&mut robot, circle(1.0).bytes()).unwrap();
    robot.arm(false).unwrap();
    robot.play(3, MS * 8000, detached).unwrap();
    let status = robot.status().unwrap();
    assert_eq!(time_left(&status), Some(MS * 24_000));
    let began = robot.port().now();
    let outage = Outage::once(began + MS * 3000, duration);
    robot.port_mut().disconnect(outage);
    let end = robot.wait_until_finished(|_| ControlFlow::Continue(()));
    let took = robot.port().now().abs_diff(began);
    (end, took)
}

#[test]
fn a_detached_play_is_found_again_and_seen_to_its_end() {
    for duration in [MS * 4000, MS * 20_000, MS * 45_000] {
        let (end, took) = play_through_an_outage(true, duration);
        let end = end.unwrap();
        assert_eq!((end.cause, end.cycle), (StopCause::Finished, 3));
        // End of the play, or of the interruption and one wait between two greetings.
        let latest = (MS * 26_500).max(duration + MS * 8000);
        assert!(took > MS * 24_000 && took < latest, "{took:?}");
    }
    // The end of the play is known: a robot that is absent half a minute later is given up.
    let (end, took) = play_through_an_outage(true, MS * 600_000);
    let error = end.unwrap_err();
    assert!(matches!(error, LinkError::NoAnswer { .. }), "{error}");
    assert!(took > MS * 54_000 && took < MS * 70_000, "{took:?}");
}

#[test]
fn a_play_that_lost_its_link_is_told_to_have_stopped() {
    let (end, took) = play_through_an_outage(false, MS * 4000);
    let error = end.unwrap_err();
    let LinkError::StoppedEarly { cause, cycle, .. } = error else {
        panic!("{error}")
    };
    assert_eq!((cause, cycle), (StopCause::LinkLost, 0));
    assert!(took < MS * 12_000, "{took:?}");
}

/// A wait for the end of a motion must ignore telemetry from before it was armed.
#[test]
fn telemetry_from_before_an_order_is_forgotten() {
    let mut robot = connect("delay=100,clump=230", 9);
    robot
        .listen(MS * 2000, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(robot.telemetry().unwrap().state, StateName::Stopped);
    robot.arm(false).unwrap();
    let mut seen = Vec::new();
    robot
        .listen(MS * 2000, |telemetry| {
            seen.extend(telemetry.map(|telemetry| telemetry.state));
            ControlFlow::Continue(())
        })
        .unwrap();
    seen.dedup();
    assert_eq!(seen, [StateName::Holding]);
}

/// For any requests, order and line, each ticket ends in exactly one event.
#[test]
fn every_ticket_ends_exactly_once() {
    use host_link::session::{Event, Session, SessionConfig};
    use link_protocol::{Checked, Joint, Play, Request, crc32c};
    use rand::{RngExt, SeedableRng};
    let mut ended_well = 0;
    let checked = Checked {
        table_crc32: crc32c(circle(0.8).bytes()),
        settings_crc32: tank_less::settings_as_built(),
    };
    for seed in 0..150 {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let faults = [
            "",
            "drop=20%,flip=2%,duplicate=5%,clump=230",
            "drop=60%,delay=300",
            "disconnect=2000:7000",
        ][usize::try_from(seed).unwrap() % 4];
        let mut line = faulty(faults.parse().unwrap(), seed);
        let mut session = Session::new(SessionConfig::new(seed));
        let mut ends = std::collections::BTreeMap::new();
        let mut next_ask = Duration::ZERO;
        let mut buf = [0; 256];
        // Until all have ended, plus ten seconds; a queue of requests on the worst line takes minutes.
        let mut last_open = Duration::ZERO;
        while line.now() < (last_open + MS * 10_000).max(MS * 22_000) && line.now() < MS * 300_000 {
            let now = line.now();
            if now >= next_ask && now < MS * 12_000 {
                next_ask = now + MS * rng.random_range(1..400);
                let play = Play {
                    cycles: 1,
                    period_us: 6_000_000,
                    detached: false,
                    checked,
                };
                let ticket = match rng.random_range(0..12) {
                    0 | 1 => session.connect(now),
                    2 => session.upload(
                        now,
                        0,
                        circle(0.8).bytes(),
                        now + MS * rng.random_range(1..20_000),
                    ),
                    3 => session.request(now, Request::Stop),
                    4 => session.request(now, Request::Arm),
                    5 => session.request(now, Request::Play(play)),
                    6 => session.request(
                        now,
                        Request::Trim {
                            joint: Joint::Back,
                            trim: 5,
                        },
                    ),
                    _ => session.request(now, Request::Status),
                };
                ends.insert(ticket, 0);
            }
            if ends.values().any(|&count| count == 0) {
                last_open = now;
            }
            session.poll(now);
            line.write(&session.take_outgoing()).unwrap();
            while let Some(event) = session.next_event() {
                match event {
                    Event::Connected { ticket, .. }
                    | Event::Answered { ticket, .. }
                    | Event::StoppedByItself { ticket, .. }
                    | Event::Uploaded { ticket, .. } => {
                        ended_well += 1;
                        *ends.get_mut(&ticket).unwrap() += 1;
                    }
                    Event::Failed { ticket, .. } => *ends.get_mut(&ticket).unwrap() += 1,
                    Event::Progress { .. } | Event::Telemetry { .. } => {}
                }
            }
            let wake = session
                .next_deadline()
                .unwrap_or(now + MS * 20)
                .min(now + MS * 20);
            let count = line
                .read(&mut buf, wake.saturating_sub(now).max(MS))
                .unwrap();
            session.receive(line.now(), &buf[..count]);
        }
        assert!(
            ends.values().all(|&count| count == 1),
            "seed {seed}, {faults}: {ends:?}"
        );
    }
    assert!(ended_well > 1000, "{ended_well}");
}
