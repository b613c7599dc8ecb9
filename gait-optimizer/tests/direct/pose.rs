//! The pose that a straight side in the plane of joint angles brings.

use nalgebra::{Vector2, Vector3};
use swimmer_model::Model;

pub(super) use crate::plane::Pose;

impl Pose {
    #[allow(dead_code)] // not every method that shares this file goes backwards
    pub(super) fn inverse(self) -> Self {
        let (sin, cos) = self.theta.sin_cos();
        Self {
            x: -(cos * self.x + sin * self.y),
            y: sin * self.x - cos * self.y,
            theta: -self.theta,
        }
    }

    /// Along a straight side, over L: Magnus steps of order four at two Gauss points each.
    pub(super) fn along(model: &Model<f64>, from: Vector2<f64>, to: Vector2<f64>) -> Self {
        let way = to - from;
        let count = (1..1000)
            .find(|&count| way.norm() <= 0.02 * f64::from(count))
            .unwrap_or(1000);
        let steps = f64::from(count);
        let half_gap = 3.0_f64.sqrt() / 6.0;
        let velocity = |s: f64| {
            let body = model.connection_and_power(&(from + way * s)).0 * way / steps;
            Vector3::new(body.x, body.y, body.z)
        };
        let length = model.swimmer().total_length();
        (0..count).fold(Self::default(), |pose, i| {
            let middle = (f64::from(i) + 0.5) / steps;
            let (a, b) = (
                velocity(middle - half_gap / steps),
                velocity(middle + half_gap / steps),
            );
            // Omega = (a + b)/2 + √3/12 [a, b] in the order of a left-invariant equation.
            let bracket = Vector2::new(b.z * a.y - a.z * b.y, a.z * b.x - b.z * a.x);
            let mean = (a + b) * 0.5;
            let twist = Vector3::new(
                mean.x + bracket.x * half_gap * 0.5,
                mean.y + bracket.y * half_gap * 0.5,
                mean.z,
            );
            pose * Self::exp(twist.x / length, twist.y / length, twist.z)
        })
    }

    fn exp(x: f64, y: f64, theta: f64) -> Self {
        let (sinc, cosc) = if theta.abs() < 1e-4 {
            (1.0 - theta * theta / 6.0, theta / 2.0)
        } else {
            (theta.sin() / theta, (1.0 - theta.cos()) / theta)
        };
        Self {
            x: sinc * x - cosc * y,
            y: cosc * x + sinc * y,
            theta,
        }
    }
}
