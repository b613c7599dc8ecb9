//! R11 and R13: how long the chip is busy in a servo period, whatever else is asked of it meanwhile; how deep its stack gets.

use std::ops::ControlFlow;
use std::time::Duration;

use emulator::Period;
use host_link::session::UploadPhase;
use link_protocol::{Flags, StateName};

use crate::promise::seen;
use crate::rig;

/// Longest time awake in a period \[ms\].
fn busiest(periods: &[Period]) -> f64 {
    periods.iter().map(Period::busy_ms).fold(0.0, f64::max)
}

#[test]
fn no_period_is_busier_than_two_milliseconds_while_pulses_are_on() {
    let Some(mut robot) = rig::robot() else {
        return;
    };
    rig::upload(&mut robot, &rig::circle(60.0));
    let stopped = busiest(&rig::events(&mut robot).periods);
    assert!(
        stopped <= 20.0,
        "a check that takes more than a tick: {stopped}"
    );
    robot.arm(false).unwrap();
    rig::events(&mut robot);
    robot.play(0, Duration::from_secs(10), false).unwrap();
    rig::live_until(&mut robot, StateName::Playing);
    let way = busiest(&rig::events(&mut robot).periods);
    rig::live(&mut robot, Duration::from_secs(10));
    let playing = busiest(&rig::events(&mut robot).periods);

    // 512 more knots come while the others play: first nearly all, then the rest and the request to check them.
    let table = rig::circle(50.0);
    let patience = Duration::from_mins(1);
    let _ = robot.upload(table.bytes(), patience, |progress| {
        if progress.phase == UploadPhase::Chunks && progress.done + 200 > progress.total {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    let arriving = busiest(&rig::events(&mut robot).periods);
    robot
        .upload(table.bytes(), patience, |_| ControlFlow::Continue(()))
        .unwrap();
    let status = robot.status().unwrap();
    assert_eq!(status.state, StateName::Playing);
    assert!(status.flags.contains(Flags::SWAP_PENDING));
    let checking = rig::events(&mut robot);
    let ticks = checking.periods.len();
    let checking = busiest(&checking.periods);

    for busy in [way, playing, arriving, checking] {
        assert!(
            busy > 0.5 && busy <= 2.0,
            "{way} {playing} {arriving} {checking}"
        );
    }
    seen(
        "R11, busiest servo period at 125 MHz, everything counted (tick, UART, telemetry)",
        &format!(
            "{playing:.2} ms while playing, {way:.2} ms while the way to the first knot is checked, {arriving:.2} ms while \
             512 more knots arrive, {checking:.2} ms while they are checked (which takes {ticks} ticks); {stopped:.0} ms \
             while a table is checked with pulses off"
        ),
    );
    let stack = rig::board_of(&mut robot).stack().unwrap();
    assert!(stack.left >= 1024, "{stack:?}");
    seen(
        "R13, deepest stack in that session (painted at power-up)",
        &format!("{} of {} bytes", stack.used(), stack.size),
    );
}
