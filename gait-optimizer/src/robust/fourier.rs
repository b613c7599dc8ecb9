//! Efficiency: doubly symmetric Fourier gaits of order N, timed as parametrised.
//!
//! One gait is played to all members, so all share its timing: ξₖ = c_t L Xₖ² / Eₖ with Eₖ = ∫ Φ′ᵀWₖΦ′ du. (For a single
//! member the best timing is constant power, which the series approaches as N grows.) That is the objective of the efficiency
//! search, exact derivatives and all.

use nalgebra::{DMatrix, DVector};
use swimmer_model::{Model, Stroke, SymmetricFourier};

use super::newton::{Design, Family};
use super::{RobustError, cycle};
use crate::certificate::{Check, Condition};
use crate::cycle::Cycle;
use crate::efficiency::{Branch, Objective, starts};
use crate::member::Member;
use crate::numerics::damped;

/// Relative gradient norm, |∇ξ̄|/ξ̄ per radian, that counts as zero.
pub(super) const FLAT: f64 = 1e-9;
const STEPS: usize = 120;
const HALVINGS: usize = 30;
/// Longest step of the coefficients \[rad\].
const LONGEST: f64 = 0.05;
/// Curvatures of the objective smaller than this share of the largest one are raised to it.
const FLATTEST: f64 = 1e-7;

/// Fourier gaits of an order, around a start; a gait is its coefficients (A₁, B₁, A₂, B₂, …).
#[derive(Debug)]
pub(super) struct FourierFamily {
    start: DVector<f64>,
}

/// ln ξ̄ of a design, with its derivatives.
struct Weighted {
    log_xi: f64,
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

impl FourierFamily {
    /// The family of this order around the nominal optimum of a branch, found from circles with no other guess.
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

    /// The gait of these coefficients.
    pub(super) fn gait(x: &DVector<f64>) -> SymmetricFourier<Vec<[f64; 2]>> {
        let (coefficients, _) = x.as_slice().as_chunks();
        SymmetricFourier {
            coefficients: coefficients.to_vec(),
        }
    }

    /// ½ ln ξ of a member, over series as long as this one.
    fn objective<'a>(x: &DVector<f64>, member: &'a Member) -> Objective<'a> {
        let order = x.len() / 2;
        Objective::new(&member.model, order, 48 + 4 * order)
    }

    fn weighted(x: &DVector<f64>, members: &[(Member, f64)]) -> Weighted {
        let size = x.len();
        let (mut xi, mut slope) = (0.0, DVector::zeros(size));
        let mut bend = DMatrix::zeros(size, size);
        for (member, weight) in members.iter().filter(|(_, weight)| *weight != 0.0) {
            // The series is linear in its coefficients.
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
        Weighted {
            log_xi: xi.ln(),
            gradient,
            hessian,
        }
    }
}

impl Family for FourierFamily {
    const OBJECTIVE: swimmer_files::Objective = swimmer_files::Objective::Efficiency;
    const RELATIVE: bool = true;

    fn cycle(&self, _: &Model<f64>, x: &DVector<f64>) -> Cycle {
        cycle::of_series(&Self::gait(x))
    }

    /// Stationary, and a maximum: the largest curvature over the magnitude of the steepest.
    fn conditions(&self, x: &DVector<f64>, members: &[(Member, f64)]) -> Vec<Check> {
        let Weighted {
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

    /// Newton's ascent on ln ξ̄: along each principal direction uphill, by the distance that its curvature tells.
    fn solve(
        &self,
        start: &DVector<f64>,
        members: &[(Member, f64)],
    ) -> Result<DVector<f64>, RobustError> {
        let mut x = start.clone();
        let mut here = Self::weighted(&x, members);
        for _ in 0..STEPS {
            if here.gradient.norm() <= FLAT {
                return Ok(x);
            }
            let eigen = here.hessian.clone().symmetric_eigen();
            let floor = FLATTEST * eigen.eigenvalues.amax();
            let mut along = eigen.eigenvectors.tr_mul(&here.gradient);
            for (slope, curvature) in along.iter_mut().zip(eigen.eigenvalues.iter()) {
                *slope /= curvature.abs().max(floor);
            }
            let step = &eigen.eigenvectors * along;
            let most = (LONGEST / step.norm().max(f64::MIN_POSITIVE)).min(1.0);
            let next = damped(most).take(HALVINGS).find_map(|share| {
                let trial = &x + &step * share;
                let there = Self::weighted(&trial, members);
                // Near the top the value is rounding, and the gradient tells.
                let gains = there.log_xi > here.log_xi
                    || (there.log_xi > here.log_xi - 1e-13
                        && there.gradient.norm() < here.gradient.norm());
                gains.then_some((trial, there))
            });
            let Some(next) = next else { break };
            (x, here) = next;
        }
        let residual = here.gradient.norm();
        if residual <= 10.0 * FLAT {
            return Ok(x);
        }
        Err(RobustError::NotConverged { residual })
    }
}
