//! Newton's method with a finite-difference Jacobian, and the interface of a family of gaits for robust design.

use nalgebra::{DMatrix, DVector};
use swimmer_files::Objective;
use swimmer_model::{Model, Stroke};

use super::RobustError;
use crate::certificate::Check;
use crate::cycle::Cycle;
use crate::member::Member;
use crate::numerics::damped;

/// Family of gaits in which the optimum of a weighted sum over swimmers can be computed.
pub(super) trait Design {
    /// Gait of the family.
    type Point: Clone;
    /// `true` if re-integrated values are compared by relative difference.
    const RELATIVE: bool = true;

    /// Nominal optimum.
    fn start(&self) -> Self::Point;

    /// Objective of a member, to be maximised.
    fn value(&self, point: &Self::Point, member: &Member) -> f64;

    /// Objective from the model's own integration of the gait.
    fn swum(&self, point: &Self::Point, stroke: &Stroke<f64>) -> f64;

    /// Factor from the objective to the reported value.
    fn unit(&self) -> f64 {
        1.0
    }

    /// Stationary point of the weighted sum near `start`.
    fn solve(
        &self,
        start: &Self::Point,
        members: &[(Member, f64)],
    ) -> Result<Self::Point, RobustError>;
}

/// Family of gaits with the paper's symmetries.
pub(super) trait Family: Design {
    const OBJECTIVE: Objective;

    /// Sampled cycle, at constant power of this model or with the family's own timing.
    fn cycle(&self, model: &Model<f64>, point: &Self::Point) -> Cycle;

    /// First- and second-order conditions of the weighted sum.
    fn conditions(&self, point: &Self::Point, members: &[(Member, f64)]) -> Vec<Check>;
}

const STEPS: usize = 40;
const HALVINGS: usize = 12;
/// Step of the finite differences. Their error slows the last iterations slightly and does not shift the root.
const DIFFERENCE: f64 = 1e-7;
/// Reduction of the residual per step at which the Jacobian is kept.
const GOOD: f64 = 0.05;

/// Root of `residual` near `start`, to `tolerance` in the largest component. No component changes by more than `longest` in a step.
pub(super) fn newton(
    residual: impl Fn(&DVector<f64>) -> DVector<f64>,
    start: DVector<f64>,
    tolerance: f64,
    longest: f64,
) -> Result<DVector<f64>, RobustError> {
    let mut x = start;
    let mut r = residual(&x);
    let mut lu = None;
    for _ in 0..=STEPS {
        let before = r.amax();
        if before <= tolerance {
            return Ok(x);
        }
        let lu_here = lu
            .take()
            .unwrap_or_else(|| jacobian(&residual, &x, &r).lu());
        let step = lu_here.solve(&r);
        let step = step.filter(|step| step.iter().all(|s| s.is_finite()));
        let better = step.and_then(|step| {
            let most = (longest / step.amax().max(f64::MIN_POSITIVE)).min(1.0);
            damped(most).take(HALVINGS).find_map(|share| {
                let trial = &x - &step * share;
                let there = residual(&trial);
                (there.amax() < before).then_some((trial, there))
            })
        });
        let Some(better) = better else {
            // Near rounding a step may not reduce the residual further.
            if before <= 10.0 * tolerance {
                return Ok(x);
            }
            break;
        };
        (x, r) = better;
        lu = (r.amax() <= GOOD * before).then_some(lu_here);
    }
    Err(RobustError::NotConverged { residual: r.amax() })
}

fn jacobian(
    residual: &impl Fn(&DVector<f64>) -> DVector<f64>,
    x: &DVector<f64>,
    here: &DVector<f64>,
) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = (0..x.len())
        .map(|i| {
            let mut x = x.clone();
            x[i] += DIFFERENCE;
            (residual(&x) - here) / DIFFERENCE
        })
        .collect();
    DMatrix::from_columns(&columns)
}
