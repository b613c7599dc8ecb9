//! The predicted path against the brain's own pulses on the same servos.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::needless_range_loop
)] // times are small; there are two joints
use crate::bench;

use bench::*;
use gait_player::playback::{Playback, PlayedPoint};
use gait_player::servo::{ServoMap, plant::PlantParameters, plant::ServoPlant};
use gait_player::{GaitTable, Limits};
use link_protocol::StateName;

const SERVO: PlantParameters = PlantParameters {
    max_rate: 3.5,
    dead_band: 0.017,
    pulse_step_ns: 320,
};

fn path(table: &GaitTable, period_us: u32, plant: PlantParameters, cycle: u32) -> Vec<PlayedPoint> {
    let playback = Playback {
        table,
        period_us,
        maps: [ServoMap::ROBOT; 2],
        limits: Limits::ROBOT,
        plant,
    };
    let mut points = Vec::new();
    playback.cycle(cycle, |point| points.push(point));
    points
}

/// Angles at a time, interpolated between the vertices.
fn at(points: &[PlayedPoint], time_s: f64) -> [f64; 2] {
    let next = points
        .partition_point(|point| point.time_s < time_s)
        .clamp(1, points.len() - 1);
    let (a, b) = (&points[next - 1], &points[next]);
    let share = if b.time_s > a.time_s {
        (time_s - a.time_s) / (b.time_s - a.time_s)
    } else {
        1.0
    };
    [0, 1].map(|joint| a.angles[joint] + share * (b.angles[joint] - a.angles[joint]))
}

#[test]
fn the_path_is_what_the_brains_pulses_make_of_the_same_servos() {
    let table = circle(1.2);
    // This period is not a multiple of a tick, so cycles start within ticks.
    let period_us = 4_990_001;
    let predicted = [0, 1, 2].map(|cycle| path(&table, period_us, SERVO, cycle));
    let mut bench = Bench::new();
    bench.upload(&table);
    bench.done(ARM);
    let mut servos = [ServoPlant::new(0.0); 2];
    let mut advance = |output: gait_player::Output| {
        let pulses = output.pulses_ns.unwrap();
        for joint in 0..2 {
            let command = SERVO.command(&ServoMap::ROBOT, pulses[joint]);
            servos[joint].advance(&SERVO, command, 0.02);
        }
        [servos[0].angle, servos[1].angle]
    };
    bench.done(play(3, period_us));
    while bench.output.state != StateName::Playing {
        let output = bench.output;
        if output.pulses_ns.is_some() {
            advance(output);
        }
        bench.tick();
    }
    let (start, mut worst) = (bench.now_us, 0.0_f64);
    while bench.output.state == StateName::Playing {
        let angles = advance(bench.output);
        let end_of_tick = bench.now_us + 20_000 - start;
        let cycle = (end_of_tick / u64::from(period_us)) as usize;
        if cycle < 3 {
            let time_s = (end_of_tick % u64::from(period_us)) as f64 * 1e-6;
            let expected = at(&predicted[cycle], time_s);
            worst = (0..2).fold(worst, |worst, joint| {
                worst.max((angles[joint] - expected[joint]).abs())
            });
        }
        bench.tick();
    }
    println!("playback against brain and plant over three cycles: {worst:.1e} rad at most");
    assert!(worst < 1e-9, "{worst}");
}

#[test]
fn ideal_servos_go_where_the_table_goes() {
    let table = circle(1.2);
    for point in path(&table, 5_000_000, PlantParameters::IDEAL, 1) {
        // A command is held for a tick, so the angle is that of the table at the tick's start.
        let phase = table.phase((point.time_s * 1e6).round() as u32, 5_000_000);
        let shape = table.at(phase).angles;
        for joint in 0..2 {
            let error = point.angles[joint] - f64::from(shape[joint]);
            assert!(
                error.abs() < 1.2 * std::f64::consts::TAU / 250.0 + 1e-4,
                "{error} at {}",
                point.time_s
            );
        }
    }
}

#[test]
fn a_cycle_is_visited_from_start_to_end_in_order() {
    let table = circle(1.2);
    for (period_us, cycle) in [
        (5_000_000, 0),
        (5_000_000, 1),
        (4_990_001, 1),
        (4_990_001, 3),
        (15_000, 2),
    ] {
        let points = path(&table, period_us, SERVO, cycle);
        assert!(points[0].time_s.abs() < 1e-12);
        assert!((points[points.len() - 1].time_s - f64::from(period_us) * 1e-6).abs() < 1e-9);
        assert!(
            points
                .windows(2)
                .all(|pair| pair[0].time_s <= pair[1].time_s)
        );
        // No piece exceeds the servo's rate.
        for pair in points.windows(2) {
            let seconds = pair[1].time_s - pair[0].time_s;
            let step = (0..2).fold(0.0_f64, |most, joint| {
                most.max((pair[1].angles[joint] - pair[0].angles[joint]).abs())
            });
            assert!(step <= 3.5 * seconds + 1e-9);
        }
    }
}

#[test]
fn the_dead_band_takes_its_share_of_the_amplitude_and_cycles_repeat() {
    let table = circle(0.5);
    let period_us = 5_000_000;
    let plant = PlantParameters {
        dead_band: 0.05,
        pulse_step_ns: 0,
        ..SERVO
    };
    let most = path(&table, period_us, plant, 1)
        .iter()
        .fold(0.0_f64, |most, point| most.max(point.angles[0]));
    assert!((most - 0.45).abs() < 2e-3, "{most}");
    let (second, fourth) = (
        path(&table, period_us, plant, 1),
        path(&table, period_us, plant, 3),
    );
    let worst = (0..500).fold(0.0_f64, |worst, step| {
        let time_s = f64::from(step) * 0.01;
        let (a, b) = (at(&second, time_s), at(&fourth, time_s));
        worst.max((a[0] - b[0]).abs()).max((a[1] - b[1]).abs())
    });
    assert!(worst < 1e-9, "{worst}");
    // The first cycle starts at the end of the soft start.
    let first = path(&table, period_us, plant, 0)[0].angles;
    assert!(
        (first[0] - (0.5 * 0.5_f64.sqrt() - 0.05)).abs() < 2e-3,
        "{first:?}"
    );
}
