//! Somebody at the robot: the jumper on both boards, the BOOTSEL button of the Pico.

use std::time::Duration;

use emulator::{Board, EmulatorError};
use link_protocol::{Flags, Key, Refusal};

use crate::promise::seen;
use crate::rig::{self, Image};

const MS: Duration = Duration::from_millis(1);

type Hand = fn(&mut Board, bool) -> Result<(), EmulatorError>;

/// A first key is accepted only with a person at the robot.
#[test]
fn jumper_and_button_open_the_bench_window() {
    let ways: [(Image, Hand); 3] = [
        (Image::Nano, Board::set_jumper),
        (Image::Pico, Board::set_jumper),
        (Image::Pico, Board::set_button),
    ];
    for (image, hand) in ways {
        let mut robot = rig::robot_of(image);
        let key = Some(Key(*b"sixteen letters!"));
        assert_eq!(rig::refusal(robot.set_key(key)), Refusal::NeedsPresence);
        hand(rig::board_of(&mut robot), true).unwrap();
        rig::live(&mut robot, 300 * MS);
        hand(rig::board_of(&mut robot), false).unwrap();
        rig::events(&mut robot);
        rig::live(&mut robot, 2000 * MS);
        assert!(robot.status().unwrap().flags.contains(Flags::PRESENT));
        // The LED is on, and dark for a moment each second.
        let led = rig::events(&mut robot).led;
        assert!((2..=5).contains(&led.len()), "{led:?}");
        // Two minutes, and it is closed again.
        rig::pass(&mut robot, Duration::from_secs(119));
        robot.reconnect().unwrap();
        assert_eq!(rig::refusal(robot.set_key(key)), Refusal::NeedsPresence);
        hand(rig::board_of(&mut robot), true).unwrap();
        rig::live(&mut robot, 300 * MS);
        robot.set_key(key).unwrap();
    }
    seen(
        "presence: jumper at GPIO5 (both boards), BOOTSEL (Pico)",
        "a first key refused without, taken within the window, refused again after two minutes",
    );
}

/// The Nano has no such button, and the Pico's is not looked at while pulses are on: it would hold flash reads up.
#[test]
fn the_button_counts_on_a_pico_that_is_stopped() {
    for (image, armed) in [(Image::Nano, false), (Image::Pico, true)] {
        let mut robot = rig::robot_of(image);
        if armed {
            robot.arm(false).unwrap();
            rig::live(&mut robot, 200 * MS);
        }
        rig::board_of(&mut robot).set_button(true).unwrap();
        rig::live(&mut robot, 500 * MS);
        let flags = robot.status().unwrap().flags;
        assert!(!flags.contains(Flags::PRESENT), "{image:?}: {flags:?}");
    }
}
