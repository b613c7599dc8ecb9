//! Objective of a closed curve as a function of displacement, rotation and energy.

use nalgebra::{Matrix4, Vector4};

use crate::closed_curve::Values;

/// −ln |d|² + κ ln ∮P du, to be minimised without net rotation. κ = 1 is Lighthill's efficiency, κ → 0 the displacement; a small κ
/// prevents curls of the displacement optima.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Aim {
    /// κ.
    pub(crate) energy_weight: f64,
}

/// Gradient and Hessian by (X, Y, Δθ, energy).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expansion {
    pub(crate) gradient: Vector4<f64>,
    pub(crate) hessian: Matrix4<f64>,
}

impl Aim {
    pub(crate) fn value(self, values: &Values) -> f64 {
        self.energy_weight * values.energy.ln() - values.displacement.norm_squared().ln()
    }

    pub(crate) fn expansion(self, values: &Values) -> Expansion {
        let (x, y) = (values.displacement.x, values.displacement.y);
        let squared = x * x + y * y;
        let dearer = self.energy_weight / values.energy;
        let gradient = Vector4::new(-2.0 * x / squared, -2.0 * y / squared, 0.0, dearer);
        let turn = 2.0 * (x * x - y * y) / (squared * squared);
        let mut hessian = Matrix4::zeros();
        hessian[(0, 0)] = turn;
        hessian[(1, 1)] = -turn;
        hessian[(0, 1)] = 4.0 * x * y / (squared * squared);
        hessian[(1, 0)] = hessian[(0, 1)];
        hessian[(3, 3)] = -self.energy_weight / (values.energy * values.energy);
        Expansion { gradient, hessian }
    }
}
