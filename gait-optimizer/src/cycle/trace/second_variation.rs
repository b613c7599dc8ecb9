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

use nalgebra::Vector3;

/// What pushing a curve at one place does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Push {
    /// a, times λ₃.
    turn: f64,
    /// c.
    shift: f64,
    /// L.
    slope: f64,
}

/// The second variation, factored along the quarter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SecondVariation {
    u: f64,
    w: f64,
    /// The smallest W so far: 1 at the start, positive where the quarter is a maximum.
    pub(crate) least: f64,
}

impl Default for SecondVariation {
    fn default() -> Self {
        Self {
            u: 0.0,
            w: 1.0,
            least: 1.0,
        }
    }
}

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

impl SecondVariation {
    /// On over a stretch of a singular arc of this length, between pushes at its ends.
    pub(crate) fn step(&mut self, before: &Push, after: &Push, length: f64) {
        let middle = |value: fn(&Push) -> f64| 0.5 * (value(before) + value(after));
        let (a, c) = (middle(|push| push.turn), middle(|push| push.shift));
        let rate = length / middle(|push| push.slope);
        // The matrix of the system is nilpotent: the exponential has two terms.
        let common = rate * (a * self.w - c * self.u);
        self.u += a * common;
        self.w += c * common;
        self.least = self.least.min(self.w);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// W turns negative exactly where the dense matrix of the form has a negative direction.
    #[test]
    fn the_factorisation_agrees_with_a_dense_matrix() {
        let (count, length) = (200, 2.0);
        let step = length / f64::from(count);
        for strength in [0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 6.0] {
            for phase in [0.0, 1.0, 2.0, 3.0] {
                let push = |s: f64| Push {
                    turn: strength * (1.3 * s + phase).cos(),
                    shift: (0.7 * s - phase).sin(),
                    slope: 0.6 + 0.2 * s.sin(),
                };
                let mut form = SecondVariation::default();
                for i in 0..count {
                    let s = f64::from(i) * step;
                    form.step(&push(s), &push(s + step), step);
                }
                let at: Vec<Push> = (0..count)
                    .map(|i| push((f64::from(i) + 0.5) * step))
                    .collect();
                let matrix = DMatrix::from_fn(at.len(), at.len(), |i, j| {
                    let (first, last) = (at[i.min(j)], at[i.max(j)]);
                    let both = first.turn * last.shift * step;
                    if i == j { first.slope + both } else { both }
                });
                let least = matrix.symmetric_eigen().eigenvalues.min();
                if least.abs() > 0.02 {
                    assert_eq!(form.least > 0.0, least > 0.0, "{form:?} {least}");
                }
            }
        }
    }
}
