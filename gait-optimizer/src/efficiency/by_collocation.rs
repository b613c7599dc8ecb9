//! Direct collocation as the bridge: its nodes carry poses, and so are a guess for shooting.

use nalgebra::Vector2;
use swimmer_model::Model;

use super::chain::{Found, Ladder, SETTLED_PIECES, not_converged, same_gait};
use super::{Branch, EfficiencyError, Method};
use crate::collocation::{CollocationProblem, CollocationSolution, QuarterGuess, solve};
use crate::extremal::guess::{Posed, quarter};
use crate::extremal::{free_quarter, shooting::Chain};

/// Orders up to that of the Fourier gait that collocation starts from, the nodes of their grids, and the gain that a climb
/// stops at.
const GUESS: [(usize, usize, f64); 3] = [(1, 32, 1e-4), (2, 32, 1e-4), (3, 48, 1e-6)];

/// Fourier to order 3, collocation, shooting.
pub(crate) fn by_collocation(
    model: &Model<f64>,
    branch: Branch,
    start: [f64; 2],
) -> Result<Found, EfficiencyError> {
    let mut ladder = Ladder::new(model, branch, start);
    let mut last = None;
    for (order, nodes, gain) in GUESS {
        last = Some((order, ladder.climb_to(order, nodes, gain)?));
    }
    let failed = || not_converged(branch, last.as_ref());
    let (order, maximum) = last.as_ref().ok_or_else(failed)?;
    let (a, b) = maximum
        .coefficients
        .split_at(maximum.coefficients.len() / 2);
    let pairs: Vec<[f64; 2]> = a.iter().zip(b).map(|(a, b)| [*a, *b]).collect();
    let guess = QuarterGuess::fourier(&pairs).map_err(|_| failed())?;
    let solution =
        solve(&CollocationProblem::new(model, branch.sign()), &guess).map_err(|reason| {
            EfficiencyError::NotCollocated {
                branch,
                reason: reason.to_string(),
            }
        })?;
    let collocated = solution.efficiency;
    let extremal = chain(&solution)
        .and_then(|guess| free_quarter(model, guess))
        .and_then(|extremal| same_gait(model, extremal, collocated, solution.final_x))
        .ok_or_else(failed)?;
    Ok(Found {
        extremal,
        order: *order,
        method: Method::Collocation,
        direct_efficiency: Some(collocated),
    })
}

/// The nodes' shapes and poses at equal times, which are equal power lengths, as the start of a chain.
fn chain(solution: &CollocationSolution) -> Option<Chain> {
    let points: Option<Vec<Posed>> = (0..=SETTLED_PIECES)
        .map(|i| {
            let t = i as f64 / SETTLED_PIECES as f64;
            let last = solution.nodes.len().checked_sub(1)?;
            let after = solution.nodes.partition_point(|node| node.t < t);
            let after = after.clamp(1, last.max(1));
            let (low, high) = (solution.nodes.get(after - 1)?, solution.nodes.get(after)?);
            let share = (t - low.t) / (high.t - low.t);
            let between = |low: f64, high: f64| low + share * (high - low);
            let rate = |i: usize| between(low.control[i], high.control[i]);
            Some(Posed {
                phi: solution.phi(t),
                rate: Vector2::new(rate(0), rate(1)),
                theta: between(low.state[3], high.state[3]),
                y: between(low.y, high.y),
            })
        })
        .collect();
    // At constant power the length of a quarter that lasts 1 is √E.
    quarter(&points?, solution.final_energy.sqrt(), solution.final_x)
}
