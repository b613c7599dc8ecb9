//! A whole session: upload, arm, play, pause, resume, stop; and the pulses that came of it.

use std::ops::ControlFlow;
use std::time::Duration;

use emulator::{Edge, Period, Servo};
use gait_player::servo::ServoMap;
use gait_player::{GaitTable, TICK_US};
use link_protocol::StateName;

use crate::rig;

const PERIOD_US: u32 = 10_000_000;
const PERIOD: Duration = Duration::from_micros(PERIOD_US as u64);

/// R11, R15 and the frame of all promises: three cycles of a 512-knot table.
#[test]
fn three_cycles_come_out_as_pulses() {
    let Some(mut robot) = rig::robot() else {
        return;
    };
    let table = rig::circle(70.0);
    rig::upload(&mut robot, &table);
    robot.arm(false).unwrap();
    robot.play(3, PERIOD, false).unwrap();
    robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap();
    rig::pass(&mut robot, Duration::from_secs(3));
    let events = rig::events(&mut robot);

    // Exactly 20 000 µs, both channels together, edges within 1 µs of the registers.
    let powered: Vec<Period> = events
        .periods
        .iter()
        .copied()
        .filter(Period::powered)
        .collect();
    assert!(
        powered
            .iter()
            .all(|period| (period.length_us() - 20_000.0).abs() < 1e-9)
    );
    let jitter = spacing_jitter_us(&powered);
    let (edge, apart) = edges_against_registers(&events.edges, &powered);
    println!(
        "period 20 000 µs, jitter {jitter:.3} µs; edges within {edge:.2} µs; channels apart {apart:.3} µs"
    );
    assert!(jitter < 1.0 && edge < 1.0 && apart < 0.1);

    // Never outside the window, and what the table says.
    let window = |us: f64| (600.0..=2400.0).contains(&us);
    assert!(
        powered
            .iter()
            .all(|period| period.pulses_us().into_iter().all(window))
    );
    let rms = rms_against_table(&powered, &table, 3);
    println!("pulses against the table: {rms:.3}° RMS");
    assert!(rms <= 0.5, "{rms}");

    let busiest = powered.iter().map(Period::busy_ms).fold(0.0, f64::max);
    println!("busiest tick: {busiest:.2} ms at 125 MHz");
    assert!(busiest <= 2.0, "{busiest}");
    assert!(events.resets.is_empty() && events.lost == 0, "{events:?}");
}

#[test]
fn pause_resume_and_stop() {
    let Some(mut robot) = rig::robot() else {
        return;
    };
    rig::upload(&mut robot, &rig::circle(40.0));
    robot.arm(false).unwrap();
    robot.play(0, PERIOD, false).unwrap();
    let until = |robot: &mut host_link::Robot<rig::Port>, state: StateName| {
        robot
            .listen(Duration::from_secs(10), |telemetry| match telemetry {
                Some(telemetry) if telemetry.state == state => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            })
            .unwrap();
        assert_eq!(robot.status().unwrap().state, state);
    };
    until(&mut robot, StateName::Playing);
    robot.pause(false).unwrap();
    until(&mut robot, StateName::Paused);
    robot.resume().unwrap();
    until(&mut robot, StateName::Playing);
    robot.stop().unwrap();
    until(&mut robot, StateName::Stopped);
    rig::events(&mut robot);
    rig::pass(&mut robot, Duration::from_millis(100));
    assert!(
        rig::events(&mut robot)
            .periods
            .iter()
            .all(|period| !period.powered())
    );
}

/// Largest deviation of the spacing of periods from 20 ms \[µs\].
fn spacing_jitter_us(periods: &[Period]) -> f64 {
    periods
        .windows(2)
        .map(|pair| (pair[1].at().abs_diff(pair[0].at()).as_secs_f64() * 1e6 - 20_000.0).abs())
        .filter(|off| *off < 1_000.0) // between two plays there is a gap
        .fold(0.0, f64::max)
}

/// Largest difference of edge-measured and latched pulse widths, and of both rising edges \[µs\].
fn edges_against_registers(edges: &[Edge], periods: &[Period]) -> (f64, f64) {
    let after = |period: &Period, pin: Servo, high: bool| {
        edges
            .iter()
            .find(|edge| {
                edge.pin == pin
                    && edge.high == high
                    && edge.at() + Duration::from_micros(5) >= period.at()
            })
            .map(|edge| edge.at().as_secs_f64() * 1e6)
    };
    let (mut width, mut apart) = (0.0f64, 0.0f64);
    for period in periods.iter().step_by(37) {
        let [front, back] = period.pulses_us();
        if let (Some(up), Some(down), Some(up2), Some(down2)) = (
            after(period, Servo::Front, true),
            after(period, Servo::Front, false),
            after(period, Servo::Back, true),
            after(period, Servo::Back, false),
        ) {
            width = width
                .max((down - up - front).abs())
                .max((down2 - up2 - back).abs());
            apart = apart.max((up - up2).abs());
        }
    }
    (width, apart)
}

/// Finds the play in the periods and compares it tick by tick with the table \[degrees RMS\].
fn rms_against_table(periods: &[Period], table: &GaitTable, cycles: u32) -> f64 {
    let ticks = cycles * PERIOD_US / TICK_US;
    let expected: Vec<[f64; 2]> = (0..ticks)
        .map(|tick| {
            let at = tick * TICK_US % PERIOD_US;
            let shape = table.at(table.phase(at, PERIOD_US));
            shape
                .angles
                .map(|angle| f64::from(ServoMap::ROBOT.angle(ServoMap::ROBOT.pulse_ns(angle))))
        })
        .collect();
    let played: Vec<[f64; 2]> = periods.iter().map(rig::angles).collect();
    let squares = |start: usize| -> f64 {
        expected
            .iter()
            .zip(&played[start..])
            .map(|(want, have)| (want[0] - have[0]).powi(2) + (want[1] - have[1]).powi(2))
            .sum()
    };
    let starts = 0..=played.len() - expected.len();
    let best = starts.map(squares).fold(f64::INFINITY, f64::min);
    (best / f64::from(2 * ticks)).sqrt().to_degrees()
}
