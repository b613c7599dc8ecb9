//! Displacements of the twin against the model's prediction, through link, brain, servos and tank.

use std::f64::consts::TAU;

use crate::play::{Played, circle, play, robot, table};
use gait_player::playback::Playback;
use gait_player::servo::plant::PlantParameters;
use gait_player::{GaitTable, Limits};
use nalgebra::Vector2;
use swimmer_files::ServoFile;
use swimmer_model::{Model, Pose, Swimmer, Tolerance, swim};
use twin::{Tank, TwinConfig};

/// Displacement and rotation of a later cycle, in the frame of its start.
fn step(played: &Played, cycle: usize) -> Pose<f64> {
    let starts = &played.cycle_starts;
    starts[cycle].pose.inverse() * starts[cycle + 1].pose
}

#[test]
fn an_ideal_robot_swims_what_the_model_says() {
    for (swimmer, amplitude) in [
        (Swimmer::robot(), 1.2),
        (Swimmer::robot_slender(), 0.7),
        (Swimmer::purcell(), 1.2),
    ] {
        let gait = circle(amplitude);
        let config = TwinConfig::from_parts(swimmer, &ServoFile::default(), 1).with_ideal_servos();
        let played = play(config, &table(512, &gait), 3, 30.0);
        let stroke = swim(&Model::new(&swimmer).unwrap(), &gait, &Tolerance::default());
        let expected = stroke.displacement.norm();
        let moved = step(&played, 1);
        let error = moved.position().norm() / expected - 1.0;
        println!(
            "circle of {amplitude} rad: {:.6} m, the model {expected:.6} m, relative error {error:.1e}",
            moved.position().norm()
        );
        assert!(error.abs() < 1e-4, "{error:e}");
        assert!(moved.theta.abs() < 1e-4);
        // The pose that the brain estimates agrees too, after it was configured with the true swimmer.
        assert!(played.finished);
    }
}

#[test]
fn a_mirrored_gait_swims_the_mirrored_way() {
    let forward = |u: f64| [0.9 * (TAU * u).cos() + 0.2, 0.7 * (TAU * u).sin()];
    let mirrored = |u: f64| forward(u).map(|phi| -phi);
    let run = |curve: &dyn Fn(f64) -> [f64; 2]| {
        let config = TwinConfig::new(&robot(), 4).with_ideal_servos();
        step(
            &play(config, &GaitTable::from_fn(256, curve).unwrap(), 2, 10.0),
            0,
        )
    };
    // φ → −φ mirrors x, y and turn of the path about the middle link's line.
    let (plain, mirror) = (run(&forward), run(&mirrored));
    let scale = plain.position().norm();
    assert!(scale > 1e-3);
    assert!(
        (plain.x - mirror.x).abs() < 1e-4 * scale,
        "{plain:?} {mirror:?}"
    );
    assert!(
        (plain.y + mirror.y).abs() < 1e-4 * scale,
        "{plain:?} {mirror:?}"
    );
    assert!(
        (plain.theta + mirror.theta).abs() < 1e-5,
        "{plain:?} {mirror:?}"
    );
}

/// Calibration and prediction use the played path of `gait-player` with the model, so the twin must agree with it.
#[test]
fn the_dead_band_costs_what_the_played_path_predicts() {
    let swimmer = Swimmer::robot();
    let mut costs = Vec::new();
    for (amplitude, period_s) in [(0.5, 20), (1.2, 20), (1.9, 26)] {
        let gait = circle(amplitude);
        let table = table(512, &gait);
        let config = TwinConfig::new(&robot(), 3);
        let playback = Playback {
            table: &table,
            period_us: period_s * 1_000_000,
            maps: config.servos.map(Into::into),
            limits: config.limits,
            plant: config.plant,
        };
        assert!(config.plant.dead_band > 0.0169 && config.plant.max_rate < 3.51);
        let predicted = predict(&swimmer, &playback, 2);
        let ideal = swim(&Model::new(&swimmer).unwrap(), &gait, &Tolerance::default())
            .displacement
            .norm();
        let played = play(config, &table, 4, period_s.into());
        let moved = step(&played, 2);
        let error = moved.position().norm() / predicted.position().norm() - 1.0;
        println!(
            "circle of {amplitude} rad with a dead band: {:.6} m, predicted {:.6} m ({error:+.1e}), ideal servos {ideal:.6} m",
            moved.position().norm(),
            predicted.position().norm()
        );
        assert!(error.abs() < 5e-3, "{error:e}");
        let cost = 1.0 - moved.position().norm() / ideal;
        costs.push(cost);
    }
    // The smaller the circle, the larger the loss by the dead band.
    assert!(
        costs.is_sorted_by(|a, b| a > b) && costs[0] > 0.01 && costs[2] > 0.0,
        "{costs:?}"
    );
}

/// Integrates the model along the played path of one cycle.
fn predict(swimmer: &Swimmer<f64>, playback: &Playback<'_>, cycle: u32) -> Pose<f64> {
    let mut tank = Tank::new(swimmer, Pose::identity()).unwrap();
    let mut start = None;
    playback.cycle(cycle, |point| {
        tank.move_joints(Vector2::from(point.angles));
        start.get_or_insert(tank.pose());
    });
    start.unwrap().inverse() * tank.pose()
}

#[test]
fn a_slow_servo_cuts_corners_as_predicted() {
    // The servos are too slow for the circle: the brain may not know it, and the shafts lag.
    let swimmer = Swimmer::robot();
    let table = table(512, &circle(1.2));
    let mut config = TwinConfig::new(&robot(), 3);
    config.plant = PlantParameters {
        max_rate: 0.5,
        dead_band: 0.017,
        pulse_step_ns: 320,
    };
    let playback = Playback {
        table: &table,
        period_us: 10_000_000,
        maps: config.servos.map(Into::into),
        limits: Limits { ..config.limits },
        plant: config.plant,
    };
    let predicted = predict(&swimmer, &playback, 2).position().norm();
    let moved = step(&play(config, &table, 4, 10.0), 2).position().norm();
    let ideal = swim(
        &Model::new(&swimmer).unwrap(),
        &circle(1.2),
        &Tolerance::default(),
    )
    .displacement
    .norm();
    println!("servos at 0.5 rad/s: {moved:.6} m, predicted {predicted:.6} m, ideal {ideal:.6} m");
    assert!(
        (moved / predicted - 1.0).abs() < 5e-3,
        "{moved} {predicted}"
    );
    assert!(moved < 0.8 * ideal);
}

#[test]
fn the_pose_on_board_is_the_truth_where_the_brain_knows_it() {
    let file = robot();
    let config = TwinConfig::new(&file, 9).with_ideal_servos();
    let played = play(config, &table(512, &circle(1.2)), 2, 12.0);
    let truth = played.cycle_starts[0].pose.inverse() * played.end;
    let told = played.telemetry.last().unwrap().pose;
    println!(
        "on board ({:.5}, {:.5}, {:.5}), in the tank {truth:?}",
        told.x, told.y, told.theta
    );
    // Both include the ramp back to neutral; f32, a tick of lag, and the last telemetry is 40 ms old.
    assert!(
        (f64::from(told.x) - truth.x).abs() < 2e-4,
        "{told:?} {truth:?}"
    );
    assert!(
        (f64::from(told.y) - truth.y).abs() < 2e-4,
        "{told:?} {truth:?}"
    );
    assert!(
        (f64::from(told.theta) - truth.theta).abs() < 2e-3,
        "{told:?} {truth:?}"
    );
}
