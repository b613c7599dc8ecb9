//! State that survives a reset and state that does not: R6, R7 and R8's second half.

use std::time::Duration;

use host_link::Robot;
use link_protocol::{Flags, Refusal, ResetReason, StateName, StopCause};

use crate::promise::seen;
use crate::rig::{self, Port};

const MS: Duration = Duration::from_millis(1);

/// R7: whichever task hangs, the chip resets within half a second, into Stopped, without pulses, and reports the reason.
#[test]
fn a_hung_task_resets_the_board() {
    let tasks = rig::tasks(&mut rig::robot());
    assert!(tasks.len() >= 3, "{tasks:?}");
    let mut took = Vec::new();
    for task in tasks {
        // Each on a robot of its own: three resets or short runs in a row would lock arming.
        let mut robot = rig::robot();
        rig::board_of(&mut robot).set_plugged(true).unwrap();
        rig::live(&mut robot, MS * 100);
        robot.arm(false).unwrap();
        rig::live(&mut robot, MS * 100);
        let before = rig::events(&mut robot);
        assert!(before.periods.iter().any(emulator::Period::powered));
        rig::hang(&mut robot, task);
        let events = rig::events(&mut robot);
        // A task that ended is not polled any more.
        let Some(reset) = events.resets.first() else {
            robot.stop().unwrap();
            continue;
        };
        let hung = events.patch_reached.first().unwrap().at();
        let after = reset.at().checked_sub(hung).unwrap();
        assert!(after <= MS * 500, "{after:?}");
        took.push(after.as_millis());
        let later = events
            .periods
            .iter()
            .filter(|period| period.at() > reset.at());
        assert!(later.clone().count() > 0);
        assert!(
            later.clone().all(|period| !period.powered()),
            "pulses after the reset"
        );
        stopped_by_a_reset(&mut robot);
    }
    assert!(
        took.len() >= 3,
        "only {took:?} of the tasks were still alive"
    );
    let (least, most) = (took.iter().min().unwrap(), took.iter().max().unwrap());
    seen(
        &format!("R7, a hung task (each of the {} that run)", took.len()),
        &format!("reset after {least} to {most} ms, Stopped, reason `watchdog`, no pulses"),
    );
}

fn stopped_by_a_reset(robot: &mut Robot<Port>) {
    robot.reconnect().unwrap();
    assert_eq!(robot.info().reset_reason, ResetReason::Watchdog);
    let status = robot.status().unwrap();
    assert_eq!(status.state, StateName::Stopped);
    assert_eq!(status.cause, StopCause::Boot);
}

fn switch_off_and_on(robot: &mut Robot<Port>) {
    rig::board_of(robot).power_cycle().unwrap();
    rig::pass(robot, MS * 100);
    robot.reconnect().unwrap();
    assert_eq!(robot.info().reset_reason, ResetReason::PowerOn);
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
}

/// R8: three resets within 60 s lock arming until 60 s of uptime and an explicit clear.
#[test]
fn three_resets_in_a_minute_lock_arming() {
    let mut robot = rig::robot();
    for count in 0..3 {
        if count < 2 {
            robot.arm(false).unwrap();
        }
        rig::reset_by_hanging(&mut robot);
        stopped_by_a_reset(&mut robot);
    }
    let up = rig::board_of(&mut robot).now();
    let status = robot.status().unwrap();
    assert!(status.flags.contains(Flags::RESET_LOOP));
    let Refusal::ResetLoop { wait_s } = rig::refusal(robot.arm(false)) else {
        panic!("refused for another reason");
    };
    assert!((59..=60).contains(&wait_s), "{wait_s}");
    rig::pass(&mut robot, MS * 55_000);
    robot.reconnect().unwrap();
    assert!(matches!(
        rig::refusal(robot.clear_resets()),
        Refusal::ResetLoop { .. }
    ));
    rig::pass(&mut robot, MS * 5_500);
    robot.reconnect().unwrap();
    // A minute alone unlocks nothing.
    let Refusal::ResetLoop { wait_s: 0 } = rig::refusal(robot.arm(false)) else {
        panic!("refused for another reason");
    };
    robot.clear_resets().unwrap();
    robot.arm(false).unwrap();
    let waited = rig::board_of(&mut robot).now().checked_sub(up).unwrap();
    assert!(waited > MS * 60_000);
    seen(
        "R8, three resets in 60 s",
        "arming refused; a clear refused until 60 s of uptime; armed only after the clear",
    );
}

/// R6: an e-stop outlives a reset by the watchdog; a power cycle ends in Stopped.
#[test]
fn an_estop_outlives_a_reset_but_not_the_power() {
    let mut robot = rig::robot();
    robot.arm(false).unwrap();
    robot.estop().unwrap();
    rig::reset_by_hanging(&mut robot);
    robot.reconnect().unwrap();
    assert_eq!(robot.info().reset_reason, ResetReason::Watchdog);
    assert_eq!(robot.status().unwrap().state, StateName::EStopped);
    assert_eq!(rig::refusal(robot.arm(false)), Refusal::EStopped);
    robot.arm(true).unwrap();
    assert_eq!(robot.status().unwrap().state, StateName::Holding);
    robot.estop().unwrap();
    switch_off_and_on(&mut robot);
    robot.arm(false).unwrap();
    seen(
        "R6, e-stop, then a watchdog reset, then a power cycle",
        "e-stopped still, armed only after a clear with its count; Stopped after the power cycle",
    );
}

/// A reset by what is no fault: the boot ROM, once it has written the flash over USB, and a debugger after a watchdog's.
#[test]
fn a_reset_from_outside_is_no_fault_and_clears_no_estop() {
    let mut robot = rig::robot();
    for _ in 0..3 {
        long_run(&mut robot);
        rig::board_of(&mut robot).boot_rom_reset().unwrap();
        came_up_by_hand(&mut robot);
    }
    long_run(&mut robot);
    reset_by_a_fault_then_debugger(&mut robot);
    let flags = robot.status().unwrap().flags;
    assert!(!flags.contains(Flags::RESET_LOOP), "{flags:?}");
    robot.arm(false).unwrap();
    robot.estop().unwrap();
    rig::board_of(&mut robot).debugger_reset().unwrap();
    came_up_by_hand(&mut robot);
    assert_eq!(rig::refusal(robot.arm(false)), Refusal::EStopped);
    rig::board_of(&mut robot).boot_rom_reset().unwrap();
    came_up_by_hand(&mut robot);
    assert_eq!(rig::refusal(robot.arm(false)), Refusal::EStopped);
    robot.arm(true).unwrap();
    seen(
        "R8, resets by the boot ROM after writing the flash, three in 60 s, and by a debugger after one by the watchdog",
        "reason `reset pin`, no fault counted; an e-stop outlives both",
    );
}

fn reset_by_a_fault_then_debugger(robot: &mut Robot<Port>) {
    rig::reset_by_hanging(robot);
    stopped_by_a_reset(robot);
    for _ in 0..3 {
        long_run(robot);
        rig::board_of(robot).debugger_reset().unwrap();
        came_up_by_hand(robot);
    }
}

/// A run longer than the short ones, which are counted whatever ended them.
fn long_run(robot: &mut Robot<Port>) {
    rig::pass(robot, MS * 61_000);
    robot.reconnect().unwrap();
}

fn came_up_by_hand(robot: &mut Robot<Port>) {
    rig::pass(robot, MS * 300);
    robot.reconnect().unwrap();
    assert_eq!(robot.info().reset_reason, ResetReason::Pin);
}

/// R6: a reset in the middle of a play starts nothing again.
#[test]
fn a_reset_while_playing_ends_in_stopped() {
    let mut robot = rig::robot();
    let table = rig::circle(60.0);
    rig::upload(&mut robot, &table);
    rig::live(&mut robot, MS * 1000); // stored
    robot.arm(false).unwrap();
    robot.play(0, MS * 10_000, false).unwrap();
    rig::live_until(&mut robot, StateName::Playing);
    rig::events(&mut robot);
    let task = rig::tasks(&mut robot);
    let hung = task.into_iter().any(|task| {
        rig::hang(&mut robot, task);
        let events = rig::events(&mut robot);
        let reset = !events.resets.is_empty();
        if reset {
            assert!(!events.periods.last().unwrap().powered());
        }
        reset
    });
    assert!(hung);
    stopped_by_a_reset(&mut robot);
    rig::live(&mut robot, MS * 1000);
    let later = rig::events(&mut robot).periods;
    assert!(later.iter().all(|period| !period.powered()));
    assert_eq!(robot.table().unwrap().unwrap().crc32, table.crc32());
}
