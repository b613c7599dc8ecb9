//! From power to the first answer, on both boards.

use std::time::Duration;

use link_protocol::{Board, ResetReason, StateName};

use crate::promise::seen;
use crate::rig::{self, Image};

/// Power to the answered greeting: under 200 ms.
#[test]
fn a_board_answers_hello_soon_after_power() {
    for (image, name, board) in [
        (Image::Nano, "Nano", Board::NanoRp2040Connect),
        (Image::Pico, "Pico", Board::Pico),
    ] {
        let port = rig::port(image);
        let mut robot = host_link::Robot::connect(port, 1).unwrap();
        let took = host_link::Port::now(robot.port());
        assert!(took < Duration::from_millis(200), "{name}: {took:?}");
        let info = robot.info();
        assert_eq!(info.board, board);
        assert_eq!(info.reset_reason, ResetReason::PowerOn);
        assert_eq!(robot.status().unwrap().state, StateName::Stopped);
        seen(
            &format!("power to the answered greeting, {name}"),
            &format!("{} ms, Stopped, reason `power on`", took.as_millis()),
        );
    }
}

/// The Pico's pins and clock: what differs between the boards is only wiring.
#[test]
fn the_pico_pulses_and_keeps_silent_like_the_nano() {
    let mut robot = rig::robot_of(Image::Pico);
    robot.arm(false).unwrap();
    rig::live(&mut robot, Duration::from_millis(200));
    let events = rig::events(&mut robot);
    let powered = events.periods.iter().filter(|period| period.powered());
    assert!(powered.clone().count() >= 8);
    for period in powered {
        assert!((period.length_us() - 20_000.0).abs() < 1e-9);
        assert!(rig::angles(period).iter().all(|angle| angle.abs() < 5e-3));
    }
    // Held, the LED is lit: on the Pico's pin, too.
    assert!(events.led.last().is_some_and(|led| led.on));
    rig::board_of(&mut robot).set_connected(false).unwrap();
    rig::pass(&mut robot, Duration::from_millis(20));
    let mut bytes = [0; 4096];
    let mut sent = || host_link::Port::read(robot.port_mut(), &mut bytes, Duration::ZERO).unwrap();
    sent();
    let silent = sent();
    rig::pass(&mut robot, Duration::from_millis(300));
    let mut bytes = [0; 4096];
    let later = host_link::Port::read(robot.port_mut(), &mut bytes, Duration::ZERO).unwrap();
    assert_eq!((silent, later), (0, 0), "bytes to an unconnected radio");
}
