//! A swimmer in the twin's tank, and its frames.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use pose_source::{Frame, Marker};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::SwimmerFile;
use swimmer_model::Pose;
use twin::Tank;

use crate::cameras::{Cameras, Faults, REACH_M};

/// Frames per second.
pub(crate) const RATE_HZ: f64 = 100.0;
/// Distance of a side link's reflector from its joint \[m\].
pub(crate) const SIDE_M: f64 = 0.1;

/// Markers `Tip` and `Tail` of side links at these angles, without noise.
pub(crate) fn side_markers(pose: &Pose<f64>, [front, back]: [f64; 2]) -> [Marker; 2] {
    let marker = |name: &str, [along, across]: [f64; 2]| {
        let place = pose.transform(&Vector2::new(along, across));
        Marker {
            name: Some(name.to_owned()),
            id: None,
            x_m: place.x,
            y_m: place.y,
            z_m: 0.05,
        }
    };
    // A positive front angle turns its link to the left of the middle link; so does a positive back angle, seen from the middle.
    let tip = [REACH_M + SIDE_M * front.cos(), SIDE_M * front.sin()];
    let tail = [-REACH_M - SIDE_M * back.cos(), SIDE_M * back.sin()];
    [marker("Tip", tip), marker("Tail", tail)]
}

/// True poses of a robot that swims circles, frame by frame.
pub(crate) fn swum(frames: u32, period_s: f64, seed: u64) -> Vec<Pose<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let file = SwimmerFile::preset("robot").unwrap();
    let start = Pose::new(0.1, -0.1, rng.random_range(-3.0..3.0));
    let mut tank = Tank::new(&file.swimmer, start).unwrap();
    let phase: f64 = rng.random_range(0.0..TAU);
    let amplitude = 70_f64.to_radians();
    let shape = |t: f64| {
        let angle = TAU * t / period_s + phase;
        // Starts softly.
        let grown = amplitude * (t / 2.0).min(1.0);
        Vector2::new(grown * angle.cos(), grown * angle.sin())
    };
    (0..frames)
        .map(|frame| {
            for part in 0..5 {
                tank.move_joints(shape((f64::from(frame) + f64::from(part) / 5.0) / RATE_HZ));
            }
            tank.pose()
        })
        .collect()
}

/// Frames of these poses in the order of their reception.
pub(crate) fn filmed(poses: &[Pose<f64>], faults: Faults, seed: u64) -> Vec<Frame> {
    let mut cameras = Cameras::new(faults, seed);
    let exposed = poses
        .iter()
        .enumerate()
        .map(|(number, pose)| cameras.expose(number as f64 / RATE_HZ, pose));
    exposed.collect()
}
