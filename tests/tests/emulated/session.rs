//! A whole session: upload, arm, play, pause, resume, stop; and the pulses that came of it.

use std::ops::ControlFlow;
use std::time::Duration;

use emulator::{Edge, Period, Servo};
use gait_player::servo::ServoMap;
use gait_player::{GaitTable, Limits, TICK_US};
use link_protocol::StateName;

use crate::promise::seen;
use crate::rig;

const PERIOD_US: u32 = 10_000_000;
const PERIOD: Duration = Duration::from_micros(PERIOD_US as u64);

/// R4, R15 and the frame of all promises: three cycles of a 512-knot table, paused and resumed, then stopped.
#[test]
fn three_cycles_come_out_as_pulses() {
    let mut robot = rig::robot();
    let table = rig::circle(70.0);
    rig::upload(&mut robot, &table);
    robot.arm(false).unwrap();
    robot.play(3, PERIOD, false).unwrap();
    robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap();
    rig::pass(&mut robot, Duration::from_secs(3));
    let events = rig::events(&mut robot);
    assert!(
        events.resets.is_empty() && events.lost == 0,
        "{:?}",
        events.resets
    );

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
    assert!(
        jitter < 0.01 && edge < 1.0 && apart < 0.1,
        "{jitter} {edge} {apart}"
    );
    seen(
        "period of both servos",
        &format!(
            "20 000 µs by the registers, spacing off by {jitter:.2} µs, both rise within {apart:.2} µs, edges within \
             {edge:.2} µs of the registers"
        ),
    );
    let rms = rms_against_table(&powered, &table, 3);
    assert!(rms <= 0.5, "{rms}");
    seen(
        "R15, pulses against a 512-knot table, three cycles",
        &format!("{rms:.3}° RMS"),
    );
    let finer = rms_of_steps(&table, 3, PIO_STEP_NS);
    let same = rms_of_steps(&table, 3, 320);
    assert!(
        (same - rms).abs() < 1e-3,
        "{same}: the same steps by arithmetic"
    );
    seen(
        "the same table in pulses of 24 ns steps (PIO), by arithmetic",
        &format!("{finer:.3}° RMS"),
    );
}

/// R4: the widest gait that is allowed, as fast as it may, paused and stopped in full motion.
#[test]
fn the_fastest_widest_gait_stays_within_window_and_rate() {
    let mut robot = rig::robot();
    // Both joints together up to 160.4°, where a straight way crosses nothing; 2.8 rad at 3.5 rad/s are 5.1 s a cycle.
    let table = GaitTable::from_fn(512, |u| {
        let angle = 2.8 * (std::f64::consts::TAU * u).sin();
        [angle, -angle]
    })
    .unwrap();
    rig::upload(&mut robot, &table);
    let shortest = robot.table().unwrap().unwrap().min_period_us;
    robot.arm(false).unwrap();
    robot
        .play(0, Duration::from_micros(shortest.into()), false)
        .unwrap();
    rig::live_until(&mut robot, StateName::Playing);
    rig::live(&mut robot, Duration::from_millis(6_500));
    robot.pause(false).unwrap();
    rig::live_until(&mut robot, StateName::Paused);
    robot.resume().unwrap();
    rig::live(&mut robot, Duration::from_millis(2_700));
    robot.stop().unwrap();
    rig::live_until(&mut robot, StateName::Stopped);
    let periods = rig::events(&mut robot).periods;
    let (mut shortest, mut longest, mut step) = (f64::INFINITY, 0.0f64, 0.0f64);
    for pair in periods.windows(2) {
        let [then, now] = [pair[0].pulses_us(), pair[1].pulses_us()];
        if !pair[1].powered() {
            continue;
        }
        for joint in 0..2 {
            shortest = shortest.min(now[joint]);
            longest = longest.max(now[joint]);
            if pair[0].powered() {
                step = step.max((now[joint] - then[joint]).abs());
            }
        }
    }
    let limits = Limits::ROBOT;
    let step_limit = f64::from(limits.max_step() / ServoMap::ROBOT.slope_rad_per_us);
    // Compare values are whole steps of 0.32 µs.
    assert!(step <= step_limit + 0.32, "{step} of {step_limit}");
    assert!(
        shortest >= f64::from(limits.pulse_min_ns) * 1e-3 - 0.16,
        "{shortest}"
    );
    assert!(
        longest <= f64::from(limits.pulse_max_ns) * 1e-3 + 0.16,
        "{longest}"
    );
    assert!(
        longest - shortest > 200.0,
        "hardly moved: {shortest} to {longest}"
    );
    seen(
        "R4, ±2.8 rad at 3.5 rad/s, paused, resumed, stopped",
        &format!(
            "pulses of {shortest:.1} to {longest:.1} µs (window 1300 to 1700), largest step {step:.2} µs (limit \
             {step_limit:.2} and the counter's 0.32)"
        ),
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

/// Step of a PIO program: three cycles of 8 ns a count.
const PIO_STEP_NS: u32 = 24;

/// Error of a table's angles after rounding the pulses to steps \[degrees RMS\].
fn rms_of_steps(table: &GaitTable, cycles: u32, step_ns: u32) -> f64 {
    let ticks = cycles * PERIOD_US / TICK_US;
    let squares = (0..ticks).flat_map(|tick| {
        let shape = table.at(table.phase(tick * TICK_US % PERIOD_US, PERIOD_US));
        shape.angles.map(|angle| {
            let pulse = ServoMap::ROBOT.pulse_ns(angle);
            let stepped = (pulse + step_ns / 2) / step_ns * step_ns;
            f64::from(ServoMap::ROBOT.angle(stepped) - ServoMap::ROBOT.angle(pulse)).powi(2)
        })
    });
    (squares.sum::<f64>() / f64::from(2 * ticks))
        .sqrt()
        .to_degrees()
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
