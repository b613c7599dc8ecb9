//! What a closed curve is sought for, as a function of what it brings and costs.

use nalgebra::{Matrix4, Vector4};

use crate::closed_curve::Values;

/// To be made small, with no net rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Aim {
    /// −ln |d|² + κ ln ∮P du. κ = 1 is Lighthill's efficiency; κ → 0 the displacement, whose optima κ keeps from curling.
    Far {
        /// κ.
        energy_weight: f64,
    },
}

/// Value, gradient and Hessian by (X, Y, Δθ, energy).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expansion {
    pub(crate) value: f64,
    pub(crate) gradient: Vector4<f64>,
    pub(crate) hessian: Matrix4<f64>,
}

impl Aim {
    pub(crate) fn energy_weight(self) -> f64 {
        match self {
            Self::Far { energy_weight } => energy_weight,
        }
    }

    pub(crate) fn value(self, values: &Values) -> f64 {
        let d = &values.displacement;
        let squared = match self {
            Self::Far { .. } => d.norm_squared(),
        };
        self.energy_weight() * values.energy.ln() - squared.ln()
    }

    pub(crate) fn expansion(self, values: &Values) -> Expansion {
        let (x, y) = (values.displacement.x, values.displacement.y);
        let (mut gradient, mut hessian) = (Vector4::zeros(), Matrix4::zeros());
        match self {
            Self::Far { .. } => {
                let squared = x * x + y * y;
                gradient.x = -2.0 * x / squared;
                gradient.y = -2.0 * y / squared;
                let turn = 2.0 * (x * x - y * y) / (squared * squared);
                hessian[(0, 0)] = turn;
                hessian[(1, 1)] = -turn;
                hessian[(0, 1)] = 4.0 * x * y / (squared * squared);
                hessian[(1, 0)] = hessian[(0, 1)];
            }
        }
        gradient.w = self.energy_weight() / values.energy;
        hessian[(3, 3)] = -self.energy_weight() / (values.energy * values.energy);
        Expansion {
            value: self.value(values),
            gradient,
            hessian,
        }
    }
}
