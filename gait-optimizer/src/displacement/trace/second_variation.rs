//! Is a quarter of singular arcs a maximum of the displacement, or only stationary?
//!
//! Push the curve by v(s) to its right (the outside), with v = 0 on bounds, whose multiplier holds the curve there. With the
//! connection's curvature (x, y, θ) in the body's frame, a push turns the rest of the way by a v, where a is its θ part, and
//! shifts it sideways by b v, where b is its part across the starting heading. Both change what pushes further on are worth,
//! and the second variation of the displacement λ₃ x at the end (`x_f`) is
//!
//! ```text
//! δ² = −∫ L v² ds − 2 λ₃ ∫∫_{σ<s} a(σ) c(s) v(σ) v(s) dσ ds,      c = b + a (x_f − x),
//! ```
//!
//! with L the slope of the height to the left (positive by the generalised Legendre–Clebsch condition). Eliminating v from
//! the start on leaves L − q-terms with `q̇ = (a − q c)²/L` (a Cholesky factorisation of the form in the limit of fine
//! steps); δ² < 0 for all v as long as q stays finite. With q = U/W this is the linear system
//! `(U, W)˙ = (−a c U + a² W, −c² U + a c W)/L` from (0, 1), and W = 0 is a conjugate point. Along bounds nothing changes.
//!
//! [`is_maximum_without_symmetry`] asks the same of the whole cycle and of pushes of any kind that turn nothing, ∫ a v = 0. With d
//! for `x_f` they also move the end sideways by ∫ c v, and
//!
//! ```text
//! δ² = −∫ L v² ds − 2 λ₃ ∫ A c v ds + K²/|d|,      A' = a v,  K' = c v,  A = 0 at both ends.
//! ```
//!
//! Of all v that lead to one (A, K) the best has `v = (α a + κ c − λ₃ A c)/L`, `α' = λ₃ c v`, κ constant: it is best as long as no
//! two (α, κ) lead to the same place, and with it δ² = −K κ + K²/|d|.

use nalgebra::{Matrix2, Vector2, Vector3};

/// What pushing a curve at one place does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Push {
    /// a, times λ₃.
    turn: f64,
    /// c.
    shift: f64,
    /// L.
    pub(super) slope: f64,
}

/// A stretch of a singular arc: pushes at its ends, and its length.
pub(crate) type Stretch = (Push, Push, f64);

impl Push {
    /// From λ₃, the curvature (over L) in the body's frame, the heading, `x_f − x` and the slope of the height to the left.
    pub(crate) fn new(
        sign: f64,
        curvature: &Vector3<f64>,
        theta: f64,
        ahead: f64,
        slope: f64,
    ) -> Self {
        let (sin, cos) = theta.sin_cos();
        let sideways = sin * curvature.x + cos * curvature.y;
        Self {
            turn: sign * curvature.z,
            shift: sideways + ahead * curvature.z,
            slope,
        }
    }
}

/// a, c and the length over L of a short stretch, along which v keeps its value.
fn middle((before, after, length): &Stretch) -> [f64; 3] {
    [
        0.5 * (before.turn + after.turn),
        0.5 * (before.shift + after.shift),
        length / (0.5 * (before.slope + after.slope)),
    ]
}

/// The smallest W along a quarter with these free stretches: 1 at the start, positive where the quarter is a maximum.
pub(crate) fn least_pivot(quarter: &[Stretch]) -> f64 {
    let (mut u, mut w, mut least) = (0.0, 1.0, 1.0_f64);
    for stretch in quarter {
        let [a, c, rate] = middle(stretch);
        // The matrix of the system is nilpotent: the exponential has two terms.
        let common = rate * (a * w - c * u);
        u += a * common;
        w += c * common;
        least = least.min(w);
    }
    least
}

impl Push {
    /// Of the same push in another quarter of a cycle that carries `d` to the frame of its start, from that of the first quarter,
    /// which carries a quarter of it; λ₃ has the sign of `d`.
    fn in_quarter(&self, quarter: usize, d: f64) -> Self {
        let a = d.signum() * self.turn;
        let c = self.shift + 0.75 * d * a;
        let (a, c) = match quarter {
            1 => (-a, c - 1.5 * d * a),
            2 => (-a, 0.5 * d * a - c),
            3 => (a, d * a - c),
            _ => (a, c),
        };
        Self {
            turn: a,
            shift: c,
            slope: self.slope,
        }
    }
}

/// Whether a cycle that carries `d` over L, made of a quarter with these free stretches, is a maximum among closed curves of any
/// symmetry, to second order.
pub(crate) fn is_maximum_without_symmetry(quarter: &[Stretch], d: f64) -> bool {
    /// Rounding leaves less of the determinant open, over the square of the trace.
    const ROUNDING: f64 = 1e-12;
    let sign = d.signum();
    // Where the two unit choices of (α, κ) lead, and their α.
    let mut places = Matrix2::zeros();
    let mut alpha = Vector2::new(1.0, 0.0);
    let kappa = Vector2::new(0.0, 1.0);
    for number in 0..4 {
        let backwards = number % 2 == 1;
        for at in 0..quarter.len() {
            let last = quarter.len() - 1;
            let (before, after, length) = quarter[if backwards { last - at } else { at }];
            let [before, after] = [before, after].map(|push| push.in_quarter(number, d));
            let [a, c, rate] = middle(&(before, after, length));
            let turned = places.row(0).transpose();
            let swept = (alpha * a + kappa * c - turned * (sign * c)) * rate;
            places += Vector2::new(a, c) * swept.transpose();
            alpha += swept * (sign * c);
            if places.determinant() < -ROUNDING * places.trace().powi(2) {
                return false;
            }
        }
    }
    // κ that leads to K = 1 with A = 0.
    places
        .try_inverse()
        .is_some_and(|by| by.m22 * d.abs() > 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Pushes of unlike strengths: cases with conjugate points and without.
    fn push(strength: f64, phase: f64, s: f64) -> Push {
        Push {
            turn: strength * (1.3 * s + phase).cos(),
            shift: (0.7 * s - phase).sin(),
            slope: 0.6 + 0.2 * s.sin(),
        }
    }

    /// A cycle is no maximum exactly where the dense matrix of the whole form has a negative direction that turns nothing.
    #[test]
    fn the_whole_cycle_agrees_with_a_dense_matrix() {
        let (count, length) = (60, 2.0);
        let step = length / f64::from(count);
        let mut maxima = [0, 0];
        for case in 0..400 {
            let strength = 0.02 * f64::from(case % 20) + 0.02;
            let phase = 0.7 * f64::from(case / 20);
            let d = if case % 2 == 0 { 0.4 } else { -1.5 };
            let push = |s: f64| {
                let push = push(strength, phase, s);
                let shift = strength * push.shift;
                Push { shift, ..push }
            };
            let stretch = |i: i32| {
                let s = f64::from(i) * step;
                (push(s), push(s + step), step)
            };
            let quarter: Vec<Stretch> = (0..count).map(stretch).collect();
            let found = is_maximum_without_symmetry(&quarter, d);
            let middles = |number: usize| {
                let at = |i: i32| push((f64::from(i) + 0.5) * step);
                let mut middles: Vec<Push> =
                    (0..count).map(|i| at(i).in_quarter(number, d)).collect();
                if number % 2 == 1 {
                    middles.reverse();
                }
                middles
            };
            let at: Vec<Push> = (0..4).flat_map(middles).collect();
            let sums = at
                .iter()
                .fold([0.0; 2], |[a, c], push| [a + push.turn, c + push.shift]);
            // Pushes that keep the symmetries neither turn nor move aside.
            assert!(sums.iter().all(|sum| sum.abs() < 1e-9), "{sums:?}");
            let form = DMatrix::from_fn(at.len(), at.len(), |i, j| {
                let (first, last) = (at[i.min(j)], at[i.max(j)]);
                let both = d.signum() * first.turn * last.shift * step
                    - at[i].shift * at[j].shift * step / d.abs();
                if i == j { first.slope + both } else { both }
            });
            let turn = DVector::from_iterator(at.len(), at.iter().map(|push| push.turn));
            let turn = turn.normalize();
            let across = DMatrix::identity(at.len(), at.len()) - &turn * turn.transpose();
            let mut values: Vec<f64> = (&across * form * &across)
                .symmetric_eigenvalues()
                .iter()
                .copied()
                .collect();
            values.sort_by(f64::total_cmp);
            // One of them is the direction that is left out.
            let least = if values[0] < -1e-9 {
                values[0]
            } else {
                values[1]
            };
            if least.abs() > 0.02 {
                assert_eq!(found, least > 0.0, "{case}: {least}");
                maxima[usize::from(found)] += 1;
            }
        }
        assert!(maxima.iter().all(|&count| count > 40), "{maxima:?}");
    }
}
