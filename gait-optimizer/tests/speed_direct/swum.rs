//! The poses that a straight side in the plane of joint angles brings, one for each swimmer.

use std::ops::Mul;

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::plane::Pose;

/// One for each swimmer.
#[derive(Debug, Clone)]
pub(super) struct Poses(Vec<Pose>);

impl Poses {
    pub(super) fn still(count: usize) -> Self {
        Self(vec![Pose::default(); count])
    }

    /// Each with what its servos turn over what they are told.
    pub(super) fn along(swimmers: &[(Model<f64>, f64)], ends: [Vector2<f64>; 2]) -> Self {
        let swimmers = swimmers.iter();
        let poses = swimmers.map(|(model, gain)| Pose::along(model, ends.map(|end| end * *gain)));
        Self(poses.collect())
    }

    pub(super) fn first(&self) -> Pose {
        self.0[0]
    }

    pub(super) fn all(&self) -> &[Pose] {
        &self.0
    }
}

impl Mul for &Poses {
    type Output = Poses;

    fn mul(self, next: Self) -> Poses {
        let pairs = self.0.iter().zip(&next.0);
        Poses(pairs.map(|(one, next)| *one * *next).collect())
    }
}

/// Longest step \[rad\].
const STEP: f64 = 0.15;

impl Pose {
    /// Steps of the Gauss method of order six, explicit here as the rates depend on the shape and θ alone.
    fn along(model: &Model<f64>, [from, to]: [Vector2<f64>; 2]) -> Self {
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
