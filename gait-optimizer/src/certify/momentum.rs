//! The multipliers of net displacement and rotation, as a momentum that the body carries along its path.
//!
//! With p dual to the net displacement and c to the net rotation, the momentum in the middle link's own frame is
//! `μ = (p_x cos θ + p_y sin θ, −p_x sin θ + p_y cos θ, p_x y − p_y x + c)`; its third part is the paper's λ₄ (there
//! p = (λ₃, 0) and `c = −λ₃ y_f`). A small push of the curve to the right of its motion gains the height h = μ · F(Φ) a unit of
//! area, F = dA + \[A₁, A₂\].

use nalgebra::{Vector2, Vector3};
use swimmer_model::SecondDerivatives;

use super::path::Place;

/// One choice of the multipliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Momentum {
    pub(super) p: Vector2<f64>,
    pub(super) c: f64,
}

impl Momentum {
    /// μ at a pose.
    pub(super) fn at(&self, [x, y, theta]: &[f64; 3]) -> Vector3<f64> {
        let (sin, cos) = theta.sin_cos();
        let Self { p, c } = self;
        Vector3::new(
            p.x * cos + p.y * sin,
            p.y * cos - p.x * sin,
            p.x * y - p.y * x + c,
        )
    }

    /// The height h where the curve is.
    pub(super) fn height(&self, place: &Place) -> f64 {
        self.at(&place.pose).dot(&place.first.curvature())
    }

    /// How the height changes along each joint, with the pose that the joint's motion brings.
    pub(super) fn gradient(&self, place: &Place, second: &SecondDerivatives<f64>) -> Vector2<f64> {
        let mu = self.at(&place.pose);
        let curvature = second.first.curvature();
        let [along1, along2] = second.d_curvature();
        let slope = |along: &Vector3<f64>, joint: usize| {
            let body = second.first.connection.column(joint);
            let turned = Vector3::new(mu.y * body.z, -mu.x * body.z, mu.x * body.y - mu.y * body.x);
            mu.dot(along) + turned.dot(&curvature)
        };
        Vector2::new(slope(&along1, 0), slope(&along2, 1))
    }
}
