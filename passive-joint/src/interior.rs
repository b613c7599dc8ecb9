//! Primal–dual interior-point method for a smooth objective under linear inequalities, with few variables.
//!
//! The Hessian is the central difference of exact gradients: with a dozen variables it costs less than an iteration of anything that
//! approximates it. `clarabel` is limited to convex problems, and the solver of `collocation` is bound to its own path equations.

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::PassiveError;

/// Objective at a point.
pub(crate) struct Evaluation {
    pub(crate) value: f64,
    pub(crate) gradient: DVector<f64>,
}

/// Maximisation of an objective over rows · x ≤ limits.
pub(crate) struct Maximisation<'a> {
    /// Objective and gradient. Returns `None` outside its domain.
    pub(crate) objective: &'a dyn Fn(&DVector<f64>) -> Option<Evaluation>,
    pub(crate) rows: &'a DMatrix<f64>,
    pub(crate) limits: &'a DVector<f64>,
}

/// A point that fulfils the KKT conditions.
pub(crate) struct Maximum {
    pub(crate) x: DVector<f64>,
    pub(crate) value: f64,
    /// Largest component of gradient − rowsᵀ multipliers.
    pub(crate) stationarity: f64,
    /// Largest product of a multiplier and its slack.
    pub(crate) complementarity: f64,
    /// True if the Hessian is negative definite along the active bounds.
    pub(crate) is_strict: bool,
}

const MOST_STEPS: u32 = 400;
/// Small: a large barrier would push the search off the branch on which it begins.
const FIRST_BARRIER: f64 = 1e-5;
/// Longest step in any variable.
const LONGEST_STEP: f64 = 0.1;
const LAST_BARRIER: f64 = 1e-12;
const ACCURACY: f64 = 1e-8;
/// Difference of a variable for the Hessian; variables are of order one.
const DIFFERENCE: f64 = 1e-5;
/// Share of the way to a bound that a step may take.
const TO_BOUND: f64 = 0.995;
/// Largest ratio of a multiplier to barrier / slack.
const OFF_CENTRE: f64 = 1e8;
const MOST_HALVINGS: u32 = 40;
/// Rounding of the objective.
const ROUNDING: f64 = 1e-13;

impl Maximisation<'_> {
    /// Maximises from a point strictly inside the bounds.
    ///
    /// # Errors
    /// [`PassiveError::NoOptimum`] after a bounded number of steps.
    pub(crate) fn solve(&self, start: DVector<f64>) -> Result<Maximum, PassiveError> {
        let mut x = start;
        // Multipliers sum to 1, the size of the gradient.
        let mut multipliers =
            DVector::from_element(self.limits.len(), 1.0 / self.limits.len() as f64);
        let mut barrier = FIRST_BARRIER;
        let mut residual = f64::INFINITY;
        for iterations in 0..MOST_STEPS {
            let failed = PassiveError::NoOptimum {
                iterations,
                residual,
            };
            let Evaluation { value, gradient } = (self.objective)(&x).ok_or(failed)?;
            let slacks = self.slacks(&x);
            let stationarity = (&gradient - self.rows.tr_mul(&multipliers)).amax();
            let products = multipliers.component_mul(&slacks);
            residual = stationarity.max(products.amax());
            let hessian = self.hessian(&x).ok_or(failed)?;
            let weights = multipliers.component_div(&slacks);
            let curvature = self.curvature(&hessian, &weights);
            if residual <= ACCURACY {
                return Ok(Maximum {
                    is_strict: Cholesky::new(curvature).is_some(),
                    x,
                    value,
                    stationarity,
                    complementarity: products.amax(),
                });
            }
            let off = products.add_scalar(-barrier).amax();
            if stationarity.max(off) <= 10.0 * barrier {
                barrier = (0.2 * barrier).min(barrier.powf(1.5)).max(LAST_BARRIER);
            }
            let pushes = slacks.map(|slack| barrier / slack);
            let right = &gradient - self.rows.tr_mul(&pushes);
            let mut step = definite(&curvature).ok_or(failed)?.solve(&right);
            if step.amax() > LONGEST_STEP {
                step *= LONGEST_STEP / step.amax();
            }
            let along = self.rows * &step;
            let change = &pushes - &multipliers + weights.component_mul(&along);
            let length = self
                .line_search(&x, &step, (value, right.dot(&step)), barrier)
                .ok_or(failed)?;
            x += &step * length;
            let length = to_bound(&multipliers, &change);
            multipliers += change * length;
            // Multipliers stay near barrier / slack, or the next step runs into a bound.
            let slacks = self.slacks(&x);
            multipliers.zip_apply(&slacks, |multiplier, slack| {
                let centre = barrier / slack;
                *multiplier = multiplier.clamp(centre / OFF_CENTRE, centre * OFF_CENTRE);
            });
        }
        Err(PassiveError::NoOptimum {
            iterations: MOST_STEPS,
            residual,
        })
    }

    fn slacks(&self, x: &DVector<f64>) -> DVector<f64> {
        self.limits - self.rows * x
    }

    /// Hessian of the objective. Returns `None` outside its domain.
    fn hessian(&self, x: &DVector<f64>) -> Option<DMatrix<f64>> {
        let count = x.len();
        let mut hessian = DMatrix::zeros(count, count);
        for k in 0..count {
            let at = |by: f64| {
                let mut shifted = x.clone();
                shifted[k] += by;
                (self.objective)(&shifted).map(|at| at.gradient)
            };
            let column = (at(DIFFERENCE)? - at(-DIFFERENCE)?) / (2.0 * DIFFERENCE);
            hessian.set_column(k, &column);
        }
        Some((&hessian + hessian.transpose()) * 0.5)
    }

    /// −Hessian + rowsᵀ diag(weights) rows.
    fn curvature(&self, hessian: &DMatrix<f64>, weights: &DVector<f64>) -> DMatrix<f64> {
        let mut weighted = self.rows.clone();
        for (mut row, weight) in weighted.row_iter_mut().zip(weights.iter()) {
            row *= *weight;
        }
        self.rows.tr_mul(&weighted) - hessian
    }

    /// Length of a step that raises the barrier function. `slope` is its derivative along the step. Returns `None` without one.
    fn line_search(
        &self,
        x: &DVector<f64>,
        step: &DVector<f64>,
        (value, slope): (f64, f64),
        barrier: f64,
    ) -> Option<f64> {
        let merit = |value: f64, slacks: &DVector<f64>| {
            value + barrier * slacks.iter().map(|slack| slack.ln()).sum::<f64>()
        };
        let slacks = self.slacks(x);
        let here = merit(value, &slacks);
        let mut length = to_bound(&slacks, &(-(self.rows * step)));
        for _ in 0..MOST_HALVINGS {
            let next = x + step * length;
            if let Some(Evaluation { value, .. }) = (self.objective)(&next) {
                let gain = merit(value, &self.slacks(&next)) - here;
                if gain >= 1e-4 * length * slope - ROUNDING * (1.0 + here.abs()) {
                    return Some(length);
                }
            }
            length *= 0.5;
        }
        None
    }
}

/// Longest step, at most 1, that leaves positive numbers positive.
fn to_bound(values: &DVector<f64>, change: &DVector<f64>) -> f64 {
    values
        .iter()
        .zip(change.iter())
        .filter(|(_, change)| **change < 0.0)
        .map(|(value, change)| -TO_BOUND * value / change)
        .fold(1.0, f64::min)
}

/// Cholesky factors of the matrix, shifted until it is positive definite.
fn definite(matrix: &DMatrix<f64>) -> Option<Cholesky<f64, nalgebra::Dyn>> {
    let mut shift = 0.0;
    for _ in 0..40 {
        let mut shifted = matrix.clone();
        for k in 0..matrix.nrows() {
            shifted[(k, k)] += shift;
        }
        if let Some(factors) = Cholesky::new(shifted) {
            return Some(factors);
        }
        shift = if shift > 0.0 { shift * 4.0 } else { 1e-6 };
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ln x + ln y − 3x under x + y ≤ 2 and y ≤ 1: y = 1, x = 1/3.
    #[test]
    fn it_finds_a_maximum_on_a_bound() {
        let objective = |x: &DVector<f64>| {
            (x.min() > 0.0).then(|| {
                let gradient = DVector::from_vec(vec![1.0 / x[0] - 3.0, 1.0 / x[1]]);
                Evaluation {
                    value: x[0].ln() + x[1].ln() - 3.0 * x[0],
                    gradient,
                }
            })
        };
        let rows = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 0.0, 1.0]);
        let limits = DVector::from_vec(vec![2.0, 1.0]);
        let problem = Maximisation {
            objective: &objective,
            rows: &rows,
            limits: &limits,
        };
        let maximum = problem.solve(DVector::from_vec(vec![0.5, 0.5])).unwrap();
        assert!((maximum.x[0] - 1.0 / 3.0).abs() < 1e-7, "{}", maximum.x);
        assert!((maximum.x[1] - 1.0).abs() < 1e-7);
        assert!(maximum.is_strict && maximum.stationarity < 1e-8);
    }
}
