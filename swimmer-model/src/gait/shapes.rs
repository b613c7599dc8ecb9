//! The two closed-form gaits of the experiments: circle and square in the plane of joint angles.

use super::{Gait, GaitPoint, from_diagonals, two_pi, wrapped};
use crate::Scalar;
use nalgebra::Vector2;

/// A circle about the straight shape at uniform angle, counter-clockwise from φ₁ = φ₂ > 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle<T> {
    /// Radius ε \[rad\].
    pub amplitude: T,
}

impl<T: Scalar> Gait<T> for Circle<T> {
    fn at(&self, u: T) -> GaitPoint<T> {
        let (sin, cos) = (two_pi::<T>() * wrapped(u)).sin_cos();
        let speed = two_pi::<T>() * self.amplitude;
        GaitPoint {
            phi: from_diagonals(Vector2::new(self.amplitude * cos, self.amplitude * sin)),
            rate: from_diagonals(Vector2::new(-speed * sin, speed * cos)),
        }
    }
}

/// A square with corners (±ε, ±ε) at constant speed along its edges, counter-clockwise from (ε, ε).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square<T> {
    /// Half the edge, ε \[rad\].
    pub amplitude: T,
}

impl<T: Scalar> Gait<T> for Square<T> {
    fn at(&self, u: T) -> GaitPoint<T> {
        let (one, two, four) = (T::one(), T::from_f64(2.0), T::from_f64(4.0));
        let along = four * wrapped(u);
        let edge = along.floor();
        // From +1 at the edge's beginning to −1 at its end.
        let place = one - two * (along - edge);
        let (a, speed, still) = (self.amplitude, T::from_f64(8.0) * self.amplitude, T::zero());
        let (phi, rate) = if edge < one {
            ((place, one), (-speed, still))
        } else if edge < two {
            ((-one, place), (still, -speed))
        } else if edge < T::from_f64(3.0) {
            ((-place, -one), (speed, still))
        } else {
            ((one, -place), (still, speed))
        };
        GaitPoint {
            phi: Vector2::new(phi.0 * a, phi.1 * a),
            rate: Vector2::new(rate.0, rate.1),
        }
    }

    fn pieces(&self) -> usize {
        4
    }

    fn piece_end(&self, i: usize) -> T {
        T::from_f64([0.25, 0.5, 0.75].get(i).copied().unwrap_or(1.0))
    }

    fn corner_at_end(&self, _i: usize) -> bool {
        true
    }
}
