//! Direct collocation as the bridge: its nodes carry costates, and so are a start for shooting.

use swimmer_model::Model;

use super::chain::{Found, Ladder, final_values, not_converged, same_gait};
use super::shooting::{Final, polish};
use super::start::Start;
use super::{Branch, EfficiencyError, Method, multiple};
use crate::collocation::{CollocationProblem, CollocationSolution, QuarterGuess, solve};

/// Orders up to that of the Fourier gait that collocation starts from, the nodes of their grids, and the gain that a climb
/// stops at.
const GUESS: [(usize, usize, f64); 3] = [(1, 32, 1e-4), (2, 32, 1e-4), (3, 48, 1e-6)];
/// Segments of the multiple shooting where the single shooting does not converge from the collocated end.
const SEGMENTS: usize = 16;

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
    let (_, maximum) = last.as_ref().ok_or_else(failed)?;
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
    let straight = last_node(model, &solution).and_then(|at_end| polish(model, &at_end));
    let polished = straight
        .or_else(|| {
            let solved = multiple::solve(model, &of_nodes(model, &solution)?)?;
            polish(model, &final_values(model, &solved)?)
        })
        .and_then(|polished| same_gait(polished, collocated, solution.final_x))
        .ok_or_else(failed)?;
    Ok(Found {
        polished,
        method: Method::Collocation,
        direct_efficiency: Some(collocated),
    })
}

/// Final values of the single shooting.
fn last_node(model: &Model<f64>, solution: &CollocationSolution) -> Option<Final> {
    let [phi, _, x, theta, energy] = solution.nodes.last()?.state;
    Some(Final::new(phi, x, theta, energy / model.side_drag()))
}

/// Some of the nodes as starts of segments.
fn of_nodes(model: &Model<f64>, solution: &CollocationSolution) -> Option<Start> {
    let last = solution.nodes.last()?;
    let kappa = solution.final_energy / (model.side_drag() * solution.final_x);
    let apart = solution.nodes.len().div_ceil(SEGMENTS).max(1);
    // The first node's costates are extrapolated only: good enough for Newton's method.
    let mut nodes: Vec<_> = solution.nodes.iter().step_by(apart).collect();
    if nodes.last().is_some_and(|node| node.t < last.t) {
        nodes.push(last);
    }
    let states = nodes
        .iter()
        .map(|node| {
            let [phi1, phi2, x, theta, _] = node.state;
            let [lambda1, lambda2, lambda3, ..] = node.costate;
            let (one, two) = (lambda1 / lambda3, lambda2 / lambda3);
            [phi1, phi2, theta, node.y - last.y, one, two, x]
        })
        .collect();
    Some(Start {
        times: nodes.iter().map(|node| node.t).collect(),
        states,
        kappa,
    })
}
