//! A swimmer in the twin's tank, and cameras with every fault that trackers report.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use pose_source::{Frame, Marker};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use swimmer_files::SwimmerFile;
use swimmer_model::Pose;
use twin::Tank;

/// Frames per second.
pub(crate) const RATE_HZ: f64 = 100.0;
/// Distance of a reflector from the middle link's centre \[m\].
pub(crate) const REACH_M: f64 = 0.0355;

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

/// Faults of the cameras; all off at first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Faults {
    /// Standard deviation of a coordinate \[m\].
    pub(crate) noise_m: f64,
    /// Share of frames in which a reflector is blank, in bursts of up to 24 frames; in half of the bursts both are.
    pub(crate) blank: f64,
    /// Chance per frame that labels are exchanged for a burst.
    pub(crate) swap: f64,
    /// Chance per frame that a ghost comes; one in twenty goes per frame.
    pub(crate) ghost: f64,
    /// Chance that a reflector is unlabeled after a burst, for up to 300 frames.
    pub(crate) relabel: f64,
    /// Delay between exposure and reception \[s\], and the mean of its exponential jitter.
    pub(crate) latency_s: f64,
    pub(crate) jitter_s: f64,
}

impl Faults {
    pub(crate) const NONE: Self = Self {
        noise_m: 3e-4,
        blank: 0.0,
        swap: 0.0,
        ghost: 0.0,
        relabel: 0.0,
        latency_s: 0.08,
        jitter_s: 0.0,
    };

    pub(crate) const ALL: Self = Self {
        blank: 0.3,
        swap: 0.01,
        ghost: 0.02,
        relabel: 0.2,
        jitter_s: 0.005,
        ..Self::NONE
    };
}

/// Frames of these poses in the order of their reception. The camera clock is 1000 s ahead of the host's.
pub(crate) fn filmed(poses: &[Pose<f64>], faults: Faults, seed: u64) -> Vec<Frame> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5eed);
    let normal = |rng: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(rng) };
    let (mut blank, mut unlabeled, mut swapped) = ([0_u32; 2], [0_u32; 2], 0_u32);
    let mut ghosts: Vec<[f64; 2]> = Vec::new();
    // Bursts of 13 frames on average, in half of them both: chance per frame that one begins.
    let burst = faults.blank / (1.0 - faults.blank) / 13.0 / 1.5;
    let mut frames: Vec<Frame> = Vec::with_capacity(poses.len());
    for (number, pose) in poses.iter().enumerate() {
        let host_s = number as f64 / RATE_HZ;
        for which in 0..2 {
            if blank[which] > 0 {
                blank[which] -= 1;
                if blank[which] == 0 && rng.random::<f64>() < faults.relabel {
                    unlabeled[which] = rng.random_range(1..300);
                }
            } else if rng.random::<f64>() < burst {
                let length = rng.random_range(2..=24);
                blank[which] = length;
                if rng.random::<bool>() {
                    blank[1 - which] = blank[1 - which].max(length);
                }
            }
            unlabeled[which] = unlabeled[which].saturating_sub(1);
        }
        swapped = match swapped {
            0 if rng.random::<f64>() < faults.swap => rng.random_range(1..40),
            left => left.saturating_sub(1),
        };
        ghosts.retain(|_| rng.random::<f64>() >= 0.05);
        if rng.random::<f64>() < faults.ghost {
            let mut away = || rng.random_range(-0.15..0.15);
            ghosts.push([pose.x + away(), pose.y + away()]);
        }
        let mut markers = Vec::new();
        for (which, along) in [REACH_M, -REACH_M].into_iter().enumerate() {
            if blank[which] > 0 {
                continue;
            }
            let (sin, cos) = pose.theta.sin_cos();
            let called = ["Front", "Back"][if swapped > 0 { 1 - which } else { which }];
            markers.push(Marker {
                name: (unlabeled[which] == 0).then(|| called.to_owned()),
                id: None,
                x_m: pose.x + along * cos + faults.noise_m * normal(&mut rng),
                y_m: pose.y + along * sin + faults.noise_m * normal(&mut rng),
                z_m: 0.05 + faults.noise_m * normal(&mut rng),
            });
        }
        for [x_m, y_m] in &ghosts {
            markers.push(Marker {
                name: None,
                id: None,
                x_m: *x_m,
                y_m: *y_m,
                z_m: 0.05,
            });
        }
        // Lists are in no order.
        if rng.random::<bool>() {
            markers.reverse();
        }
        let jitter = -faults.jitter_s * (1.0 - rng.random::<f64>()).ln();
        let received_s = host_s + faults.latency_s + jitter;
        let last_s = frames.last().map_or(0.0, |last| last.received_s);
        frames.push(Frame {
            stamp_s: 1000.0 + host_s,
            // A stream keeps its order.
            received_s: received_s.max(last_s),
            latency_s: None,
            markers,
            bodies: Vec::new(),
        });
    }
    frames
}
