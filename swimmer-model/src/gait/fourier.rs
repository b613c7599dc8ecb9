//! Gaits as truncated Fourier series: the paper's doubly symmetric one (Appendix C) and the general closed curve.
//!
//! The coefficients may be in any storage that can be borrowed as a slice: an array, a slice, or a `Vec` on the host.

use super::{Gait, GaitPoint, from_diagonals, two_pi, wrapped};
use crate::Scalar;
use nalgebra::Vector2;

/// Symmetric about both diagonals: Φ = `R_π/4` (Σ Aₙ cos((2n−1)s), Σ Bₙ sin((2n−1)s)), s = 2πu (paper, Appendix C).
///
/// It starts on φ₁ = φ₂, on the positive side if Σ Aₙ > 0. The coefficients are pairs \[Aₙ, Bₙ\], n = 1, 2, …
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetricFourier<C> {
    /// Pairs \[Aₙ, Bₙ\] \[rad\].
    pub coefficients: C,
}

impl<T: Scalar, C: AsRef<[[T; 2]]>> Gait<T> for SymmetricFourier<C> {
    fn at(&self, u: T) -> GaitPoint<T> {
        let (sin, cos) = (two_pi::<T>() * wrapped(u)).sin_cos();
        let twice = (sin * cos + sin * cos, cos * cos - sin * sin);
        let mut turn = (sin, cos);
        let mut order = T::one();
        let (mut phi, mut rate) = (Vector2::zeros(), Vector2::zeros());
        for &[a, b] in self.coefficients.as_ref() {
            let speed = two_pi::<T>() * order;
            phi += Vector2::new(a * turn.1, b * turn.0);
            rate += Vector2::new(-speed * a * turn.0, speed * b * turn.1);
            turn = add_angles(turn, twice);
            order += T::from_f64(2.0);
        }
        GaitPoint {
            phi: from_diagonals(phi),
            rate: from_diagonals(rate),
        }
    }
}

/// One harmonic of a closed curve: cos · cos(2πku) + sin · sin(2πku).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic<T> {
    /// Cosine coefficients of (φ₁, φ₂) \[rad\].
    pub cos: Vector2<T>,
    /// Sine coefficients of (φ₁, φ₂) \[rad\].
    pub sin: Vector2<T>,
}

/// Any smooth closed curve: Φ = mean + Σₖ (cosₖ cos(2πku) + sinₖ sin(2πku)), k = 1, 2, …
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fourier<T, C> {
    /// Mean of (φ₁, φ₂) \[rad\].
    pub mean: Vector2<T>,
    /// Harmonics k = 1, 2, …
    pub harmonics: C,
}

impl<T: Scalar, C: AsRef<[Harmonic<T>]>> Gait<T> for Fourier<T, C> {
    fn at(&self, u: T) -> GaitPoint<T> {
        let first = (two_pi::<T>() * wrapped(u)).sin_cos();
        let mut turn = first;
        let mut order = T::one();
        let (mut phi, mut rate) = (self.mean, Vector2::zeros());
        for harmonic in self.harmonics.as_ref() {
            let speed = two_pi::<T>() * order;
            phi += harmonic.cos * turn.1 + harmonic.sin * turn.0;
            rate += harmonic.sin * (speed * turn.1) - harmonic.cos * (speed * turn.0);
            turn = add_angles(turn, first);
            order += T::one();
        }
        GaitPoint { phi, rate }
    }
}

/// Sine and cosine of a sum of two angles given by theirs.
#[inline]
fn add_angles<T: Scalar>(a: (T, T), b: (T, T)) -> (T, T) {
    (a.0 * b.1 + a.1 * b.0, a.1 * b.1 - a.0 * b.0)
}
