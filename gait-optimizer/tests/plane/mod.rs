//! Poses in the plane, one after the other: what the direct methods share beside the model's A.

use std::ops::Mul;

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
