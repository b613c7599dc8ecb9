//! Composition of planar poses, and the pose of a straight side in the plane of joint angles: shared by the direct methods, which
//! take nothing but A from the model.

use std::ops::Mul;

use nalgebra::{Vector2, Vector3};
use swimmer_model::Model;

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pose {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) theta: f64,
}

impl Mul for Pose {
    type Output = Self;

    fn mul(self, next: Self) -> Self {
        let (sin, cos) = self.theta.sin_cos();
        Self {
            x: self.x + cos * next.x - sin * next.y,
            y: self.y + sin * next.x + cos * next.y,
            theta: self.theta + next.theta,
        }
    }
}

/// Longest step \[rad\].
const STEP: f64 = 0.15;
/// √15.
const ROOT: f64 = 3.872_983_346_207_417;

impl Pose {
    /// Nodes and weights of a Gauss step of order six.
    pub(crate) const NODES: [f64; 3] = [0.5 - ROOT / 10.0, 0.5, 0.5 + ROOT / 10.0];
    pub(crate) const WEIGHTS: [f64; 3] = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];
    const UP_TO: [[f64; 3]; 3] = [
        [
            5.0 / 36.0,
            2.0 / 9.0 - ROOT / 15.0,
            5.0 / 36.0 - ROOT / 30.0,
        ],
        [
            5.0 / 36.0 + ROOT / 24.0,
            2.0 / 9.0,
            5.0 / 36.0 - ROOT / 24.0,
        ],
        [
            5.0 / 36.0 + ROOT / 30.0,
            2.0 / 9.0 + ROOT / 15.0,
            5.0 / 36.0,
        ],
    ];

    /// One Gauss step with these rates of the body, explicit here as they depend on the shape alone.
    pub(crate) fn stepped(rates: &[Vector3<f64>; 3]) -> Self {
        let turned = |weights: &[f64; 3]| -> f64 {
            let turned = weights.iter().zip(rates);
            turned.map(|(weight, rate)| weight * rate.z).sum()
        };
        let mut pose = Self::default();
        for (rate, (weight, row)) in rates.iter().zip(Self::WEIGHTS.iter().zip(&Self::UP_TO)) {
            let (sin, cos) = turned(row).sin_cos();
            pose.x += weight * (cos * rate.x - sin * rate.y);
            pose.y += weight * (sin * rate.x + cos * rate.y);
        }
        pose.theta = turned(&Self::WEIGHTS);
        pose
    }

    /// Along a straight side.
    #[allow(dead_code, reason = "each test file is a program of its own")]
    pub(crate) fn along(model: &Model<f64>, [from, to]: [Vector2<f64>; 2]) -> Self {
        let way = to - from;
        let count = (1..1000)
            .find(|&count| way.norm() <= STEP * f64::from(count))
            .unwrap_or(1000);
        let step = way / f64::from(count);
        (0..count).fold(Self::default(), |pose, i| {
            let begun = from + step * f64::from(i);
            let rate = |s: f64| model.connection_and_power(&(begun + step * s)).0 * step;
            pose * Self::stepped(&Self::NODES.map(rate))
        })
    }
}
