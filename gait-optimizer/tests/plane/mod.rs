//! Poses in the plane, one after the other, and what a straight side in the plane of joint angles brings: what the direct methods
//! share beside the model's A.

use std::ops::Mul;

use nalgebra::Vector2;
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

impl Pose {
    /// Steps of the Gauss method of order six, explicit here as the rates depend on the shape and θ alone.
    pub(crate) fn along(model: &Model<f64>, [from, to]: [Vector2<f64>; 2]) -> Self {
        let root = 15.0_f64.sqrt();
        let nodes = [0.5 - root / 10.0, 0.5, 0.5 + root / 10.0];
        let weights = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];
        let up_to = [
            [
                5.0 / 36.0,
                2.0 / 9.0 - root / 15.0,
                5.0 / 36.0 - root / 30.0,
            ],
            [
                5.0 / 36.0 + root / 24.0,
                2.0 / 9.0,
                5.0 / 36.0 - root / 24.0,
            ],
            [
                5.0 / 36.0 + root / 30.0,
                2.0 / 9.0 + root / 15.0,
                5.0 / 36.0,
            ],
        ];
        let way = to - from;
        let count = (1..1000)
            .find(|&count| way.norm() <= STEP * f64::from(count))
            .unwrap_or(1000);
        let step = way / f64::from(count);
        (0..count).fold(Self::default(), |mut pose, i| {
            let begun = from + step * f64::from(i);
            let rates = nodes.map(|s| model.connection_and_power(&(begun + step * s)).0 * step);
            for (rate, (weight, row)) in rates.iter().zip(weights.iter().zip(&up_to)) {
                let turned: f64 = row.iter().zip(&rates).map(|(w, rate)| w * rate.z).sum();
                let (sin, cos) = (pose.theta + turned).sin_cos();
                pose.x += weight * (cos * rate.x - sin * rate.y);
                pose.y += weight * (sin * rate.x + cos * rate.y);
            }
            pose.theta += rates
                .iter()
                .zip(&weights)
                .map(|(r, w)| w * r.z)
                .sum::<f64>();
            pose
        })
    }
}
