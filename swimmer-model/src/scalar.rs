//! Number type of the physics: `f32` on the chip, `f64` on the host.
//!
//! Transcendental functions go straight to `libm`, never to the platform's own library, so that host and chip compute
//! the same digits. The trait is open: an automatic-differentiation number can stand in (the tests do exactly that).

use core::ops::Neg;
use num_traits::NumAssign;

/// A real number that the model computes with.
pub trait Scalar: nalgebra::Scalar + Copy + PartialOrd + NumAssign + Neg<Output = Self> {
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;

    /// The nearest number of this type.
    fn from_f64(value: f64) -> Self;
    /// The value as `f64` (exact for `f32` and `f64`).
    fn to_f64(self) -> f64;
    /// Sine and cosine of an angle in radians.
    #[must_use]
    fn sin_cos(self) -> (Self, Self);
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Natural logarithm.
    #[must_use]
    fn ln(self) -> Self;
    /// Angle of the point (`x`, `self`) in (−π, π].
    #[must_use]
    fn atan2(self, x: Self) -> Self;
    /// Largest integer not above `self`.
    #[must_use]
    fn floor(self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// Magnitude.
    #[must_use]
    fn abs(self) -> Self {
        if self < Self::zero() { -self } else { self }
    }
    /// The smaller of two numbers.
    #[must_use]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// The larger of two numbers.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

macro_rules! through_libm {
    ($t:ty, $sincos:ident, $sqrt:path, $ln:ident, $atan2:ident, $floor:ident) => {
        impl Scalar for $t {
            const EPSILON: Self = <$t>::EPSILON;

            #[inline]
            #[allow(clippy::cast_possible_truncation)] // rounding to the nearest is intended
            fn from_f64(value: f64) -> Self {
                value as Self
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                libm::$sincos(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline]
            fn ln(self) -> Self {
                libm::$ln(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                libm::$atan2(self, x)
            }
            #[inline]
            fn floor(self) -> Self {
                libm::$floor(self)
            }
            #[inline]
            fn is_finite(self) -> bool {
                <$t>::is_finite(self)
            }
        }
    };
}
through_libm!(f32, sincosf, libm::sqrtf, logf, atan2f, floorf);
through_libm!(f64, sincos, sqrt, log, atan2, floor);

/// Square root rounded to the nearest, the same on every platform. In a browser it is the machine's instruction, which `libm`
/// uses on other platforms only.
#[inline]
fn sqrt(value: f64) -> f64 {
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    {
        use core::arch::wasm32::{f64x2_extract_lane, f64x2_splat, f64x2_sqrt};
        f64x2_extract_lane::<0>(f64x2_sqrt(f64x2_splat(value)))
    }
    #[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
    libm::sqrt(value)
}
