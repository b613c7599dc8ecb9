//! Gaits of most net displacement, by Pontryagin's maximum principle (paper, section IV).

mod best;
mod error;
pub(crate) mod flow;
mod near;
mod search;
mod start_family;

use std::fmt;

use crate::region::Region;
use best::{best, candidates};
pub use error::{DisplacementError, ExtremalOutcomes};
pub use near::displacement_near;
use search::{Candidate, SCAN_POINTS};
use swimmer_files::{Bounds, Objective};
use swimmer_model::{Model, Swimmer};

use crate::certificate::{Condition, again_within};
use crate::certify::decided;
use crate::immobile::refuse_immobile;
use crate::momentum::pose;
use crate::optimal_gait::OptimalGait;
use crate::parallel::Watch;
use crate::problem::{GaitClass, InvalidProblem, validated};

/// Direction in which a counter-clockwise gait shall move the swimmer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Heading {
    /// X > 0, along the heading at φ₁ = φ₂ > 0.
    Forwards,
    /// X < 0.
    Backwards,
}

impl Heading {
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Forwards => 1.0,
            Self::Backwards => -1.0,
        }
    }
}

impl fmt::Display for Heading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Forwards => "forward (X > 0)",
            Self::Backwards => "backward (X < 0)",
        })
    }
}

/// Inputs of a displacement search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementProblem {
    /// The swimmer; its side links must be alike.
    pub swimmer: Swimmer<f64>,
    /// Bounds on the joint angles.
    pub bounds: Bounds,
    /// Sense of X for the counter-clockwise gait. `None` for the farthest gait of either sense, run so that it swims forwards.
    pub heading: Option<Heading>,
    /// Samples of the quarter gait; the cycle has four times as many.
    pub quarter_samples: usize,
}

impl DisplacementProblem {
    /// The problem without bounds, for the farthest gait of either sense.
    pub fn new(swimmer: Swimmer<f64>) -> Self {
        Self {
            swimmer,
            bounds: Bounds::default(),
            heading: None,
            quarter_samples: 192,
        }
    }

    /// With |φᵢ| ≤ `max_angle` \[rad\].
    #[must_use]
    pub fn with_max_angle(mut self, max_angle: f64) -> Self {
        self.bounds.max_angle = Some(max_angle);
        self
    }

    /// For the local optimum of one sense, run counter-clockwise.
    #[must_use]
    pub fn heading(mut self, heading: Heading) -> Self {
        self.heading = Some(heading);
        self
    }

    fn validated(&self) -> Result<Model<f64>, InvalidProblem> {
        validated(&self.swimmer, &self.bounds, GaitClass::Quarters)
    }
}

/// Returns the simple gait of most net displacement with the paper's two symmetries: a closed curve of singular arcs and arcs
/// along the bounds.
///
/// With a [`Heading`] it is the farthest local optimum of that sense, run counter-clockwise as in the paper: X < 0 for
/// [`Heading::Backwards`]. Without one both senses are searched, and the farther gait is returned so that it swims forwards; if
/// that is the one with X < 0, it runs clockwise, and its [`OptimalGait::arcs`] and [`OptimalGait::start_angle`] still describe
/// the counter-clockwise quarter.
///
/// Displacement optima are weak, local in shape: small reverse loops would add to X, so the certificate also demands a simple
/// curve. Each quarter keeps between the diagonals φ₂ = ±φ₁; it runs along them only if [`Bounds::sector`] makes them bounds.
/// A gait that is optimal among gaits of its symmetry and a saddle among all closed curves fails its certificate.
///
/// # Errors
/// [`DisplacementError`]: the invalid input, or the reason why no optimum exists.
///
/// ```
/// use gait_optimizer::{DisplacementProblem, Heading, displacement};
/// use swimmer_model::Swimmer;
///
/// let bounded = DisplacementProblem::new(Swimmer::purcell()).with_max_angle(2.4);
/// let papers = displacement(&bounded.heading(Heading::Backwards))?;
/// let farthest = displacement(&bounded)?;
/// assert!(papers.displacement < 0.0 && !papers.is_clockwise());
/// assert!((farthest.displacement + papers.displacement).abs() < 1e-12 && farthest.is_clockwise());
/// # Ok::<(), gait_optimizer::DisplacementError>(())
/// ```
pub fn displacement(problem: &DisplacementProblem) -> Result<OptimalGait, DisplacementError> {
    displacement_watched(problem, &|_| ())
}

/// As [`displacement`]. `watch` receives the share of the start families of a sense that have been scanned, and 1 after each
/// certificate.
///
/// # Errors
/// As [`displacement`].
pub fn displacement_watched(
    problem: &DisplacementProblem,
    watch: Watch<'_>,
) -> Result<OptimalGait, DisplacementError> {
    let optimum = |heading| no_saddle(best_symmetric(problem, heading, watch)?);
    match problem.heading {
        Some(heading) => optimum(heading),
        None => farther(optimum(Heading::Forwards), optimum(Heading::Backwards)),
    }
}

/// The farther of two gaits, swum forwards; the reason if neither exists.
fn farther(
    forwards: Result<OptimalGait, DisplacementError>,
    backwards: Result<OptimalGait, DisplacementError>,
) -> Result<OptimalGait, DisplacementError> {
    let is_farther = |there: &OptimalGait, here: &OptimalGait| {
        there.displacement.abs() > here.displacement.abs() * (1.0 + ALIKE)
    };
    match (forwards, backwards) {
        (Ok(forwards), Ok(backwards)) if is_farther(&backwards, &forwards) => {
            Ok(backwards.swum_forwards())
        }
        (Ok(forwards), _) => Ok(forwards),
        (Err(_), Ok(backwards)) => Ok(backwards.swum_forwards()),
        (Err(forwards), Err(backwards)) => Err(forwards.or_backwards(backwards)),
    }
}

/// Relative difference below which two gaits carry equally far.
const ALIKE: f64 = 1e-9;

fn no_saddle(gait: OptimalGait) -> Result<OptimalGait, DisplacementError> {
    if gait.certificate.pass() {
        Ok(gait)
    } else {
        let gait = Box::new(gait);
        Err(DisplacementError::Saddle { gait })
    }
}

/// The best gait of one sense among those with the paper's symmetries, even if it is a saddle among all closed curves.
pub(crate) fn best_symmetric(
    problem: &DisplacementProblem,
    heading: Heading,
    watch: Watch<'_>,
) -> Result<OptimalGait, DisplacementError> {
    let model = problem.validated()?;
    refuse_immobile(&model, &problem.bounds)?;
    let region = Region::new(&problem.bounds, &problem.swimmer.links);
    best(problem, heading, (&model, &region), watch)
}

/// Every gait of one sense that the search finds, farthest first, including those that fail their certificate.
pub(crate) fn every(
    problem: &DisplacementProblem,
    heading: Heading,
) -> Result<Vec<OptimalGait>, DisplacementError> {
    let model = problem.validated()?;
    refuse_immobile(&model, &problem.bounds)?;
    let region = Region::new(&problem.bounds, &problem.swimmer.links);
    let of = (&model, &region);
    let (found, _) = candidates(&problem.bounds, heading, of, SCAN_POINTS, &|_| ());
    let gaits = found
        .iter()
        .filter_map(|candidate| certified(problem, &model, candidate));
    let mut gaits: Vec<_> = gaits.collect();
    gaits.sort_by(|a, b| b.displacement.abs().total_cmp(&a.displacement.abs()));
    Ok(gaits)
}

/// A candidate as a full cycle with its certificate; `None` if it cannot be traced.
fn certified(
    problem: &DisplacementProblem,
    model: &Model<f64>,
    candidate: &Candidate,
) -> Option<OptimalGait> {
    // The arcs know this more accurately than the samples do.
    let displacement_over_length = 4.0 * candidate.quarter.end[2];
    let of = (Objective::Displacement, &problem.swimmer, &problem.bounds);
    let mut gait = decided(problem.quarter_samples, |samples| {
        let cycle = candidate.cycle(model, samples)?;
        let stroke = cycle.swum(model)?;
        Some(OptimalGait {
            displacement_over_length,
            displacement: displacement_over_length * problem.swimmer.total_length(),
            ..OptimalGait::of_cycle(of, true, cycle, &stroke)
        })
    })?;
    // Conditions that only the arcs provide.
    let lambda4 = candidate.momentum.at(&pose(&candidate.quarter.end)).z;
    let again = displacement_over_length - gait.swum.x;
    let tolerance = again_within(gait.swum.x.abs());
    gait.certificate = gait.certificate.with(vec![
        Condition::FinalLambda4.check(lambda4.abs()),
        Condition::ArcsSwumAgain.within(again.abs(), tolerance),
    ]);
    Some(gait)
}

#[cfg(test)]
mod tests;
