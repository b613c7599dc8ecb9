//! Multiple shooting over arcs: one damped Newton iteration for quarter gaits and for closed curves.
//!
//! Unknown are the state at the start of every piece and the length of every arc. Each piece must end where the next one
//! starts; an arc along a bound must start on it, tangent to it; at a corner of the forbidden shapes the direction may jump. Both ends of the chain belong to the [`Class`]. On a closed
//! curve the length of `μ_xy` closes by itself because the flow keeps it; where no bound arc marks a start, the start is held
//! on a line across the curve instead.
//!
//! Full cycles amplify a change of their start by up to 1e12, a piece by little: that is what the pieces are for.

mod chain;
mod conditions;

use nalgebra::DVector;
use swimmer_model::Model;

use super::Extremal;
use super::equations::STATE;
use super::flow::FINE;
use crate::numerics::damped;
pub(crate) use chain::{Chain, Class, Entry, Stretch};
use conditions::assemble;

/// Failure of the Newton iteration.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub(crate) enum Unsolved {
    #[error("an extremal cannot be integrated from the guess")]
    Lost,
    #[error("the conditions are singular")]
    Singular,
    #[error("no step makes the residual of {residual:.1e} smaller")]
    Stuck { residual: f64 },
    #[error("the arcs do not fit together")]
    Malformed,
}

/// Residual at which the iteration has converged.
const TOLERANCE: f64 = 2e-12;
/// Residual that is accepted if rounding prevents a smaller one.
const ACCEPTED: f64 = 1e-10;
const MOST_ITERATIONS: usize = 40;
/// Local tolerance of the integration far from a solution; the next constant is the residual below which the fine tolerance is used.
const COARSE: f64 = 1e-9;
const NEAR: f64 = 1e-5;
/// Largest change of an angle in one step \[rad\].
const LONGEST_TURN: f64 = 0.4;

/// Solves a chain from an initial guess by a damped Newton iteration with a line search.
pub(crate) fn solve(model: &Model<f64>, guess: Chain) -> Result<Extremal, Unsolved> {
    if !guess.is_whole() {
        return Err(Unsolved::Malformed);
    }
    let scale = guess
        .states
        .first()
        .map_or(1.0, |z| z[3].hypot(z[4]))
        .max(f64::MIN_POSITIVE);
    let mut chain = guess;
    let mut tolerance = COARSE;
    let mut here = assemble(model, &chain, scale, tolerance).ok_or(Unsolved::Lost)?;
    let mut orientation = 0.0;
    for _ in 0..MOST_ITERATIONS {
        if here.largest() < NEAR && tolerance > FINE {
            tolerance = FINE;
            here = assemble(model, &chain, scale, tolerance).ok_or(Unsolved::Lost)?;
        }
        let residual = here.largest();
        if residual.is_nan() {
            return Err(Unsolved::Lost);
        }
        let factors = here.jacobian.clone().lu();
        let step = factors.solve(&-DVector::from_column_slice(&here.residual));
        if step.is_some() {
            let pivots = factors.u().diagonal().map(f64::signum).product();
            orientation = pivots * factors.p().determinant::<f64>();
        }
        if residual <= TOLERANCE {
            break;
        }
        let step = step.ok_or(Unsolved::Singular)?;
        let step = step.as_slice();
        let norm = here.norm();
        let mut factors = damped(longest_factor(&chain, step)).take_while(|&factor| factor >= 1e-3);
        let next = factors.find_map(|factor| {
            let moved = chain.moved(step, factor);
            let trial = assemble(model, &moved, scale, tolerance)?;
            (trial.norm() < (1.0 - 1e-4 * factor) * norm).then_some((moved, trial))
        });
        let Some(next) = next else {
            break;
        };
        (chain, here) = next;
    }
    let residual = here.largest();
    if residual <= ACCEPTED {
        Ok(Extremal {
            chain,
            residual,
            orientation,
        })
    } else {
        Err(Unsolved::Stuck { residual })
    }
}

/// Largest factor of a step that keeps the changes of angles and of arc lengths within their limits.
fn longest_factor(chain: &Chain, step: &[f64]) -> f64 {
    let mut factor = 1.0_f64;
    let mut changes = step.iter();
    for _ in &chain.states {
        for (i, change) in changes.by_ref().take(STATE).enumerate() {
            if i < 3 && change.abs() > LONGEST_TURN {
                factor = factor.min(LONGEST_TURN / change.abs());
            }
        }
    }
    let most = 0.3 * chain.length();
    for change in changes {
        if change.abs() > most {
            factor = factor.min(most / change.abs());
        }
    }
    factor
}
