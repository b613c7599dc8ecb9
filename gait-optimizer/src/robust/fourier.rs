//! Robust efficiency gaits: doubly symmetric Fourier series of order N with their own timing.
//!
//! All members play the same gait with the same timing: ξₖ = c_t L Xₖ² / Eₖ with Eₖ = ∫ Φ′ᵀWₖΦ′ du. (For a single member the best
//! timing is constant power, which the series approaches as N grows.) The objective and its exact derivatives are those of the
//! efficiency search.

use nalgebra::{DMatrix, DVector};
use swimmer_model::{Model, Stroke, SymmetricFourier};

use super::newton::{Design, Family};
use super::{RobustError, cycle};
use crate::certificate::{Check, Condition};
use crate::cycle::Cycle;
use crate::efficiency::{Branch, Expansion, Objective, Value, climb, starts};
use crate::member::Member;

/// Predicted gain in ln ξ̄ at which the iteration has converged to rounding.
const LEAST_GAIN: f64 = 1e-20;

/// Family of Fourier gaits of one order around a start; a gait is its coefficients (A₁, B₁, A₂, B₂, …).
#[derive(Debug)]
pub(super) struct FourierFamily {
    start: DVector<f64>,
}

impl FourierFamily {
    /// Creates the family of this order around the nominal optimum of a branch, which is found from circles.
    pub(super) fn around(
        nominal: &Member,
        order: usize,
        branch: Branch,
    ) -> Result<Self, RobustError> {
        let starts = starts(&nominal.model, branch).unwrap_or_default();
        let ellipse = starts.first().ok_or(RobustError::Structure {
            problem: "no circle leads to a gait of this branch",
        })?;
        let mut family = Self {
            start: DVector::from_column_slice(ellipse),
        };
        for order in 1..=order {
            family.start = family.start.resize_vertically(2 * order, 0.0);
            family.start = family.solve(&family.start, &[(*nominal, 1.0)])?;
        }
        Ok(family)
    }

    /// Gait with these coefficients.
    pub(super) fn gait(x: &DVector<f64>) -> SymmetricFourier<Vec<[f64; 2]>> {
        let (coefficients, _) = x.as_slice().as_chunks();
        SymmetricFourier {
            coefficients: coefficients.to_vec(),
        }
    }

    /// ½ ln ξ of a member for series of this length.
    fn objective<'a>(x: &DVector<f64>, member: &'a Member) -> Objective<'a> {
        let order = x.len() / 2;
        Objective::new(&member.model, order, 48 + 4 * order)
    }

    /// ln ξ̄ of a design with its derivatives.
    fn weighted(x: &DVector<f64>, members: &[(Member, f64)]) -> Expansion {
        let size = x.len();
        let (mut xi, mut slope) = (0.0, DVector::zeros(size));
        let mut bend = DMatrix::zeros(size, size);
        for (member, weight) in members.iter().filter(|(_, weight)| *weight != 0.0) {
            // The curve is linear in its coefficients.
            let turned = x * member.gain;
            let found = Self::objective(x, member).expansion(turned.as_slice());
            let share = weight * (2.0 * found.value.objective).exp();
            let gradient = found.gradient * (2.0 * member.gain);
            bend += found.hessian * (2.0 * share * member.gain.powi(2));
            bend.ger(share, &gradient, &gradient, 1.0);
            slope += gradient * share;
            xi += share;
        }
        let gradient = slope / xi;
        let mut hessian = bend / xi;
        hessian.ger(-1.0, &gradient, &gradient, 1.0);
        let value = Value {
            objective: xi.ln(),
            x: xi,
            power_length: 1.0,
        };
        Expansion {
            value,
            gradient,
            hessian,
        }
    }
}

impl Family for FourierFamily {
    const OBJECTIVE: swimmer_files::Objective = swimmer_files::Objective::Efficiency;

    fn cycle(&self, _: &Model<f64>, x: &DVector<f64>) -> Cycle {
        cycle::of_series(&Self::gait(x))
    }

    /// Conditions of a stationary point and of a maximum: the largest eigenvalue of the Hessian over the largest magnitude.
    fn conditions(&self, x: &DVector<f64>, members: &[(Member, f64)]) -> Vec<Check> {
        let Expansion {
            gradient, hessian, ..
        } = Self::weighted(x, members);
        let curvatures = hessian.symmetric_eigenvalues();
        vec![
            Condition::RobustGradient.check(gradient.norm()),
            Condition::RobustCurvature.check(curvatures.max() / curvatures.amax()),
        ]
    }
}

impl Design for FourierFamily {
    type Point = DVector<f64>;

    fn start(&self) -> DVector<f64> {
        self.start.clone()
    }

    fn value(&self, x: &DVector<f64>, member: &Member) -> f64 {
        let turned = x * member.gain;
        let value = Self::objective(x, member).value(turned.as_slice());
        (2.0 * value.objective).exp()
    }

    fn swum(&self, _: &DVector<f64>, stroke: &Stroke<f64>) -> f64 {
        stroke.efficiency()
    }

    /// Maximises ln ξ̄ by the ascent of the efficiency search.
    fn solve(
        &self,
        start: &DVector<f64>,
        members: &[(Member, f64)],
    ) -> Result<DVector<f64>, RobustError> {
        let look = |x: &[f64]| Self::weighted(&DVector::from_column_slice(x), members);
        let top = climb(look, start.as_slice(), LEAST_GAIN);
        let top = top.map(|top| DVector::from_vec(top.coefficients));
        top.ok_or(RobustError::NotConverged {
            residual: f64::INFINITY,
        })
    }
}
