//! The gait that moves most across the heading it starts with, without net rotation, so that a robot can be steered.
//!
//! Where the first sample lies is free: of a loop with net displacement d, the best start is where the heading is square to
//! d, and then only |d| counts – the loop is one of most displacement. Where no heading is square to d, the start is where
//! the heading is farthest turned. Moving the first sample then changes the frame that d is seen from, and the momentum's
//! rotational part jumps by X there (p across the heading, X along it): the heights before and after the start differ
//! by X times the θ row of the curvature. Both vanish on free arcs, so a loop that is stationary together with such a start
//! has it on a bound – where the heading is stationary along it, or in a corner of the bounds.
//!
//! The start is a point of the simple loop itself. The candidates are the loops of most displacement, each with its best start,
//! and the loops that are stationary with a start on a straight bound.

mod error;
mod on_bound;
mod square;

use swimmer_files::{Bounds, Objective};
use swimmer_model::{Model, Swimmer};

pub use error::SidewaysError;

use crate::atlas::{AtlasProblem, atlas_watched};
use crate::certificate::Verdict;
use crate::certify::certified;
use crate::cycle::Cycle;
use crate::optimal_gait::OptimalGait;
use crate::parallel::Watch;
use crate::problem::{GaitClass, validated};
use crate::region::Region;
use square::turned;

/// Inputs of the sideways search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SidewaysProblem {
    /// The swimmer.
    pub swimmer: Swimmer<f64>,
    /// Bounds on the shapes: the largest angle and crossing links.
    pub bounds: Bounds,
    /// Random starts of the search among the loops of most displacement.
    pub starts: usize,
    /// Threads to work on; the result does not depend on them.
    pub threads: usize,
    /// Samples of the cycle.
    pub samples: usize,
}

impl SidewaysProblem {
    /// The problem without bounds.
    pub fn new(swimmer: Swimmer<f64>) -> Self {
        Self {
            swimmer,
            bounds: Bounds::default(),
            starts: 48,
            threads: 1,
            samples: 1024,
        }
    }
}

/// A gait that moves sideways.
#[derive(Debug, Clone, PartialEq)]
pub struct Sideways {
    /// The gait with its certificate.
    pub gait: OptimalGait,
    /// Y over L: net displacement across the heading at the first sample, to the left.
    pub lateral_over_length: f64,
    /// Loops that were found, of which this is the best.
    pub loops: usize,
}

/// The simple closed loop of most displacement across the heading at its first sample, without net rotation: the best of
/// those that are found and certified. Random starts know no front and back, so a swimmer whose side links differ is looked
/// at from both ends.
///
/// There need not be a farthest simple loop, so the answer can fall as a bound B is widened: from the corner (B, −B) of Purcell's
/// swimmer an extremal runs along the bound at 1.005 rad and none does at 1.01, where the next best loop carries .026 L and that
/// one carried .034. `watch` receives the progress.
///
/// # Errors
/// [`SidewaysError`]: what is wrong with the problem, or that there is no such gait.
///
/// ```
/// use std::sync::Mutex;
/// use gait_optimizer::{Bounds, SidewaysProblem, sideways};
/// use swimmer_model::Swimmer;
///
/// let bounds = Bounds::within(1.2);
/// let shares = Mutex::new(Vec::new());
/// let problem = SidewaysProblem { bounds, ..SidewaysProblem::new(Swimmer::purcell()) };
/// let found = sideways(&problem, &|share| shares.lock().unwrap().push(share))?;
/// assert!(found.lateral_over_length > 0.0 && found.gait.rotation.abs() < 1e-8);
/// assert!(shares.into_inner().unwrap().iter().all(|share| (0.0..=1.0).contains(share)));
/// # Ok::<(), gait_optimizer::SidewaysError>(())
/// ```
pub fn sideways(problem: &SidewaysProblem, watch: Watch<'_>) -> Result<Sideways, SidewaysError> {
    let ours = from_this_end(problem, watch);
    if problem.swimmer.is_symmetric() || matches!(ours, Err(SidewaysError::Problem(_))) {
        return ours;
    }
    let mut other = *problem;
    other.swimmer = problem.swimmer.exchanged();
    let theirs = from_this_end(&other, watch)
        .ok()
        .and_then(|found| from_the_other_end(problem, &found));
    match (ours, theirs) {
        (Ok(ours), Some(theirs)) => {
            let loops = ours.loops + theirs.loops;
            let is_theirs = theirs.lateral_over_length > ours.lateral_over_length;
            Ok(Sideways {
                loops,
                ..if is_theirs { theirs } else { ours }
            })
        }
        (ours, theirs) => theirs.map_or(ours, Ok),
    }
}

/// The gait of a swimmer that was turned end for end, as the swimmer itself runs it. Returns `None` if it is not certified.
fn from_the_other_end(problem: &SidewaysProblem, found: &Sideways) -> Option<Sideways> {
    let model = Model::new(&problem.swimmer.of_unit_length()).ok()?;
    // Backwards, so that it stays as far across to the same side.
    let cycle = found.gait.cycle.reversed(|phi| -phi.yx());
    let gait = certified(gait((problem, &model), cycle)?);
    gait.certificate.pass().then(|| Sideways {
        lateral_over_length: gait.lateral_over_length,
        gait,
        ..found.clone()
    })
}

/// A cycle as a gait, not yet certified. Returns `None` if it cannot be integrated.
fn gait((problem, model): (&SidewaysProblem, &Model<f64>), cycle: Cycle) -> Option<OptimalGait> {
    let stroke = cycle.swum(model)?;
    let of = (Objective::Sideways, &problem.swimmer, &problem.bounds);
    Some(OptimalGait::of_cycle(of, false, cycle, &stroke))
}

/// [`sideways`] from one end, with as many samples as the certificates need.
fn from_this_end(problem: &SidewaysProblem, watch: Watch<'_>) -> Result<Sideways, SidewaysError> {
    let (mut best, mut open) = sampled_as_asked(problem, watch)?;
    let mut finer = *problem;
    while open && finer.samples < FINEST * problem.samples {
        finer.samples *= 2;
        let sampled;
        (sampled, open) = sampled_as_asked(&finer, watch)?;
        best = sampled.or(best);
    }
    best
}

/// Largest number of samples, as a multiple of the requested number.
const FINEST: usize = 16;

/// The best that is certified, and whether more samples might have a better one certified.
fn sampled_as_asked(
    problem: &SidewaysProblem,
    watch: Watch<'_>,
) -> Result<(Result<Sideways, SidewaysError>, bool), SidewaysError> {
    let asked = AtlasProblem {
        bounds: problem.bounds,
        starts: problem.starts,
        threads: problem.threads,
        samples: problem.samples,
        ..AtlasProblem::new(problem.swimmer, Objective::Displacement)
    };
    let loops = atlas_watched(&asked, watch)?;
    let model = validated(&problem.swimmer, &problem.bounds, GaitClass::Closed)
        .map_err(crate::atlas::AtlasError::from)?;
    let region = Region::new(&problem.bounds, &problem.swimmer.links);
    let across = |gait: &OptimalGait| gait.lateral_over_length.abs();
    let optima = loops.optima.iter().map(|optimum| &optimum.gait);
    let mut found: Vec<OptimalGait> = optima
        .filter_map(|gait| turned(problem, &model, gait))
        .collect();
    found.extend(
        on_bound::candidates(&model, &region, problem.samples)
            .into_iter()
            .filter_map(|cycle| gait((problem, &model), cycle)),
    );
    found.sort_by(|a, b| across(b).total_cmp(&across(a)));
    let count = found.len();
    let mut open = false;
    let passes = |gait: &OptimalGait| {
        let certificate = &gait.certificate;
        open |= certificate.verdict() == Verdict::Undecided && certificate.is_too_coarse();
        certificate.pass()
    };
    let Some(best) = found.into_iter().map(certified).find(passes) else {
        let none = SidewaysError::NoOptimum {
            bounds: problem.bounds,
            loops: loops.optima.len(),
        };
        return Ok((Err(none), open));
    };
    let best = Sideways {
        lateral_over_length: across(&best),
        gait: if best.lateral_over_length < 0.0 {
            best.mirrored()
        } else {
            best
        },
        loops: count,
    };
    Ok((Ok(best), open))
}

#[cfg(test)]
mod tests;
