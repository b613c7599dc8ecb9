//! Multiple shooting over the quarter: the bridge from a rough gait to the tiny basin of the single shooting.
//!
//! Unknown are the states φ₁, φ₂, θ, `y − y_f`, λ₁, λ₂ at the ends of the segments, and κ; x is the sum of what the segments
//! add. Each segment is short, so an error at its start grows little: Newton's method converges from gaits that are right
//! to a few per cent, where the single shooting asks for 1e-5.

use nalgebra::{DMatrix, DVector};
use swimmer_model::Model;

use super::flow::{Flow, State, Variation, advance};
use super::start::Start;

/// States and the columns for φ₁, φ₂, θ, `y − y_f`, λ₁, λ₂ and κ.
const ALL: usize = 56;
const MOST_STEPS: usize = 40;
/// Conditions are met to this before the single shooting takes over.
const ENOUGH: f64 = 1e-8;

/// Newton's method from `start`; none where it does not converge.
pub(crate) fn solve(model: &Model<f64>, start: &Start) -> Option<Start> {
    let mut here = start.clone();
    let mut system = conditions(model, &here)?;
    for _ in 0..MOST_STEPS {
        let size = system.residual.amax();
        if size < ENOUGH {
            return Some(here);
        }
        let step = system.jacobian.clone().lu().solve(&-&system.residual)?;
        let worth = system.residual.norm_squared();
        let mut share = (0.6 / step.amax()).min(1.0);
        let mut next = None;
        while share > 1e-3 {
            let trial = moved(&here, &step, share);
            if let Some(reached) = conditions(model, &trial)
                && reached.residual.norm_squared() < (1.0 - 0.1 * share) * worth
            {
                next = Some((trial, reached));
                break;
            }
            share *= 0.5;
        }
        (here, system) = next?;
    }
    None
}

struct Conditions {
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
}

fn moved(start: &Start, step: &DVector<f64>, share: f64) -> Start {
    let mut moved = start.clone();
    for (state, part) in moved.states.iter_mut().zip(step.as_slice().chunks(6)) {
        for (value, change) in state.iter_mut().zip(part) {
            *value += share * change;
        }
    }
    moved.kappa += share * step.as_slice().last().copied().unwrap_or(0.0);
    moved
}

/// Continuity, the conditions at both ends, and `κ x_f = E_f`.
fn conditions(model: &Model<f64>, start: &Start) -> Option<Conditions> {
    let count = start.states.len();
    let size = 6 * count + 1;
    if !start.kappa.is_finite() {
        return None;
    }
    let mut residual = DVector::zeros(size);
    let mut jacobian = DMatrix::zeros(size, size);
    let flow = Flow {
        model,
        kappa: start.kappa,
        sense: 1.0,
    };
    let mut d_kappa = [0.0; 7];
    d_kappa[6] = 1.0;
    let variation = Variation { flow, d_kappa };
    let mut x = 0.0;
    let last = size - 1;
    let pairs = start.states.windows(2).zip(start.times.windows(2));
    for (k, (states, times)) in pairs.enumerate() {
        let ([from, to], [begin, end]) = (states, times) else {
            continue;
        };
        let reached = advance(&variation, with_columns(from), end - begin, 1e-10)?;
        x += reached[6];
        for i in 0..6 {
            residual[6 * k + i] = reached[i] - to[i];
            jacobian[(6 * k + i, 6 * (k + 1) + i)] = -1.0;
            for j in 0..6 {
                jacobian[(6 * k + i, 6 * k + j)] = reached[7 * (j + 1) + i];
            }
            jacobian[(6 * k + i, last)] = reached[7 * 7 + i];
        }
        for j in 0..6 {
            jacobian[(last, 6 * k + j)] += start.kappa * reached[7 * (j + 1) + 6];
        }
        jacobian[(last, last)] += start.kappa * reached[7 * 7 + 6];
    }
    let (first, end) = (start.states.first()?, start.states.last()?);
    let at_end = 6 * (count - 1);
    let rows = [
        (first[0] - first[1], vec![(0, 1.0), (1, -1.0)]),
        (first[2], vec![(2, 1.0)]),
        (first[4] + first[5], vec![(4, 1.0), (5, 1.0)]),
        (end[0] + end[1], vec![(at_end, 1.0), (at_end + 1, 1.0)]),
        (end[3], vec![(at_end + 3, 1.0)]),
        (end[4] - end[5], vec![(at_end + 4, 1.0), (at_end + 5, -1.0)]),
    ];
    for (i, (value, entries)) in rows.into_iter().enumerate() {
        residual[at_end + i] = value;
        for (column, entry) in entries {
            jacobian[(at_end + i, column)] = entry;
        }
    }
    // The power is the same everywhere on an extremal, so E_f is that of the last state.
    let (power, slopes) = flow.power_slopes(end);
    residual[last] = start.kappa * x - power;
    jacobian[(last, last)] += x - slopes[6];
    for j in 0..6 {
        jacobian[(last, at_end + j)] -= slopes[j];
    }
    residual
        .iter()
        .all(|value| value.is_finite())
        .then_some(Conditions { residual, jacobian })
}

fn with_columns(state: &State) -> [f64; ALL] {
    let mut all = [0.0; ALL];
    all[..6].copy_from_slice(&state[..6]);
    for column in 0..6 {
        all[7 * (column + 1) + column] = 1.0;
    }
    all
}
