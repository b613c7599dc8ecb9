//! Shapes at which two links cross, which a robot with plates cannot take.
//!
//! The side links meet well inside |φ| < π: along φ₁ = φ₂ from arccos(−l₀/2l₁) on. Adjacent links share a joint and
//! overlap only where a side link is folded flat onto the middle one, |φ| = π; that shape counts as crossing (the set is
//! closed there), and one on which the side links' tips merely touch does not.

use crate::{Links, Model, Scalar};
use nalgebra::Vector2;

impl<T: Scalar> Links<T> {
    /// Overlap of the side links at shape Φ \[m\]: positive if they cross, negative if they do not, and continuous in between.
    ///
    /// The lines of the side links meet in a triangle over the middle link, with sides l₀ sin φ₂ / d and l₀ sin φ₁ / d,
    /// d = −sin(φ₁ + φ₂) (law of sines). The links cross if both sides are positive and not longer than the links: four
    /// inequalities, each multiplied by |d| here; the overlap is the tightest of them.
    pub fn overlap(&self, phi: &Vector2<T>) -> T {
        let (sin1, cos1) = phi.x.sin_cos();
        let (sin2, cos2) = phi.y.sin_cos();
        let d = -(sin1 * cos2 + cos1 * sin2);
        let above = |side: T| {
            let (s1, s2, d) = (
                side * self.middle * sin1,
                side * self.middle * sin2,
                side * d,
            );
            s1.min(s2).min(self.front * d - s2).min(self.back * d - s1)
        };
        above(T::one()).max(above(-T::one()))
    }

    /// Returns `true` if the side links cross at shape Φ, or if one of them is folded onto the middle link.
    pub fn cross(&self, phi: &Vector2<T>) -> bool {
        self.overlap(phi) > T::zero()
            || flatness(phi.x) >= T::zero()
            || flatness(phi.y) >= T::zero()
    }
}

impl<T: Scalar> Model<T> {
    /// Returns `true` if two links cross at shape Φ ([`Links::cross`]).
    pub fn links_cross(&self, phi: &Vector2<T>) -> bool {
        self.swimmer().links.cross(phi)
    }
}

/// Distance from |φ| = π \[rad\] below which a side link counts as folded onto the middle link; solvers and files are no more
/// accurate at a bound.
const FLAT: f64 = 1e-8;

/// Negative distance of the angle, modulo full turns, from |φ| = π, plus [`FLAT`] \[rad\]: not negative if the link is folded
/// flat, and continuous near that shape.
pub(crate) fn flatness<T: Scalar>(phi: T) -> T {
    let (sin, cos) = phi.sin_cos();
    if cos < T::zero() {
        T::from_f64(FLAT).max(T::EPSILON * phi.abs()) - sin.abs()
    } else {
        -T::one()
    }
}
