//! Newton's method for a maximum, with a Levenberg term if the Hessian is not negative definite or the step is too long.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::objective::{Expansion, Value, series};

/// Local maximum over the coefficients.
#[derive(Debug, Clone)]
pub(crate) struct Maximum {
    pub(crate) coefficients: Vec<f64>,
    pub(crate) value: Value,
}

const MOST_STEPS: usize = 80;
/// Longest step of one coefficient \[rad\].
const LONGEST: f64 = 0.35;

/// Largest joint angle of a curve \[rad\]; beyond it the ascent is stopped.
pub(crate) const FARTHEST: f64 = 9.0;

/// Maximises the objective `look` from these coefficients until the predicted gain of a step is below `least_gain`; X keeps its
/// sign. Returns `None` if the curve grows too large or the iteration does not converge.
pub(crate) fn climb(
    mut look: impl FnMut(&[f64]) -> Expansion,
    start: &[f64],
    least_gain: f64,
) -> Option<Maximum> {
    let mut here = start.to_vec();
    let mut seen = look(&here);
    let mut damping = 0.0_f64;
    for _ in 0..MOST_STEPS {
        let value = seen.value;
        if !value.objective.is_finite() || farthest_point(&here) > FARTHEST {
            return None;
        }
        let bend = -&seen.hessian;
        let scale = bend.diagonal().amax().max(1e-6);
        let finished = |coefficients, value| {
            Some(Maximum {
                coefficients,
                value,
            })
        };
        let mut next = None;
        for _ in 0..60 {
            let Some((step, promise)) = step(&bend, &seen.gradient, damping) else {
                damping = (damping * 4.0).max(1e-9 * scale);
                continue;
            };
            if promise < least_gain {
                return finished(here, value);
            }
            if step.amax() > LONGEST {
                damping = (damping * 3.0).max(1e-6 * scale);
                continue;
            }
            let trial: Vec<f64> = here.iter().zip(step.iter()).map(|(c, d)| c + d).collect();
            let reached = look(&trial);
            let gain = reached.value.objective - value.objective;
            if reached.value.x * value.x > 0.0 && gain >= 0.1 * promise {
                if gain > 0.6 * promise {
                    damping *= 0.1;
                    if damping < 1e-10 * scale {
                        damping = 0.0;
                    }
                }
                next = Some((trial, reached));
                break;
            }
            // The remaining gain is below the rounding of the objective, not of its gradient.
            if promise < 1e-13 {
                return finished(trial, reached.value);
            }
            damping = (damping * 4.0).max(1e-6 * scale);
        }
        (here, seen) = next?;
    }
    None
}

/// Damped Newton step with its predicted gain. Returns `None` if it is not an ascent direction.
fn step(bend: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64) -> Option<(DVector<f64>, f64)> {
    let mut damped = bend.clone();
    for i in 0..damped.nrows() {
        damped[(i, i)] += damping;
    }
    let step = Cholesky::new(damped)?.solve(gradient);
    let promise = gradient.dot(&step) - 0.5 * step.dot(&(bend * &step));
    (promise.is_finite() && promise >= 0.0).then_some((step, promise))
}

/// Largest joint angle of the curve, from sixteen of its points \[rad\].
fn farthest_point(coefficients: &[f64]) -> f64 {
    (0..=16)
        .map(|i| {
            series(
                coefficients,
                std::f64::consts::FRAC_PI_2 * f64::from(i) / 16.0,
            )
            .0
        })
        .map(|phi| phi.amax())
        .fold(0.0, f64::max)
}
