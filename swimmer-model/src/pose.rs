//! Poses in the plane: elements of SE(2).

use crate::Scalar;
use core::ops::Mul;
use nalgebra::{Vector2, Vector3};

/// Position of the middle link's centre \[m\] and its heading \[rad\] (not wrapped: full turns count).
///
/// ```
/// use swimmer_model::Pose;
///
/// let turned = Pose::<f64>::new(1.0, 2.0, std::f64::consts::FRAC_PI_2);
/// let there_and_back = turned * turned.inverse();
/// assert!(there_and_back.x.abs() < 1e-15 && there_and_back.theta == 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<T> {
    /// x \[m\].
    pub x: T,
    /// y \[m\].
    pub y: T,
    /// θ \[rad\].
    pub theta: T,
}

/// The same angle \[rad\] within half a turn of 0.
///
/// ```
/// use std::f64::consts::{PI, TAU};
///
/// assert_eq!(swimmer_model::wrapped_angle(3.0), 3.0);
/// assert!((swimmer_model::wrapped_angle(PI + 0.5) - (0.5 - PI)).abs() < 1e-15);
/// assert!((swimmer_model::wrapped_angle(-3.0 * TAU - 0.25) + 0.25).abs() < 1e-14);
/// ```
pub fn wrapped_angle(angle: f64) -> f64 {
    let turn = core::f64::consts::TAU;
    angle - turn * libm::round(angle / turn)
}

impl<T: Scalar> Pose<T> {
    /// A pose from its coordinates.
    pub fn new(x: T, y: T, theta: T) -> Self {
        Self { x, y, theta }
    }

    /// The origin, heading along x.
    pub fn identity() -> Self {
        Self::new(T::zero(), T::zero(), T::zero())
    }

    /// Position (x, y).
    pub fn position(&self) -> Vector2<T> {
        Vector2::new(self.x, self.y)
    }

    /// The pose g⁻¹ with g g⁻¹ = identity.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let (sin, cos) = self.theta.sin_cos();
        Self::new(
            -(cos * self.x + sin * self.y),
            sin * self.x - cos * self.y,
            -self.theta,
        )
    }

    /// A point given in this pose's frame, seen from the world.
    pub fn transform(&self, point: &Vector2<T>) -> Vector2<T> {
        let (sin, cos) = self.theta.sin_cos();
        Vector2::new(
            self.x + cos * point.x - sin * point.y,
            self.y + sin * point.x + cos * point.y,
        )
    }

    /// The pose reached from the identity by moving at the constant body velocity (v_x, v_y, ω) for one unit of time.
    /// A small step of the swimmer is `pose * Pose::exp(&(A ΔΦ))`.
    pub fn exp(twist: &Vector3<T>) -> Self {
        let half = twist.z * T::from_f64(0.5);
        let (sin, cos) = half.sin_cos();
        // sin(h)/h; the series replaces the quotient near h = 0.
        let sinc = if half.abs() < T::EPSILON.sqrt() {
            T::one() - half * half / T::from_f64(6.0)
        } else {
            sin / half
        };
        let (forward, left) = (sinc * cos, sinc * sin);
        Self::new(
            forward * twist.x - left * twist.y,
            left * twist.x + forward * twist.y,
            twist.z,
        )
    }
}

impl<T: Scalar> Mul for Pose<T> {
    type Output = Self;

    /// Composition: `self`, then `other` as seen from it.
    #[allow(clippy::suspicious_arithmetic_impl)] // headings add
    fn mul(self, other: Self) -> Self {
        let p = self.transform(&other.position());
        Self::new(p.x, p.y, self.theta + other.theta)
    }
}
