//! What keeps a node inside: margins c(Φ) ≥ 0 with their derivatives, and the logarithmic barrier on them.

use nalgebra::{Matrix2, Vector2};

/// A bound at every node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Wall {
    /// `sign · φ[joint] ≤ limit`.
    Angle { joint: usize, sign: f64, limit: f64 },
}

/// c, its gradient and its second derivatives at a shape.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Margin {
    pub(crate) value: f64,
    pub(crate) gradient: Vector2<f64>,
    pub(crate) curvature: Matrix2<f64>,
}

impl Wall {
    /// The four sides of |φᵢ| ≤ `limit`.
    pub(crate) fn sides(limit: f64) -> [Self; 4] {
        [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)].map(|(joint, sign)| Self::Angle {
            joint,
            sign,
            limit,
        })
    }

    pub(crate) fn value(&self, phi: &Vector2<f64>) -> f64 {
        match *self {
            Self::Angle { joint, sign, limit } => limit - sign * phi[joint],
        }
    }

    pub(crate) fn margin(&self, phi: &Vector2<f64>) -> Margin {
        match *self {
            Self::Angle { joint, sign, .. } => {
                let mut gradient = Vector2::zeros();
                gradient[joint] = -sign;
                Margin {
                    value: self.value(phi),
                    gradient,
                    curvature: Matrix2::zeros(),
                }
            }
        }
    }

    /// Moves a shape back where its margin is below `least`.
    pub(crate) fn draw_inside(&self, phi: &mut Vector2<f64>, least: f64) {
        match *self {
            Self::Angle { joint, sign, limit } => {
                if limit - sign * phi[joint] < least {
                    phi[joint] = sign * (limit - least);
                }
            }
        }
    }
}
