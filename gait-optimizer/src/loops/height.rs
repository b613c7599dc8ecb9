//! The height of a loop: what a push of the curve to its outside gains, for one momentum.

use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};
use swimmer_model::Model;

/// φ₁, φ₂, x, y, θ (lengths over L) and the power length ∫√P.
pub(crate) type State = [f64; 6];

pub(crate) fn shape(z: &State) -> Vector2<f64> {
    Vector2::new(z[0], z[1])
}

/// p and c, in the frame of the loop's first point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Momentum {
    /// Dual to the displacement, of length 1.
    pub(crate) direction: Vector2<f64>,
    /// Multiplier of the rotation, over L.
    pub(crate) rotation: f64,
}

/// Height and its derivative along each joint, with the pose carried along.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Height {
    pub(crate) value: f64,
    pub(crate) gradient: Vector2<f64>,
}

impl Momentum {
    /// The momentum with p at this angle whose height vanishes at a shape where the pose is the origin; none where no
    /// multiplier of the rotation makes it vanish.
    pub(crate) fn of_zero(model: &Model<f64>, phi: &Vector2<f64>, angle: f64) -> Option<Self> {
        let f = model.first_derivatives(phi).curvature();
        let (sin, cos) = angle.sin_cos();
        let rotation = -(cos * f.x + sin * f.y) / f.z;
        rotation.is_finite().then_some(Self {
            direction: Vector2::new(cos, sin),
            rotation,
        })
    }

    /// μ at a pose.
    pub(crate) fn body(&self, z: &State) -> Vector3<f64> {
        let (sin, cos) = z[4].sin_cos();
        let p = &self.direction;
        Vector3::new(
            p.x * cos + p.y * sin,
            p.y * cos - p.x * sin,
            p.x * z[3] - p.y * z[2] + self.rotation,
        )
    }

    /// The same momentum seen from a point of the loop, where the pose is made the origin.
    pub(crate) fn seen_from(&self, z: &State) -> Self {
        let body = self.body(z);
        Self {
            direction: body.xy(),
            rotation: body.z,
        }
    }

    /// Height, connection and power matrix.
    pub(crate) fn height(
        &self,
        model: &Model<f64>,
        z: &State,
    ) -> (Height, Matrix3x2<f64>, Matrix2<f64>) {
        let second = model.second_derivatives(&shape(z));
        let mu = self.body(z);
        let f = second.first.curvature();
        let along = second.d_curvature();
        let a = second.first.connection;
        // μ̇ of the coadjoint equation for the motion that one joint brings.
        let slope = |joint: usize| {
            let body = a.column(joint);
            let push = Vector3::new(mu.y * body.z, -mu.x * body.z, mu.x * body.y - mu.y * body.x);
            mu.dot(&along[joint]) + push.dot(&f)
        };
        let height = Height {
            value: mu.dot(&f),
            gradient: Vector2::new(slope(0), slope(1)),
        };
        (height, a, second.first.power)
    }
}

impl Height {
    /// Along the zero of the height with the gain on the left (generalised Legendre–Clebsch).
    pub(crate) fn singular_direction(&self) -> Vector2<f64> {
        Vector2::new(self.gradient.y, -self.gradient.x) / self.gradient.norm()
    }
}
