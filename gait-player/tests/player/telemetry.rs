//! LED, telemetry and counters of the robot.
use crate::bench;

use bench::stops::*;
use bench::*;
use gait_player::Transport;
use link_protocol::*;

/// Durations \[ticks\] of the LED's on and off phases, from the next change on.
fn blinks(bench: &mut Bench, turns: usize) -> Vec<(bool, usize)> {
    let mut runs: Vec<(bool, usize)> = Vec::new();
    for output in bench.run(20 * SECOND) {
        match runs.last_mut() {
            Some((on, ticks)) if *on == output.led => *ticks += 1,
            _ => runs.push((output.led, 1)),
        }
    }
    // The first and the last phase are incomplete.
    runs.pop();
    runs.into_iter().skip(1).take(turns).collect()
}

/// Compares phases with a pattern \[ticks on, off, on, …\], at any offset.
fn assert_pattern(told: &[(bool, usize)], pattern: &[usize]) {
    let turned = (0..pattern.len()).step_by(2).any(|turn| {
        let expected = (0..).map(|at| {
            let at = at + turn + usize::from(!told[0].0);
            (at % 2 == 0, pattern[at % pattern.len()])
        });
        told.iter().copied().eq(expected.take(told.len()))
    });
    assert!(told.len() >= pattern.len() && turned, "{told:?}");
}

#[test]
fn the_led_tells_the_states_apart() {
    let mut bench = Bench::new();
    // Stopped: 60 ms every two seconds.
    assert_pattern(&blinks(&mut bench, 8), &[3, 97]);
    // With a low battery: two blinks per second.
    bench.inputs.battery_mv = Some(4_000);
    bench.run(6 * SECOND);
    assert_pattern(&blinks(&mut bench, 16), &[5, 5, 5, 35]);
    // E-stopped: fast, regardless of the battery.
    bench.done(Request::EStop);
    bench.run(SECOND);
    assert_pattern(&blinks(&mut bench, 20), &[5, 5]);
    // Pulses on: on.
    let mut bench = Bench::new();
    bench.done(ARM);
    bench.tick();
    assert!(bench.run(3 * SECOND).iter().all(|output| output.led));
    // Playing: dark except for the flash of 100 ms at a cycle's start.
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    assert_pattern(&blinks(&mut bench, 6), &[5, 245]);
}

#[test]
fn a_cycle_flashes_at_its_start_and_in_no_other_state() {
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    assert!(bench.output.cycle_flash);
    bench.tick();
    bench.done(Request::Pause { detached: false });
    let paused = bench.run(SECOND);
    assert!(
        paused
            .iter()
            .all(|output| !output.cycle_flash && output.led)
    );
    assert!(!bench.status().flags.contains(Flags::CYCLE_FLASH));
    bench.done(Request::Resume);
    bench.tick();
    assert!(bench.output.cycle_flash && bench.status().flags.contains(Flags::CYCLE_FLASH));
    for mut bench in powered() {
        let playing = bench.output.state == StateName::Playing;
        bench.tick();
        assert!(!bench.output.cycle_flash, "{:?}", bench.output.state);
        assert_eq!(bench.output.led, !playing);
    }
}

#[test]
fn telemetry_and_status_tell_the_set_point_and_the_frames() {
    let mut bench = Bench::playing(&circle(1.2), play(0, 5_000_000));
    bench.run(1_700_000);
    #[allow(clippy::cast_possible_truncation)] // ±28 000
    let units = |output: gait_player::Output| {
        output
            .setpoint
            .map(|angle| (f64::from(angle) * 1e4).round() as i16)
    };
    // Telemetry is sent every second tick and counts itself.
    let heard = bench.telemetry.len();
    let told: Vec<_> = (0..20)
        .map(|_| {
            let before = bench.telemetry.len();
            let output = bench.tick();
            let news = &bench.telemetry[before..];
            assert!(news.iter().all(|told| told.setpoint == units(output)));
            news.len()
        })
        .collect();
    assert_eq!(bench.telemetry.len() - heard, 10, "{told:?}");
    let status = bench.status();
    assert_eq!(status.setpoint, units(bench.output));
    assert!(status.setpoint[0] != status.setpoint[1] && status.setpoint[0].abs() > 100);
    let before = bench.brain.counters().frames;
    bench.beat();
    bench
        .brain
        .receive(bench.now_us, Transport::Uart, &[0, 5, 1, 2, 3, 4, 0]);
    let after = bench.brain.counters().frames;
    assert_eq!(after.ok, before.ok + 1);
    assert!(after.bad() > before.bad());
}
