//! Crash report: the pulses end at once, and the next greeting has place and message.

use std::time::Duration;

use emulator::Board;
use host_link::Robot;
use link_protocol::{ResetReason, StateName};

use crate::promise::seen;
use crate::rig::{self, Port};

/// Flash that holds code.
const CODE: std::ops::Range<u32> = 0x1000_0100..0x1002_0000;
/// Thumb's `udf #0`: a hard fault.
const UNDEFINED: u16 = 0xde00;

/// An armed robot, and the address of code that runs whenever anything does: what polls the tasks.
fn armed() -> (Robot<Port>, u32) {
    let mut robot = rig::robot();
    robot.arm(false).unwrap();
    rig::pass(&mut robot, Duration::from_millis(100));
    let poll = symbol(board(&mut robot), "raw8Executor4poll");
    (robot, poll)
}

fn board(robot: &mut Robot<Port>) -> &mut Board {
    robot.port_mut().device_mut().board_mut()
}

/// Waits for the crash; the pulses end within a tick and a period. Returns the delay in ms, and the robot's report.
fn told_after(robot: &mut Robot<Port>) -> (u128, String) {
    rig::events(robot);
    let before = board(robot).now();
    rig::pass(robot, Duration::from_millis(300));
    let events = rig::events(robot);
    let [reset] = events.resets[..] else {
        panic!("{:?}", events.resets)
    };
    let took = reset.at().saturating_sub(before);
    assert!(took < Duration::from_millis(40), "{took:?}");
    let mut later = events.periods.iter().filter(|p| p.at() > reset.at());
    assert!(later.all(|period| !period.powered()));
    robot.reconnect().unwrap();
    let info = *robot.info();
    assert_eq!(info.reset_reason, ResetReason::Crash);
    assert!(info.crash_message);
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
    (took.as_millis(), robot.crash_message().unwrap())
}

#[test]
fn a_panic_tells_its_place_and_words() {
    let (mut robot, poll) = armed();
    let board_now = board(&mut robot);
    let target = symbol(board_now, "panic_bounds_check");
    let code = code(board_now);
    // Where an index is found out of bounds: `ldr r2, =place; bl panic_bounds_check`.
    let site = (CODE.start..)
        .step_by(2)
        .zip(code.windows(3))
        .find(|(at, words)| {
            words[0] & 0xff00 == 0x4a00 && branch_target(at + 2, words[1], words[2]) == Some(target)
        })
        .map(|(at, _)| at)
        .expect("a place that checks an index");
    for (half, word) in (0..).zip(branch(poll, site)) {
        board_now.patch(poll + 2 * half, word).unwrap();
    }
    let (ms, message) = told_after(&mut robot);
    println!("a panic: {message}");
    let (place, words) = message.split_once(": ").unwrap();
    let (file, line) = place.rsplit_once(':').unwrap();
    assert!(
        file.contains(".rs") && line.parse::<u32>().is_ok(),
        "{message}"
    );
    assert!(words.starts_with("index out of bounds"), "{message}");
    seen(
        "R7, a panic",
        &format!(
            "reset after {ms} ms, Stopped, no pulses, reason `crash`; file, line and words are told"
        ),
    );
    // Told for this start alone.
    board(&mut robot).pin_reset().unwrap();
    rig::pass(&mut robot, Duration::from_millis(300));
    robot.reconnect().unwrap();
    assert!(!robot.info().crash_message);
    assert_eq!(robot.info().reset_reason, ResetReason::Pin);
}

#[test]
fn a_hard_fault_tells_its_address() {
    let (mut robot, poll) = armed();
    board(&mut robot).patch(poll, UNDEFINED).unwrap();
    let (ms, message) = told_after(&mut robot);
    println!("a hard fault: {message}");
    let expected = format!("hard fault at {poll:#010x}, called from 0x");
    assert!(message.starts_with(&expected), "{message}, not {expected}");
    seen(
        "R7, a hard fault",
        &format!("reset after {ms} ms, Stopped, no pulses, reason `crash`; the address is told"),
    );
    // Power leaves noise where the message was.
    board(&mut robot).power_cycle().unwrap();
    rig::pass(&mut robot, Duration::from_millis(300));
    robot.reconnect().unwrap();
    assert!(!robot.info().crash_message);
    assert_eq!(robot.crash_message().unwrap(), "");
}

/// The watchdog under a debugger and the guard below the stack, by their registers. Their effect on silicon is untested.
#[test]
fn the_watchdog_runs_under_a_debugger_and_the_stack_has_a_guard() {
    const WATCHDOG_CTRL: u32 = 0x4005_8000;
    const MPU_CTRL: u32 = 0xe000_ed94;
    let mut board = rig::board(rig::Image::Nano);
    board.run(Duration::from_millis(100)).unwrap();
    let mut word = |address: u32| {
        let bytes = board.peek(address, 4).unwrap();
        u32::from_le_bytes(bytes.try_into().unwrap())
    };
    let control = word(WATCHDOG_CTRL);
    assert_eq!(control >> 30 & 1, 1, "enabled");
    assert_eq!(
        control >> 24 & 7,
        0,
        "paused by a debugger: {control:#010x}"
    );
    let [control, _, base, size] = [0, 4, 8, 12].map(|offset| word(MPU_CTRL + offset));
    assert_eq!(
        control, 5,
        "on, the default map elsewhere, off in a hard fault"
    );
    let bytes = 2_u64 << (size >> 1 & 31);
    let below = u64::from(base & !0xff) + bytes;
    assert_eq!((size & 1, size >> 24 & 7), (1, 0), "enabled, no access");
    assert_eq!(below, 0x2000_0000, "up to the stack's first byte");
    assert!(bytes >= 28 * 1024, "no frame reaches past it");
    seen(
        "watchdog and MPU, by their registers (untested on a board)",
        "the watchdog's timer runs while a debugger halts the core; no access to the 32 KiB below the stack",
    );
}

/// A stack that grows for ever meets the guard: no variable changes, and the watchdog ends it.
#[test]
fn a_stack_overflow_is_reset_and_changes_no_variable() {
    /// `push {r0-r7, lr}`, and a branch back to it.
    const PUSH_FOR_EVER: [u16; 2] = [0xb5ff, 0xe7fd];
    let (mut robot, poll) = armed();
    robot.estop().unwrap();
    rig::pass(&mut robot, Duration::from_millis(100));
    rig::events(&mut robot);
    let before = board(&mut robot).now();
    for (half, word) in (0..).zip(PUSH_FOR_EVER) {
        board(&mut robot).patch(poll + 2 * half, word).unwrap();
    }
    rig::pass(&mut robot, Duration::from_millis(600));
    let events = rig::events(&mut robot);
    let [reset] = events.resets[..] else {
        panic!("{:?}", events.resets)
    };
    let took = reset.at().saturating_sub(before);
    assert!(took <= Duration::from_millis(500), "{took:?}");
    robot.reconnect().unwrap();
    let reason = robot.info().reset_reason;
    assert!(
        matches!(reason, ResetReason::Watchdog | ResetReason::Crash),
        "{reason:?}"
    );
    // Kept in RAM just above the stack.
    assert_eq!(robot.status().unwrap().state, StateName::EStopped);
    seen(
        "R7, a stack that overflows while e-stopped",
        &format!(
            "reset after {} ms, reason `{reason:?}`, e-stopped still",
            took.as_millis()
        ),
    );
}

/// R6, for the pin that the chip's own registers do not outlive: pressing reset clears no e-stop, power does.
#[test]
fn an_estop_outlives_the_reset_pin() {
    let (mut robot, _) = armed();
    robot.estop().unwrap();
    rig::pass(&mut robot, Duration::from_millis(100));
    for _ in 0..2 {
        board(&mut robot).pin_reset().unwrap();
        rig::pass(&mut robot, Duration::from_millis(300));
        robot.reconnect().unwrap();
        assert_eq!(robot.info().reset_reason, ResetReason::Pin);
        assert_eq!(robot.status().unwrap().state, StateName::EStopped);
        assert!(robot.arm(false).is_err());
    }
    board(&mut robot).power_cycle().unwrap();
    rig::pass(&mut robot, Duration::from_millis(300));
    robot.reconnect().unwrap();
    assert_eq!(robot.info().reset_reason, ResetReason::PowerOn);
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
    seen(
        "R6, e-stop, then the reset pin twice, then a power cycle",
        "e-stopped still; Stopped after the power cycle",
    );
}

fn symbol(board: &mut Board, name: &str) -> u32 {
    let found = board.symbols(name).unwrap();
    *found.values().next().unwrap_or_else(|| panic!("no {name}")) & !1
}

/// The code, in half words.
fn code(board: &mut Board) -> Vec<u16> {
    let bytes = board.peek(CODE.start, CODE.end - CODE.start).unwrap();
    bytes
        .chunks_exact(2)
        .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
        .collect()
}

/// Target of Thumb's `bl` at this address.
fn branch_target(at: u32, first: u16, second: u16) -> Option<u32> {
    if first & 0xf800 != 0xf000 || second & 0xd000 != 0xd000 {
        return None;
    }
    let bit = |word: u16, place: u32| i32::from(word >> place & 1);
    let sign = bit(first, 10);
    let high = |j: i32| 1 - (j ^ sign);
    let offset = -sign << 24
        | high(bit(second, 13)) << 23
        | high(bit(second, 11)) << 22
        | i32::from(first & 0x3ff) << 12
        | i32::from(second & 0x7ff) << 1;
    Some((at + 4).wrapping_add_signed(offset))
}

/// Thumb's `bl` from one address to another.
fn branch(from: u32, to: u32) -> [u16; 2] {
    let offset = to.wrapping_sub(from + 4);
    let bit = |place: u32| (offset >> place & 1) as u16;
    let sign = bit(24);
    let low = |place: u32| 1 - (bit(place) ^ sign);
    let first = 0xf000 | sign << 10 | (offset >> 12 & 0x3ff) as u16;
    let second = 0xd000 | low(23) << 13 | low(22) << 11 | (offset >> 1 & 0x7ff) as u16;
    [first, second]
}
