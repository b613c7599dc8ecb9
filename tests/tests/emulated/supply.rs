//! R8 with a weak supply: the chip cannot distinguish a dip of it from a switch, so starts after short runs are counted, across
//! power cycles too.

use std::time::Duration;

use host_link::Robot;
use link_protocol::{Flags, Refusal, ResetReason, StateName};

use crate::promise::seen;
use crate::rig::{self, Port};

const MS: Duration = Duration::from_millis(1);

fn switched_off_and_on(robot: &mut Robot<Port>) {
    rig::board_of(robot).power_cycle().unwrap();
    rig::pass(robot, 300 * MS);
    robot.reconnect().unwrap();
    assert_eq!(robot.info().reset_reason, ResetReason::PowerOn);
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
}

#[test]
fn three_short_runs_in_a_row_lock_arming_and_say_why() {
    let mut robot = rig::robot();
    for _ in 0..2 {
        robot.arm(false).unwrap();
        rig::live(&mut robot, 500 * MS);
        switched_off_and_on(&mut robot);
    }
    robot.arm(false).unwrap();
    rig::events(&mut robot);
    rig::board_of(&mut robot).power_cycle().unwrap();
    rig::pass(&mut robot, 2500 * MS);
    let start = rig::events(&mut robot);
    assert_eq!(start.periods.iter().filter(|p| p.powered()).count(), 0);
    assert!(
        start.programmed > 0,
        "not written before the pulses could begin"
    );
    // Three blinks every two seconds.
    let blinks = start.led.iter().filter(|led| led.on).count();
    assert!((3..=6).contains(&blinks), "{blinks} blinks in 2.5 s");
    robot.reconnect().unwrap();
    let flags = robot.status().unwrap().flags;
    assert!(flags.contains(Flags::SHORT_STARTS), "{flags:?}");
    assert!(matches!(
        rig::refusal(robot.arm(false)),
        Refusal::ResetLoop { .. }
    ));
    let told = robot.crash_message().unwrap();
    assert!(told.contains("starts in a row"), "{told}");
    // After a minute it may be cleared, and the next start finds nothing.
    rig::pass(&mut robot, Duration::from_secs(61));
    robot.reconnect().unwrap();
    robot.clear_resets().unwrap();
    robot.arm(false).unwrap();
    robot.stop().unwrap();
    rig::live_until(&mut robot, StateName::Stopped);
    rig::pass(&mut robot, 500 * MS); // written while stopped
    for _ in 0..2 {
        switched_off_and_on(&mut robot);
    }
    robot.arm(false).unwrap();
    seen(
        "R8, three runs of under 60 s ended by the power",
        "written to flash before any pulse; arming refused and the message says why; cleared after 60 s, the next two starts arm",
    );
}

/// A start costs one record, and a run of a minute another: what that wears.
#[test]
fn a_start_writes_once() {
    let mut robot = rig::robot();
    rig::pass(&mut robot, Duration::from_secs(62));
    rig::events(&mut robot);
    let mut written = Vec::new();
    for _ in 0..4 {
        rig::board_of(&mut robot).power_cycle().unwrap();
        rig::pass(&mut robot, Duration::from_secs(59));
        let start = rig::events(&mut robot);
        rig::pass(&mut robot, Duration::from_secs(3));
        let minute = rig::events(&mut robot);
        written.push((
            start.programmed,
            minute.programmed,
            start.erased + minute.erased,
        ));
    }
    println!("pages programmed at a start, pages after a minute, sectors erased: {written:?}");
    assert!(written.iter().all(|(start, minute, erased)| {
        (1..=4).contains(start) && (1..=4).contains(minute) && *erased == 0
    }));
}
