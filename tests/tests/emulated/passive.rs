//! A joint without a servo on the booted image: its pin shows no edge, while the other plays as it would with two servos.

use std::time::Duration;

use emulator::{Events, Servo};
use link_protocol::{Joint, StateName};

use crate::promise::seen;
use crate::rig;

/// Arming, two cycles of a circle, and the stop after them.
fn play(passive: Option<Joint>) -> Events {
    let mut robot = rig::robot();
    robot.set_passive(passive).unwrap();
    rig::upload(&mut robot, &rig::circle(45.0));
    rig::events(&mut robot);
    robot.arm(false).unwrap();
    rig::live(&mut robot, Duration::from_millis(500));
    robot.play(2, Duration::from_secs(4), false).unwrap();
    rig::live_until(&mut robot, StateName::Playing);
    rig::live_until(&mut robot, StateName::Stopped);
    assert_eq!(robot.status().unwrap().flags.passive(), passive);
    rig::events(&mut robot)
}

/// Compare values while pulses are on.
fn pulses(events: &Events) -> Vec<[u32; 2]> {
    let powered = events.periods.iter().filter(|period| period.powered());
    powered.map(emulator::Period::compares).collect()
}

/// Promise R19.
#[test]
fn the_pin_of_a_passive_joint_stays_low() {
    let both = play(None);
    let expected = pulses(&both);
    assert!(expected.iter().flatten().all(|compare| *compare > 0));
    for (joint, silent) in [(Joint::Front, Servo::Front), (Joint::Back, Servo::Back)] {
        let one = play(Some(joint));
        let edges_of = |events: &Events, pin| {
            let edges = events.edges.iter().filter(|edge| edge.pin == pin);
            edges.count()
        };
        assert_eq!(edges_of(&one, silent), 0, "{joint:?}");
        let [front, back] = [Servo::Front, Servo::Back].map(|pin| edges_of(&one, pin));
        let compares = pulses(&one);
        assert!(front + back >= 2 * compares.len() - 1, "{front} and {back}");
        // From the first motion on: how long it holds before is the line's matter.
        let motion = |pulses: &[[u32; 2]], driven: usize| -> Vec<u32> {
            let values = pulses.iter().map(|pair| pair[driven]);
            let first = pulses[0][driven];
            values.skip_while(|value| *value == first).collect()
        };
        let driven = 1 - joint.index();
        assert_eq!(motion(&compares, driven), motion(&expected, driven));
        assert!(compares.iter().all(|pair| pair[joint.index()] == 0));
    }
    seen(
        "R19, a passive joint while the other plays two cycles",
        "no edge on its pin; on the other pin the pulses of a robot with two servos, to the step of the PWM's counter",
    );
}
