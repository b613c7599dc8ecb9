//! A joint without a servo: its output stays low from the request on, in every state, over restarts, until a person at the robot
//! drives it again.
use crate::bench;

use bench::*;
use gait_player::storage::MemoryStorage;
use gait_player::{Brain, Limits, Output, Transport};
use link_protocol::*;

const PASSIVE: Request = Request::SetPassive(Some(Joint::Back));

/// Stop, hold, soft start, two cycles, pause, stop and e-stop.
fn drive(bench: &mut Bench) -> Vec<Output> {
    let mut outputs = Vec::new();
    bench.upload(&circle(1.0));
    bench.done(ARM);
    outputs.extend(bench.run(SECOND));
    bench.done(play(2, 4_000_000));
    outputs.extend(bench.run(5 * SECOND));
    bench.done(Request::Pause { detached: false });
    outputs.extend(bench.run(SECOND));
    bench.done(Request::Resume);
    outputs.extend(bench.run(8 * SECOND));
    assert_eq!(bench.output.state, StateName::Stopped);
    bench.done(ARM);
    outputs.extend(bench.run(SECOND));
    bench.done(Request::Stop);
    outputs.extend(bench.run(2 * SECOND));
    bench.done(ARM);
    outputs.extend(bench.run(SECOND));
    bench.done(Request::EStop);
    outputs.extend(bench.run(SECOND));
    outputs
}

/// The driven joint gets the pulses of a robot with two servos, and the set-points, states and odometer are the same.
#[test]
fn the_other_joint_plays_as_ever() {
    for joint in [Joint::Front, Joint::Back] {
        let (mut with_two, mut with_one) = (Bench::new(), Bench::new());
        with_one.done(Request::SetPassive(Some(joint)));
        with_two.done(Request::SetPassive(None));
        let both = drive(&mut with_two);
        let one = drive(&mut with_one);
        assert_eq!(both.len(), one.len());
        let mut powered = 0;
        for (both, one) in both.iter().zip(&one) {
            let expected = both.pulses_ns.map(|mut pulses| {
                powered += 1;
                let window = Limits::ROBOT.pulse_min_ns..=Limits::ROBOT.pulse_max_ns;
                assert!(pulses.iter().all(|pulse| window.contains(pulse)));
                pulses[joint.index()] = 0;
                pulses
            });
            assert_eq!(one.pulses_ns, expected, "{:?}", one.state);
            assert_eq!((one.state, one.setpoint), (both.state, both.setpoint));
        }
        assert!(powered > 600, "{powered}");
        let told = |bench: &Bench| {
            let telemetry = bench.telemetry.iter().rfind(|at| at.pulse_ns != [0; 2]);
            *telemetry.unwrap()
        };
        let (two, one) = (told(&with_two), told(&with_one));
        assert_eq!(two.flags.passive(), None);
        assert_eq!(one.flags.passive(), Some(joint));
        assert_eq!(one.pulse_ns[joint.index()], 0);
        assert_eq!((one.pose, one.setpoint), (two.pose, two.setpoint));
    }
}

#[test]
fn only_a_person_at_the_robot_drives_it_again() {
    let mut bench = Bench::new();
    bench.done(PASSIVE);
    // To repeat it, and to ask for another joint.
    bench.done(PASSIVE);
    for wider in [None, Some(Joint::Front)] {
        let refusal = bench.refused(Request::SetPassive(wider));
        assert_eq!(refusal, Refusal::NeedsPresence);
    }
    bench.done(ARM);
    bench.run(SECOND);
    let pulses = bench.output.pulses_ns.unwrap();
    assert!(pulses[0] > 0 && pulses[1] == 0, "{pulses:?}");
    // Not while the pulses are on, with presence either.
    bench.come_near();
    let refusal = bench.refused(Request::SetPassive(None));
    assert_eq!(refusal, Refusal::WrongState(StateName::Holding));
    bench.done(Request::Stop);
    bench.until(StateName::Stopped, 2 * SECOND);
    bench.done(Request::SetPassive(None));
    assert_eq!(bench.status().flags.passive(), None);
    bench.done(ARM);
    bench.run(SECOND);
    assert!(
        bench
            .output
            .pulses_ns
            .unwrap()
            .iter()
            .all(|pulse| *pulse > 0)
    );
}

#[test]
fn a_silent_host_does_not_change_it() {
    let mut bench = Bench::with(config());
    bench.via = Transport::Usb;
    bench.greet(1);
    bench.keep_alive = false;
    bench.run(10 * SECOND);
    assert_eq!(bench.refused(PASSIVE), Refusal::NotFresh);
}

/// Promise R17: a play that was checked for two servos is refused.
#[test]
fn a_play_that_was_checked_for_two_servos_is_refused() {
    let mut bench = Bench::new();
    bench.upload(&circle(1.0));
    let before = bench.brain.held();
    bench.done(PASSIVE);
    let held = bench.brain.held();
    bench.done(ARM);
    let refusal = bench.refused(Request::Play(Play {
        cycles: 1,
        period_us: 4_000_000,
        detached: false,
        checked: before,
    }));
    let settings = held.settings_crc32;
    assert_eq!(refusal, Refusal::OtherSettings { held: settings });
    bench.done(play(1, 4_000_000));
}

#[test]
fn it_is_stored() {
    let mut bench = Bench::new();
    bench.done(PASSIVE);
    let held = bench.brain.held();
    let mut flash = MemoryStorage::erased();
    for _ in 0..20 {
        bench.tick();
        bench.brain.serve_storage(bench.now_us, &mut flash).unwrap();
    }
    let mut brain = Brain::new(config());
    brain.load(&mut flash).unwrap();
    let mut bench = Bench::around(brain);
    bench.greet(2);
    let status = bench.status();
    assert_eq!(status.flags.passive(), Some(Joint::Back));
    assert!(!status.flags.contains(Flags::STORAGE_FAILED));
    assert_eq!(bench.brain.held(), held);
    bench.done(ARM);
    bench.run(SECOND);
    assert_eq!(bench.output.pulses_ns.unwrap()[1], 0);
}
