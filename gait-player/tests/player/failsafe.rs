//! Promise R5 in virtual time: every failsafe stops the robot in time.
#![allow(clippy::float_cmp)] // set-points are compared to the last bit
use crate::bench;

use bench::stops::*;
use bench::*;
use gait_player::Transport;
use link_protocol::*;

#[test]
fn r5_a_silent_link_starts_the_ramp_within_half_a_second() {
    for mut bench in powered() {
        let name = bench.output.state;
        bench.beat();
        bench.keep_alive = false;
        let took = until_stopping(&mut bench, SECOND);
        println!(
            "R5: link silent while {name:?}: ramp after {} ms",
            took / 1000
        );
        assert!((400_000..=500_000).contains(&took), "{took}");
        bench.keep_alive = true;
        follow_stop(&mut bench, StopCause::LinkLost);
        // The link returns, but nothing resumes.
        assert!(
            bench
                .run(5 * SECOND)
                .iter()
                .all(|output| output.pulses_ns.is_none())
        );
        assert_eq!(bench.refused(play(1, 5_000_000)), Refusal::NotArmed);
    }
}

#[test]
fn frames_of_other_sessions_do_not_keep_the_link_alive() {
    for mut bench in powered() {
        bench.keep_alive = false;
        let start = bench.now_us;
        while !matches!(
            bench.output.state,
            StateName::Stopping | StateName::Settling
        ) {
            let stale = Header::new(bench.session.wrapping_sub(1), 3);
            let heartbeat = Heartbeat {
                host_us: 1,
                heard_us: bench.now_us,
            };
            bench.send(stale, &Message::Heartbeat(heartbeat));
            bench.send(stale, &Message::Request(Request::Status));
            bench
                .brain
                .receive(bench.now_us, Transport::Uart, &[0, 5, 1, 2, 3, 4, 0]);
            bench.tick();
            assert!(bench.now_us - start <= 500_000);
        }
    }
}

#[test]
fn a_detached_play_goes_on_to_its_end() {
    let detached = Request::Play(Play {
        cycles: 3,
        period_us: 5_000_000,
        detached: true,
        checked: AS_HELD,
    });
    let mut bench = Bench::new();
    bench.upload(&circle(1.2));
    bench.done(ARM);
    bench.done(detached);
    bench.keep_alive = false;
    bench.until(StateName::Playing, 2 * SECOND);
    assert_eq!(bench.until(StateName::Stopping, 16 * SECOND), 15 * SECOND);
    let last = *bench.telemetry.last().unwrap();
    assert!(last.flags.contains(Flags::LINK_SILENT));
    follow_stop(&mut bench, StopCause::Finished);
}

#[test]
fn another_host_can_take_over_a_detached_play() {
    let detached = Request::Play(Play {
        cycles: 3,
        period_us: 5_000_000,
        detached: true,
        checked: AS_HELD,
    });
    let mut bench = Bench::playing(&circle(1.2), detached);
    bench.keep_alive = false;
    bench.run(3 * SECOND);
    bench.greet(77);
    bench.sequence = 40_000;
    let status = bench.status();
    assert_eq!((status.state, status.cycles), (StateName::Playing, 3));
    assert!(status.flags.contains(Flags::DETACHED));
    let pause = Request::Pause { detached: true };
    assert_eq!(bench.refused(pause.clone()), Refusal::NotFresh);
    bench.beat();
    bench.done(pause);
    bench.run(SECOND);
    // Resuming the motion requires a live host.
    assert_eq!(bench.refused(Request::Resume), Refusal::NotFresh);
    bench.beat();
    bench.done(Request::Resume);
    bench.run(SECOND);
    bench.done(Request::Stop);
    follow_stop(&mut bench, StopCause::Requested);
}

#[test]
fn a_detached_pause_holds_for_a_minute() {
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    bench.done(Request::Pause { detached: true });
    bench.keep_alive = false;
    let took = bench.until(StateName::Stopping, 61 * SECOND);
    assert!(took.abs_diff(60 * SECOND) <= TICK, "{took}");
    follow_stop(&mut bench, StopCause::PauseExpired);
    // The minute begins when the operator detaches, regardless of the pause so far.
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    bench.done(Request::Pause { detached: false });
    bench.run(70 * SECOND);
    bench.done(Request::Pause { detached: true });
    bench.keep_alive = false;
    let took = bench.until(StateName::Stopping, 61 * SECOND);
    assert!(took.abs_diff(60 * SECOND) <= TICK, "{took}");
    // The minute also counts with a link, and a repeated request does not extend it.
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    bench.done(Request::Pause { detached: true });
    bench.run(40 * SECOND);
    bench.done(Request::Pause { detached: true });
    bench.keep_alive = false;
    let took = bench.until(StateName::Stopping, 61 * SECOND);
    assert!(took.abs_diff(20 * SECOND) <= TICK, "{took}");
    // An attached pause after a detached one requires the link again.
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    bench.done(Request::Pause { detached: true });
    bench.done(Request::Pause { detached: false });
    bench.keep_alive = false;
    bench.until(StateName::Stopping, 500_000);
}

#[test]
fn r5_a_stop_moves_within_a_tick_and_an_estop_drops_the_pulses_within_one() {
    for mut bench in powered() {
        let (name, before) = (bench.output.state, bench.output.setpoint);
        bench.done(Request::Stop);
        let after = bench.tick();
        let closer = |joint: usize| {
            after.setpoint[joint].abs() < before[joint].abs() || before[joint] == 0.0
        };
        assert!(
            closer(0) && closer(1),
            "{name:?}: {before:?} {:?}",
            after.setpoint
        );
        follow_stop(&mut bench, StopCause::Requested);
    }
    for mut bench in powered() {
        bench.done(Request::EStop);
        let after = bench.tick();
        assert_eq!((after.state, after.pulses_ns), (StateName::EStopped, None));
        assert_eq!(bench.status().cause, StopCause::EStop);
        // A stop does not weaken the e-stop, and an arm does not clear it.
        bench.done(Request::Stop);
        assert_eq!(bench.refused(ARM), Refusal::EStopped);
        assert_eq!(bench.refused(play(1, 5_000_000)), Refusal::EStopped);
        assert!(
            bench
                .run(SECOND)
                .iter()
                .all(|output| output.pulses_ns.is_none())
        );
        // The pulses return at the pose where they were switched off.
        let pose = bench.output.setpoint;
        bench.clear_estop();
        bench.done(ARM);
        let armed = bench.tick();
        assert_eq!((armed.state, armed.setpoint), (StateName::Holding, pose));
        assert!(armed.pulses_ns.is_some());
    }
}

#[test]
fn a_stop_during_a_stop_keeps_the_more_severe_cause() {
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    bench.keep_alive = false;
    bench.until(StateName::Stopping, SECOND);
    bench.done(Request::Stop);
    assert_eq!(bench.status().cause, StopCause::LinkLost);
    // Low for more than a second by now: the more severe cause.
    bench.until(StateName::Settling, SECOND);
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    bench.run(SECOND);
    bench.inputs.battery_mv = Some(4_000);
    bench.run(SECOND - 2 * TICK);
    bench.done(Request::Stop);
    bench.run(6 * TICK);
    assert_eq!(
        (bench.output.state, bench.status().cause),
        (StateName::Stopping, StopCause::BatteryLow)
    );
}

#[test]
fn an_arm_during_a_stop_holds_where_it_is() {
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    bench.done(Request::Stop);
    bench.run(4 * TICK);
    let pose = bench.output.setpoint;
    bench.done(ARM);
    assert!(
        bench
            .run(SECOND)
            .iter()
            .all(|output| output.setpoint == pose)
    );
    bench.done(play(1, 5_000_000));
    bench.until(StateName::Playing, 2 * SECOND);
}

/// A trim changes the angle of the present pulses. A stop right after it must still reach neutral in time, and hold it for half
/// a second.
#[test]
fn a_trim_does_not_stretch_the_stop_after_it() {
    for (max_angle, max_rate, trims) in [(2.8, 3.5, [5_000, -5_000]), (0.1, 0.1, [400, -550])] {
        let mut bench = Bench::new();
        bench.come_near();
        let Reply::Configuration(configuration) = bench.ask(Request::Configuration) else {
            panic!()
        };
        bench.done(Request::Configure(Configuration {
            max_angle,
            max_rate,
            ..configuration
        }));
        bench.done(ARM);
        bench.tick();
        for trim in trims {
            bench.done(Request::Trim {
                joint: Joint::Back,
                trim,
            });
            bench.run(SECOND);
        }
        bench.done(Request::Trim {
            joint: Joint::Back,
            trim: trims[0],
        });
        bench.done(Request::Stop);
        let took = bench.until(StateName::Settling, 20 * SECOND);
        let longest = f64::from(max_angle / max_rate) * 1e6 + TICK as f64;
        assert!(took as f64 <= longest, "{took} µs, {longest} allowed");
        let outputs = bench.run(SECOND / 2 - TICK);
        assert!(
            outputs
                .windows(2)
                .all(|pair| pair[0].pulses_ns == pair[1].pulses_ns),
            "still moving at neutral"
        );
    }
}

/// A trim that puts the present pulses beyond the largest angle is refused while they are on.
#[test]
fn a_trim_that_no_stop_could_undo_in_time_is_refused_while_powered() {
    let mut bench = Bench::new();
    bench.come_near();
    let Reply::Configuration(configuration) = bench.ask(Request::Configuration) else {
        panic!()
    };
    bench.done(Request::Configure(Configuration {
        max_angle: 0.1,
        max_rate: 0.1,
        ..configuration
    }));
    let trim = |trim| Request::Trim {
        joint: Joint::Front,
        trim,
    };
    bench.done(trim(-5_000));
    bench.done(ARM);
    bench.tick();
    assert_eq!(
        bench.refused(trim(5_000)),
        Refusal::WrongState(StateName::Holding)
    );
    bench.done(trim(-4_100));
    bench.done(Request::Stop);
    bench.until(StateName::Stopped, 3 * SECOND);
    bench.done(trim(5_000));
}
