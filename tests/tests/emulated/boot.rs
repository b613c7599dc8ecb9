//! From power to the first answer, and what a reset leaves.

use std::time::Duration;

use host_link::Port as _;
use link_protocol::{Board, ResetReason, StateName};

use crate::rig;

/// Power to the answered greeting: under 200 ms.
#[test]
fn a_board_answers_hello_soon_after_power() {
    let Some(port) = rig::port() else { return };
    let robot = host_link::Robot::connect(port, 1).unwrap();
    let took = robot.port().now();
    println!("boot to Hello's answer: {} ms", took.as_millis());
    assert!(took < Duration::from_millis(200), "{took:?}");
    let info = robot.info();
    assert_eq!(info.board, Board::NanoRp2040Connect);
    assert_eq!(info.reset_reason, ResetReason::PowerOn);
}

/// R7: whichever task hangs, the chip resets within half a second, into Stopped, without pulses, with the reason told.
#[test]
fn a_hung_task_resets_the_board() {
    let Some(mut robot) = rig::robot() else {
        return;
    };
    let board = robot.port_mut().device_mut().board_mut();
    let tasks = board.symbols("TaskStorage").unwrap();
    let polls: Vec<u32> = tasks
        .into_iter()
        .filter_map(|(name, address)| name.contains("4poll").then_some(address))
        .collect();
    assert!(polls.len() >= 3, "{polls:?}");
    let mut hung = 0;
    for poll in polls {
        robot.arm(false).unwrap();
        rig::pass(&mut robot, Duration::from_millis(100));
        assert!(
            rig::events(&mut robot)
                .periods
                .iter()
                .any(emulator::Period::powered)
        );
        let board = robot.port_mut().device_mut().board_mut();
        let before = board.now();
        board.patch(poll, BRANCH_TO_ITSELF).unwrap();
        robot.port_mut().write(&[0; 4]).unwrap(); // something to do for a task that waits for bytes
        rig::pass(&mut robot, Duration::from_secs(1));
        let events = rig::events(&mut robot);
        let Some(reset) = events.resets.first() else {
            println!("{poll:#x} is not polled any more: a task that ended");
            robot.stop().unwrap();
            continue;
        };
        hung += 1;
        let after = reset.at().checked_sub(before).unwrap();
        println!(
            "task at {poll:#x} hung: reset after {} ms",
            after.as_millis()
        );
        assert!(after <= Duration::from_millis(500), "{after:?}");
        let later = events
            .periods
            .iter()
            .filter(|period| period.at() > reset.at());
        assert!(later.clone().count() > 0);
        assert!(
            later.clone().all(|period| !period.powered()),
            "pulses after the reset"
        );
        robot.reconnect().unwrap();
        assert_eq!(robot.info().reset_reason, ResetReason::Watchdog);
        assert_eq!(robot.status().unwrap().state, StateName::Stopped);
        // R8: three resets in 60 s would latch; a clear is an explicit act.
        rig::pass(&mut robot, Duration::from_secs(61));
        robot.reconnect().unwrap();
        robot.clear_resets().unwrap();
    }
    assert!(hung >= 3, "only {hung} tasks were still alive");
}

/// Thumb's `b .`
const BRANCH_TO_ITSELF: u16 = 0xe7fe;
