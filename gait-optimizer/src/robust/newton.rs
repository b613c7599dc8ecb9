//! Newton's method with a Jacobian by differences, and what a family of gaits must offer to be designed robustly.

use nalgebra::{DMatrix, DVector};
use swimmer_files::Objective;
use swimmer_model::{Model, Stroke};

use super::RobustError;
use crate::certificate::Check;
use crate::cycle::Cycle;
use crate::member::Member;
use crate::numerics::damped;

/// A family of gaits in which the best for a weighted sum over swimmers can be found.
pub(super) trait Design {
    /// A gait of the family.
    type Point: Clone;
    /// Whether values swum again are compared relatively.
    const RELATIVE: bool = true;

    /// The nominal optimum.
    fn start(&self) -> Self::Point;

    /// The objective of a member; larger is better.
    fn value(&self, point: &Self::Point, member: &Member) -> f64;

    /// The same of a gait swum by the model's own integration.
    fn swum(&self, point: &Self::Point, stroke: &Stroke<f64>) -> f64;

    /// Its unit, and its sign, in what is told.
    fn unit(&self) -> f64 {
        1.0
    }

    /// The stationary point of the weighted sum near `start`.
    fn solve(
        &self,
        start: &Self::Point,
        members: &[(Member, f64)],
    ) -> Result<Self::Point, RobustError>;
}

/// A family of gaits with the paper's symmetries.
pub(super) trait Family: Design {
    const OBJECTIVE: Objective;

    /// At constant power of this model, or as the family times it.
    fn cycle(&self, model: &Model<f64>, point: &Self::Point) -> Cycle;

    /// First- and second-order conditions of the weighted sum.
    fn conditions(&self, point: &Self::Point, members: &[(Member, f64)]) -> Vec<Check>;
}

const STEPS: usize = 40;
const HALVINGS: usize = 12;
/// Step of the differences; their error slows the last steps a little and shifts no root.
const DIFFERENCE: f64 = 1e-7;
/// Jacobians are kept while a step gains this factor.
const GOOD: f64 = 0.05;

/// A root of `residual` near `start`, to `tolerance` in the largest component. No component moves further than `longest` in
/// a step.
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
            // At the floor of rounding a step may gain nothing more.
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
