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
