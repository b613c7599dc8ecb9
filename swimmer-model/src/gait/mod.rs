//! Gaits: closed curves Φ(u) of joint angles over one cycle, u from 0 to 1.
//!
//! Displacement is independent of the time parametrisation, so u may be any parameter of the curve. For the energy, u is time
//! over the period. A small loop run counter-clockwise in the (φ₁, φ₂) plane swims forwards (X > 0).

mod fourier;
mod reversed;
mod sampled;
mod shapes;

pub use fourier::{Fourier, Harmonic, SymmetricFourier};
pub use reversed::Reversed;
pub use sampled::{InvalidSamples, Sampled};
pub use shapes::{Circle, Square};

use crate::Scalar;
use nalgebra::Vector2;

/// Joint angles and their rate at one point of a gait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaitPoint<T> {
    /// Φ = (φ₁, φ₂) \[rad\].
    pub phi: Vector2<T>,
    /// dΦ/du \[rad per cycle\]; at a corner, the rate on one of its sides.
    pub rate: Vector2<T>,
}

impl<T: Scalar> GaitPoint<T> {
    /// |dΦ/du| \[rad per cycle\].
    pub fn speed(&self) -> T {
        self.rate.dot(&self.rate).sqrt()
    }
}

/// A closed curve of joint angles, made of one or more smooth pieces.
///
/// A gait that is smooth everywhere only implements [`at`](Gait::at). A gait with corners also returns the ends of its pieces,
/// so that no integration step crosses a corner.
pub trait Gait<T: Scalar> {
    /// Angles and rate at `u`; any `u` is taken modulo 1.
    fn at(&self, u: T) -> GaitPoint<T>;

    /// Number of pieces within which the curve is smooth; at least 1.
    fn pieces(&self) -> usize {
        1
    }

    /// The u at which piece `i` ends and the next begins, increasing with `i`; 1 for the last.
    fn piece_end(&self, _i: usize) -> T {
        T::one()
    }

    /// Returns `true` if dΦ/du jumps at the end of piece `i` (for the last piece: across u = 1).
    fn corner_at_end(&self, _i: usize) -> bool {
        false
    }
}

impl<T: Scalar, G: Gait<T> + ?Sized> Gait<T> for &G {
    fn at(&self, u: T) -> GaitPoint<T> {
        (**self).at(u)
    }
    fn pieces(&self) -> usize {
        (**self).pieces()
    }
    fn piece_end(&self, i: usize) -> T {
        (**self).piece_end(i)
    }
    fn corner_at_end(&self, i: usize) -> bool {
        (**self).corner_at_end(i)
    }
}

/// `u` modulo 1, in [0, 1).
#[inline]
fn wrapped<T: Scalar>(u: T) -> T {
    let rest = u - u.floor();
    // A tiny negative u rounds to 1.
    if rest < T::one() { rest } else { T::zero() }
}

#[inline]
fn two_pi<T: Scalar>() -> T {
    T::from_f64(core::f64::consts::TAU)
}

/// Turns by 45°: (a, b) given along the diagonals φ₁ = φ₂ and φ₁ = −φ₂ (paper, Appendix C, `R_π/4`).
#[inline]
fn from_diagonals<T: Scalar>(v: Vector2<T>) -> Vector2<T> {
    let half_root = T::from_f64(core::f64::consts::FRAC_1_SQRT_2);
    Vector2::new((v.x - v.y) * half_root, (v.x + v.y) * half_root)
}
