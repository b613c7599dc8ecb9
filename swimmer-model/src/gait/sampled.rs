//! Gait interpolated through samples, as gait files and tables hold them.
//!
//! Between knots a cubic Hermite polynomial, C¹, fourth order. The slope at a knot is the derivative there of the
//! polynomial through the five nearest knots on the same side of every corner: exact for quartics, local, and independent of
//! knots beyond a corner. The spacing of the knots is arbitrary. The curve closes exactly, because knot 0 is also the knot at
//! u = 1.

use super::{Gait, GaitPoint, wrapped};
use crate::Scalar;
use core::fmt;
use nalgebra::Vector2;

/// A closed curve through knots (uᵢ, Φᵢ), smooth but for marked corners. Borrows its samples.
///
/// ```
/// use nalgebra::Vector2;
/// use swimmer_model::{Gait, Sampled};
///
/// let angle = |k: u8| std::f64::consts::TAU * f64::from(k) / 60.0;
/// let u: Vec<f64> = (0..60).map(|k| f64::from(k) / 60.0).collect();
/// let phi: Vec<_> = (0..60).map(|k| Vector2::new(angle(k).cos(), angle(k).sin())).collect();
/// let circle = Sampled::new(&u, &phi, &[])?;
/// assert!((circle.at(0.123).phi.norm() - 1.0).abs() < 1e-6);
/// # Ok::<(), swimmer_model::InvalidSamples>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled<'a, T> {
    u: &'a [T],
    phi: &'a [Vector2<T>],
    corners: &'a [usize],
}

/// Violation of the rules for samples of a gait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InvalidSamples {
    /// A closed curve needs at least two different knots.
    TooFew {
        /// Number of knots.
        knots: usize,
    },
    /// u and Φ differ in length.
    Lengths {
        /// Number of u.
        u: usize,
        /// Number of Φ.
        phi: usize,
    },
    /// The first knot must be at u = 0.
    Start {
        /// u of the first knot.
        u: f64,
    },
    /// u must increase from knot to knot, stay below 1 (but for a last knot that repeats the first), and be finite.
    Order {
        /// The first knot out of order.
        knot: usize,
        /// Its u.
        u: f64,
    },
    /// An angle is not finite.
    Angle {
        /// The knot.
        knot: usize,
    },
    /// A last knot at u = 1 must repeat the first.
    Open {
        /// Distance between both \[rad\].
        gap: f64,
    },
    /// Corners must be increasing numbers of knots.
    Corner {
        /// The offending entry.
        corner: usize,
    },
}

impl fmt::Display for InvalidSamples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooFew { knots } => write!(
                f,
                "a sampled gait needs at least 2 knots before u = 1 and has {knots}"
            ),
            Self::Lengths { u, phi } => write!(
                f,
                "a sampled gait has {u} values of u but {phi} of (phi1, phi2)"
            ),
            Self::Start { u } => write!(f, "a sampled gait must start at u = 0 and starts at {u}"),
            Self::Order { knot, u } => write!(
                f,
                "u must increase from 0 and stay below 1 (a last knot at 1 repeats the first), but knot {knot} has u = {u}"
            ),
            Self::Angle { knot } => write!(f, "an angle of knot {knot} is not a finite number"),
            Self::Open { gap } => {
                write!(
                    f,
                    "the last knot, at u = 1, is {gap} rad away from the first; make it repeat the first or drop it"
                )
            }
            Self::Corner { corner } => {
                write!(
                    f,
                    "corner {corner} is no knot, or not above the corner before it; give increasing knot numbers"
                )
            }
        }
    }
}

impl core::error::Error for InvalidSamples {}

/// Number of knots that determine a slope.
const STENCIL: usize = 5;

impl<'a, T: Scalar> Sampled<'a, T> {
    /// A gait through Φᵢ \[rad\] at uᵢ, u₀ = 0, increasing, below 1. A last knot at u = 1 that repeats the first to
    /// rounding is accepted and left out. `corners` are the numbers of the knots where the rate may jump, increasing.
    ///
    /// # Errors
    /// [`InvalidSamples`] names the knot and the rule that it violates.
    pub fn new(
        u: &'a [T],
        phi: &'a [Vector2<T>],
        corners: &'a [usize],
    ) -> Result<Self, InvalidSamples> {
        if u.len() != phi.len() {
            return Err(InvalidSamples::Lengths {
                u: u.len(),
                phi: phi.len(),
            });
        }
        if let Some(knot) = phi
            .iter()
            .position(|p| !(p.x.is_finite() && p.y.is_finite()))
        {
            return Err(InvalidSamples::Angle { knot });
        }
        let (u, phi) = without_repeated_end(u, phi)?;
        if u.len() < 2 {
            return Err(InvalidSamples::TooFew { knots: u.len() });
        }
        if u[0] != T::zero() {
            return Err(InvalidSamples::Start { u: u[0].to_f64() });
        }
        let ordered = |knot: &usize| u[*knot] > u[knot - 1] && u[*knot] < T::one();
        if let Some(knot) = (1..u.len()).find(|knot| !ordered(knot)) {
            return Err(InvalidSamples::Order {
                knot,
                u: u[knot].to_f64(),
            });
        }
        let mut next = 0;
        for &corner in corners {
            if corner < next || corner >= u.len() {
                return Err(InvalidSamples::Corner { corner });
            }
            next = corner + 1;
        }
        Ok(Self { u, phi, corners })
    }

    /// Number of knots before u = 1.
    pub fn knots(&self) -> usize {
        self.u.len()
    }

    /// dΦ/du before and after a knot; both are equal except at a corner.
    pub fn slopes(&self, knot: usize) -> [Vector2<T>; 2] {
        let knot = knot.cast_signed();
        let after = self.slope(knot, 1);
        let before = if self.is_corner(knot) {
            self.slope(knot, -1)
        } else {
            after
        };
        [before, after]
    }

    /// u of a knot counted on through any number of cycles, forwards and backwards.
    fn unrolled_u(&self, knot: isize) -> T {
        let (cycle, i) = self.split(knot);
        self.u[i] + T::from_f64(cycle)
    }

    fn unrolled_phi(&self, knot: isize) -> Vector2<T> {
        self.phi[self.split(knot).1]
    }

    /// Cycle and number within it of an unrolled knot.
    fn split(&self, knot: isize) -> (f64, usize) {
        let n = self.u.len().cast_signed();
        (knot.div_euclid(n) as f64, knot.rem_euclid(n).unsigned_abs())
    }

    fn is_corner(&self, knot: isize) -> bool {
        !self.corners.is_empty() && self.corners.binary_search(&self.split(knot).1).is_ok()
    }

    /// dΦ/du at unrolled knot `i`, seen from the interval on its right (`step` = 1) or left (`step` = −1).
    fn slope(&self, i: isize, step: isize) -> Vector2<T> {
        // Grow a window of knots around i, alternately on both sides, stopping each side at a corner.
        let (mut lo, mut hi) = (i, i);
        let mut open = if self.is_corner(i) {
            (step < 0, step > 0)
        } else {
            (true, true)
        };
        // An odd number, so that away from corners it is even on both sides.
        let most = STENCIL.min((self.u.len() + 1) | 1).cast_signed();
        while hi - lo + 1 < most && (open.0 || open.1) {
            if open.0 && (!open.1 || i - lo <= hi - i) {
                lo -= 1;
                open.0 = !self.is_corner(lo);
            } else {
                hi += 1;
                open.1 = !self.is_corner(hi);
            }
        }
        self.derivative_through(lo, hi, i)
    }

    /// Derivative at knot `i` of the polynomial through knots `lo..=hi`, in Lagrange's form.
    fn derivative_through(&self, lo: isize, hi: isize, i: isize) -> Vector2<T> {
        let here = self.unrolled_u(i);
        let mut slope = Vector2::zeros();
        for j in (lo..=hi).filter(|&j| j != i) {
            let there = self.unrolled_u(j);
            let others = (lo..=hi)
                .filter(|&k| k != i && k != j)
                .map(|k| self.unrolled_u(k));
            let weight = others.fold(T::one() / (there - here), |w, u| {
                w * (here - u) / (there - u)
            });
            slope += (self.unrolled_phi(j) - self.unrolled_phi(i)) * weight;
        }
        slope
    }
}

/// Leaves out a last knot at u = 1 that repeats the first.
fn without_repeated_end<'a, T: Scalar>(
    u: &'a [T],
    phi: &'a [Vector2<T>],
) -> Result<(&'a [T], &'a [Vector2<T>]), InvalidSamples> {
    match (u.split_last(), phi.split_last(), phi.first()) {
        (Some((&end, u_rest)), Some((last, phi_rest)), Some(first)) if end == T::one() => {
            let gap = largest(last - first);
            let rounding = T::from_f64(64.0) * T::EPSILON * (T::one() + largest(*first));
            if gap <= rounding {
                Ok((u_rest, phi_rest))
            } else {
                Err(InvalidSamples::Open { gap: gap.to_f64() })
            }
        }
        _ => Ok((u, phi)),
    }
}

/// The larger magnitude of two angles.
fn largest<T: Scalar>(v: Vector2<T>) -> T {
    v.x.abs().max(v.y.abs())
}

impl<T: Scalar> Gait<T> for Sampled<'_, T> {
    fn at(&self, u: T) -> GaitPoint<T> {
        let u = wrapped(u);
        // The last knot not beyond u. It exists, since knot 0 is at 0.
        let i = self
            .u
            .partition_point(|&knot| knot <= u)
            .max(1)
            .cast_signed()
            - 1;
        let (start, end) = (self.unrolled_phi(i), self.unrolled_phi(i + 1));
        let h = self.unrolled_u(i + 1) - self.unrolled_u(i);
        let (m0, m1) = (self.slope(i, 1), self.slope(i + 1, -1));
        let s = (u - self.unrolled_u(i)) / h;
        let (two, three) = (T::from_f64(2.0), T::from_f64(3.0));
        // Newton form of the cubic: start, chord, and deviation of both slopes from the chord.
        let chord = (end - start) / h;
        let (off0, off1) = (m0 - chord, m1 - chord);
        let rest = T::one() - s;
        GaitPoint {
            phi: start + (chord * s + (off0 * rest - off1 * s) * (s * rest)) * h,
            rate: chord + off0 * (rest * (T::one() - three * s)) + off1 * (s * (three * s - two)),
        }
    }

    fn pieces(&self) -> usize {
        self.u.len()
    }

    fn piece_end(&self, i: usize) -> T {
        self.u.get(i + 1).copied().unwrap_or(T::one())
    }

    fn corner_at_end(&self, i: usize) -> bool {
        self.is_corner((i + 1).cast_signed())
    }
}
