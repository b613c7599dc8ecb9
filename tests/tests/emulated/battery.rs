//! R8's first half: a low battery, measured by the chip's own ADC behind the divider that the image was built for.

use std::time::Duration;

use host_link::Robot;
use link_protocol::{Flags, Refusal, StateName, StopCause};

use crate::promise::seen;
use crate::rig::{self, Image, Port};

const MS: Duration = Duration::from_millis(1);

fn set_pack(robot: &mut Robot<Port>, volts: f64) {
    rig::set_pack(rig::board_of(robot), volts);
}

#[test]
fn a_low_battery_stops_the_robot_and_five_good_seconds_let_it_go_on() {
    let mut robot = rig::robot_of(Image::NanoDivider);
    let full = robot.status().unwrap();
    let measured = full.battery_mv.unwrap();
    assert!(measured.abs_diff(5000) <= 5, "{measured} mV for 5 V");
    assert!(!full.flags.contains(Flags::BATTERY_LOW));
    rig::upload(&mut robot, &rig::circle(60.0));
    robot.arm(false).unwrap();
    robot.play(0, MS * 10_000, false).unwrap();
    rig::live_until(&mut robot, StateName::Playing);

    // A sag of less than a second is flagged and stops nothing.
    set_pack(&mut robot, 4.3);
    rig::live(&mut robot, MS * 900);
    let sagged = robot.status().unwrap();
    assert!(sagged.flags.contains(Flags::BATTERY_LOW));
    assert_eq!(sagged.state, StateName::Playing);
    set_pack(&mut robot, 5.0);
    rig::live(&mut robot, MS * 100);
    let well = robot.status().unwrap();
    assert!(!well.flags.contains(Flags::BATTERY_LOW));
    assert_eq!(well.state, StateName::Playing);
    // A minute without one forgets it: dips closer together add up.
    rig::live(&mut robot, MS * 60_000);

    // One of a second stops.
    rig::events(&mut robot);
    let low = host_link::Port::now(robot.port());
    set_pack(&mut robot, 4.3);
    rig::live_until(&mut robot, StateName::Stopped);
    assert_eq!(robot.status().unwrap().cause, StopCause::BatteryLow);
    let periods = rig::events(&mut robot).periods;
    let ramp = rig::ramp_begins(&periods).checked_sub(low).unwrap();
    // Seen at the next tick, which counts for the 20 ms before it; a second counted, the tick after where that one came a
    // microsecond early, latched at the wrap.
    assert!(
        ramp >= MS * (1000 - 20) && ramp <= MS * (1000 + 3 * 20),
        "{ramp:?}"
    );

    // Latched: a voltage that comes back resumes nothing, and arming waits for five seconds of it.
    assert!(matches!(
        rig::refusal(robot.arm(false)),
        Refusal::BatteryLow { limit_mv: 4400, .. }
    ));
    set_pack(&mut robot, 5.0);
    rig::live(&mut robot, MS * 4900);
    assert!(matches!(
        rig::refusal(robot.arm(false)),
        Refusal::BatteryLow { .. }
    ));
    rig::live(&mut robot, MS * 200);
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
    robot.arm(false).unwrap();
    seen(
        "R8, pack at 4.3 V while playing",
        &format!(
            "flagged; 0.9 s of it stop nothing and are forgotten after a minute at 5.0 V; after 1 s the ramp begins ({} ms \
             at the pins); arming refused until 5 s at 5.0 V; measured to {} mV",
            ramp.as_millis(),
            measured.abs_diff(5000)
        ),
    );
}

/// A tired pack recovers between two strokes: dips of 40 ms, a hundred times shorter than the stroke, stop the robot too.
#[test]
fn a_pack_that_dips_on_every_stroke_stops_the_robot() {
    let mut robot = rig::robot_of(Image::NanoDivider);
    rig::upload(&mut robot, &rig::circle(60.0));
    robot.arm(false).unwrap();
    robot.play(0, MS * 8_000, false).unwrap();
    rig::live_until(&mut robot, StateName::Playing);
    let mut strokes = 0;
    while robot.status().unwrap().state == StateName::Playing {
        set_pack(&mut robot, 4.3);
        rig::live(&mut robot, MS * 40);
        set_pack(&mut robot, 5.0);
        rig::live(&mut robot, MS * 3_960);
        strokes += 1;
        assert!(strokes <= 26, "dips are forgotten");
    }
    assert_eq!(robot.status().unwrap().cause, StopCause::BatteryLow);
    assert!(
        strokes >= 16,
        "a second in all is two or three ticks of each dip"
    );
    seen(
        "R8, pack that dips to 4.3 V for 40 ms every 4 s",
        &format!("stopped at dip {strokes}"),
    );
}

/// A sag shorter than a tick is seen by one of its twenty samples.
#[test]
fn a_sag_of_three_milliseconds_is_measured() {
    let mut robot = rig::robot_of(Image::NanoDivider);
    robot.arm(false).unwrap();
    // Telemetry covers every second tick: of two sags 20 ms apart it shows one.
    let (lows, lowest) = std::sync::mpsc::channel();
    robot.observe(Box::new(move |telemetry, _| {
        let _ = lows.send(telemetry.battery_mv.unwrap_or(u16::MAX));
    }));
    rig::live(&mut robot, MS * 100);
    for _ in 0..2 {
        set_pack(&mut robot, 4.3);
        rig::live(&mut robot, MS * 3);
        set_pack(&mut robot, 5.0);
        rig::live(&mut robot, MS * 17);
    }
    rig::live(&mut robot, MS * 100);
    let told: Vec<u16> = lowest.try_iter().collect();
    let low = told.iter().filter(|mv| **mv < 4400).count();
    assert!(low >= 1 && low < told.len(), "{told:?}");
}

/// Without a divider the pin says nothing: not measured, never low.
#[test]
fn without_a_divider_the_battery_is_not_measured() {
    let mut robot = rig::robot();
    set_pack(&mut robot, 0.0);
    rig::live(&mut robot, MS * 1500);
    let status = robot.status().unwrap();
    assert_eq!(status.battery_mv, None);
    assert!(!status.flags.contains(Flags::BATTERY_LOW));
    robot.arm(false).unwrap();
}
