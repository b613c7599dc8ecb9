//! R15 for an hour: no drift of the period, no missed tick, no growing stack.

use std::time::Duration;

use gait_player::servo::ServoMap;
use gait_player::{GaitTable, TICK_US};
use link_protocol::StateName;

use crate::promise::{seen, seen_in_soak};
use crate::rig;

const PERIOD_US: u32 = 10_000_000;
/// The PWM's counter, in ns.
const STEP_NS: u32 = 320;

#[test]
#[ignore = "an hour of play on the emulated board: about a quarter of an hour"]
fn an_hour_of_play_keeps_time() {
    plays_in_time(360, seen_in_soak);
}

#[test]
fn half_a_minute_of_play_keeps_time() {
    plays_in_time(3, seen);
}

/// A detached play: the board needs nobody, so it runs on its own.
fn plays_in_time(cycles: u32, tell: fn(&str, &str)) {
    let mut robot = rig::robot();
    let table = rig::circle(70.0);
    rig::upload(&mut robot, &table);
    rig::live(&mut robot, Duration::from_secs(2)); // stored: erasing flash would make ticks late
    let late = robot.counters().unwrap().late_ticks;
    robot.arm(false).unwrap();
    robot
        .play(cycles, Duration::from_micros(PERIOD_US.into()), true)
        .unwrap();
    rig::events(&mut robot);
    let board = rig::board_of(&mut robot);
    let start = board.now();
    let (mut counts, mut at) = (Vec::new(), Vec::new());
    for minute in 0..=cycles / 6 {
        board
            .run(start + Duration::from_mins(u64::from(minute) + 1))
            .unwrap();
        let events = board.take_events();
        assert!(
            events.resets.is_empty() && events.lost == 0,
            "{:?}",
            events.resets
        );
        for period in events.periods.iter().filter(|period| period.powered()) {
            counts.push(period.compares());
            at.push(period.at());
        }
        if minute % 6 == 5 {
            let (ticks, drift) = (at.len(), drift(&at).as_secs_f64() * 1e6);
            let stack = board.stack().unwrap().used();
            println!("{ticks} periods: drift {drift:.2} µs, deepest stack {stack} bytes, no reset");
        }
    }
    let stack = board.stack().unwrap();

    let drift = drift(&at);
    // Every tick of every cycle, in its place.
    let expected = expected(&table, cycles);
    let begin = counts
        .windows(expected.len())
        .position(|window| window == expected);
    assert!(
        begin.is_some(),
        "the pulses are not those of {cycles} cycles"
    );

    let now = rig::board_of(&mut robot).now();
    let behind = now.saturating_sub(host_link::Port::now(robot.port()));
    rig::pass(&mut robot, behind);
    robot.reconnect().unwrap();
    assert_eq!(robot.status().unwrap().state, StateName::Stopped);
    let late = robot.counters().unwrap().late_ticks - late;
    assert_eq!(late, 0);
    tell(
        &format!(
            "R15, {cycles} cycles of 10 s played detached ({} ticks)",
            expected.len()
        ),
        &format!(
            "every pulse the table's, to the counter's step; drift of the period {:.2} µs; deepest stack {} of {} bytes; \
             no late tick",
            drift.as_secs_f64() * 1e6,
            stack.used(),
            stack.size
        ),
    );
}

/// Every period is 20 ms after the one before: counted from the first, how far is any from where it should be?
fn drift(at: &[Duration]) -> Duration {
    let tick = Duration::from_micros(u64::from(TICK_US));
    let off = |(number, time): (usize, &Duration)| {
        (at[0] + tick * u32::try_from(number).unwrap()).abs_diff(*time)
    };
    let drift = at.iter().enumerate().map(off).max().unwrap();
    assert!(drift < Duration::from_micros(1), "{drift:?}");
    drift
}

fn expected(table: &GaitTable, cycles: u32) -> Vec<[u32; 2]> {
    let tick = |tick: u32| {
        let shape = table.at(table.phase(tick * TICK_US % PERIOD_US, PERIOD_US));
        shape
            .angles
            .map(|angle| (ServoMap::ROBOT.pulse_ns(angle) + STEP_NS / 2) / STEP_NS)
    };
    (0..PERIOD_US / TICK_US)
        .map(tick)
        .collect::<Vec<_>>()
        .repeat(cycles as usize)
}
