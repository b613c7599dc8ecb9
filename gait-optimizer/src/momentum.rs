//! Multipliers of net displacement and rotation as a momentum that is carried along the path of the body, and the height, which is
//! the first variation under a perturbation of the curve.
//!
//! With p dual to the net displacement and c to the net rotation, the momentum in the middle link's own frame is
//! `μ = (p_x cos θ + p_y sin θ, −p_x sin θ + p_y cos θ, p_x y − p_y x + c)`; its third part is the paper's λ₄ (there
//! p = (λ₃, 0) and `c = −λ₃ y_f`). A small perturbation of the curve to the right of its motion increases the objective by the height
//! h = μ · F(Φ) per area, F = dA + \[A₁, A₂\]; h is minus the paper's switching function `F = F₁ λ₃ + F₂ λ₄`. It is defined on bounds
//! too, and unlike `λ₄ = −F₁/F₂` it is regular on φ₁ = −φ₂.

mod arc;
mod motion;
#[cfg(test)]
mod tests;

use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};
use swimmer_model::{Model, SecondDerivatives};

pub(crate) use arc::{Flow, State, pose, shape};
pub(crate) use motion::{Motion, Track};

/// Multipliers in the frame of the curve's first point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Momentum {
    /// Multiplier of the displacement.
    pub(crate) p: Vector2<f64>,
    /// Multiplier of the rotation, over L.
    pub(crate) c: f64,
}

/// Height and its total derivatives by the joint angles, with the pose following the motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Height {
    pub(crate) value: f64,
    pub(crate) gradient: Vector2<f64>,
}

impl Momentum {
    /// Multipliers of a quarter gait that ends at `y_f`, over L: the paper's λ₃ and `λ₄ = λ₃ (y − y_f)`.
    pub(crate) fn of_quarter(sign: f64, final_y: f64) -> Self {
        Self {
            p: Vector2::new(sign, 0.0),
            c: -sign * final_y,
        }
    }

    /// Multipliers with p of length 1 at this angle for which the height vanishes at a shape with the pose at the origin. Returns `None`
    /// if no multiplier of the rotation makes it vanish.
    pub(crate) fn of_zero(model: &Model<f64>, phi: &Vector2<f64>, angle: f64) -> Option<Self> {
        let f = model.first_derivatives(phi).curvature();
        let (sin, cos) = angle.sin_cos();
        let c = -(cos * f.x + sin * f.y) / f.z;
        let p = Vector2::new(cos, sin);
        c.is_finite().then_some(Self { p, c })
    }

    /// μ at a pose x, y, θ.
    pub(crate) fn at(&self, [x, y, theta]: &[f64; 3]) -> Vector3<f64> {
        let (sin, cos) = theta.sin_cos();
        let Self { p, c } = self;
        Vector3::new(
            p.x * cos + p.y * sin,
            p.y * cos - p.x * sin,
            p.x * y - p.y * x + c,
        )
    }

    /// Transforms the multipliers to a frame with its origin at a pose.
    pub(crate) fn in_frame_of(&self, pose: &[f64; 3]) -> Self {
        let body = self.at(pose);
        Self {
            p: body.xy(),
            c: body.z,
        }
    }

    /// Height with its total gradient, including the change of pose with each joint. (The paper's A and B in `Ḟ = A u₁ + B u₂` are minus
    /// this gradient over λ₃.)
    pub(crate) fn height(&self, second: &SecondDerivatives<f64>, pose: &[f64; 3]) -> Height {
        let mu = self.at(pose);
        let [along1, along2] = second.d_curvature();
        height(
            &mu,
            &second.first.connection,
            &second.first.curvature(),
            [mu.dot(&along1), mu.dot(&along2)],
        )
    }

    /// Height, connection and power matrix at a shape, from one evaluation of the model.
    pub(crate) fn evaluate(
        &self,
        model: &Model<f64>,
        phi: &Vector2<f64>,
        pose: &[f64; 3],
    ) -> (Height, Matrix3x2<f64>, Matrix2<f64>) {
        let mu = self.at(pose);
        let there = model.weighed_curvature(phi, &mu);
        let height = height(&mu, &there.connection, &there.curvature, there.slope.into());
        (height, there.connection, there.power)
    }
}

/// Height of μ, from the derivatives of the curvature at fixed μ.
fn height(
    mu: &Vector3<f64>,
    connection: &Matrix3x2<f64>,
    curvature: &Vector3<f64>,
    [held1, held2]: [f64; 2],
) -> Height {
    // μ̇ of the coadjoint equation for the motion of one joint.
    let slope = |held: f64, joint: usize| {
        let body = connection.column(joint);
        let push = Vector3::new(mu.y * body.z, -mu.x * body.z, mu.x * body.y - mu.y * body.x);
        held + push.dot(curvature)
    };
    Height {
        value: mu.dot(curvature),
        gradient: Vector2::new(slope(held1, 0), slope(held2, 1)),
    }
}

impl Height {
    /// Direction of the singular arc: along the zero of the height, with the gain on the left (generalised Legendre–Clebsch condition).
    pub(crate) fn singular_direction(&self) -> Vector2<f64> {
        Vector2::new(self.gradient.y, -self.gradient.x) / self.gradient.norm()
    }
}
