//! Gaits of most net displacement, by Pontryagin's maximum principle (paper, section IV).

mod best;
mod error;
pub(crate) mod flow;
mod near;
mod search;
mod start_family;
mod supremum;

use std::fmt;

use crate::region::Region;
use best::{best, candidates};
pub use error::{DisplacementError, Fates};
pub use near::displacement_near;
use search::{Candidate, SCAN_POINTS};
pub use supremum::{Member, Suprema, Supremum};
use swimmer_files::{Bounds, Objective};
use swimmer_model::{Model, Swimmer};

use crate::certificate::{Condition, again_within};
use crate::certify::decided;
use crate::immobile::refuse_immobile;
use crate::momentum::pose;
use crate::optimal_gait::OptimalGait;
use crate::problem::{GaitClass, InvalidProblem, validated};

/// Which way a counter-clockwise gait shall carry the swimmer.
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

/// A displacement problem: whose gait, within which bounds, which way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementProblem {
    /// The swimmer; its side links must be alike.
    pub swimmer: Swimmer<f64>,
    /// Bounds on the joint angles.
    pub bounds: Bounds,
    /// Which optimum; none for the paper's: forwards with no bound or an upper one, backwards otherwise.
    pub heading: Option<Heading>,
    /// Samples of the quarter gait; the cycle has four times as many.
    pub quarter_samples: usize,
    /// Only gaits whose quarters stay off the diagonals φ₂ = ±φ₁ but for their ends, as the paper's (a) to (c): not those that
    /// touch their own images there, which are limits of simple curves and may carry farther.
    pub simple: bool,
}

impl DisplacementProblem {
    /// The problem without bounds.
    pub fn new(swimmer: Swimmer<f64>) -> Self {
        Self {
            swimmer,
            bounds: Bounds::default(),
            heading: None,
            quarter_samples: 192,
            simple: false,
        }
    }

    /// With |φᵢ| ≤ `max_angle` \[rad\].
    #[must_use]
    pub fn with_max_angle(mut self, max_angle: f64) -> Self {
        self.bounds.max_angle = Some(max_angle);
        self
    }

    fn heading(&self) -> Heading {
        self.heading
            .unwrap_or(if self.bounds.min_angle.is_some() || self.bounds.sector {
                Heading::Backwards
            } else {
                Heading::Forwards
            })
    }

    /// Whether gaits that touch their own images along a diagonal are to be looked at beside the others. Where nothing bounds
    /// the angles from above they have no limit.
    fn may_touch(&self) -> bool {
        let Bounds {
            max_angle,
            sector,
            no_overlap,
            ..
        } = self.bounds;
        !self.simple && !sector && (max_angle.is_some() || no_overlap)
    }

    /// Whether slits may carry a gait farther than an optimum, and have a limit.
    fn may_have_slits(&self) -> bool {
        let sectored = self.bounds.sector && !self.simple && self.bounds.max_angle.is_some();
        self.may_touch() || sectored
    }

    /// The bounds that gaits are looked for within: those that touch their own images keep between the diagonals, and so do all others.
    fn searched(&self) -> Bounds {
        if self.may_touch() {
            self.touching()
        } else {
            self.bounds
        }
    }

    /// The bounds that a candidate is certified for.
    fn bounds_of(&self, candidate: &Candidate) -> Bounds {
        if candidate.quarter.is_simple() {
            self.bounds
        } else {
            self.touching()
        }
    }

    /// The bounds that gaits obey which touch their own images.
    fn touching(&self) -> Bounds {
        Bounds {
            sector: true,
            ..self.bounds
        }
    }

    fn validated(&self) -> Result<Model<f64>, InvalidProblem> {
        validated(&self.swimmer, &self.bounds, GaitClass::Quarters)
    }
}

/// The gait of most net displacement in the class of closed curves with the paper's two symmetries that are made of singular
/// arcs and arcs along the bounds.
///
/// Displacement optima are weak, local in shape: small reverse loops would add to X, so the certificate also asks for a
/// simple curve. With several optima the one with the largest |X| is returned.
///
/// A simple curve with these symmetries keeps each quarter between the diagonals φ₂ = ±φ₁. Of such curves the best may not be
/// among them but a limit of them, which touches its own image along a diagonal (as the paper's gait in the sector does) or
/// begins in the straight shape. Such a gait, with its `diagonal` arcs, is returned where it carries farther and a bound keeps
/// the angles from above, unless [`DisplacementProblem::simple`] leaves it out. Its bounds say so: they have the sector.
///
/// Shapes that a gait should not go round may lie off all bounds. Then the gaits that carry farthest reach them along a slit,
/// out and back along itself. Slits along the diagonals are found; others are not, and what is returned may carry less far
/// than a gait that is no optimum: [`OptimalGait::outdone_over_length`].
///
/// A gait that is the best of its symmetry and a saddle among all closed curves is none: it fails its certificate.
///
/// # Errors
/// [`DisplacementError`]: what is wrong with the problem, or why it has no optimum.
///
/// ```
/// use gait_optimizer::{DisplacementProblem, displacement};
/// use swimmer_model::Swimmer;
///
/// let bounded = displacement(&DisplacementProblem::new(Swimmer::robot()).with_max_angle(1.5))?;
/// let kinds: Vec<_> = bounded.arcs.iter().map(|arc| arc.kind.word()).collect();
/// assert!(kinds.contains(&"upper"), "{kinds:?}");
/// # Ok::<(), gait_optimizer::DisplacementError>(())
/// ```
pub fn displacement(problem: &DisplacementProblem) -> Result<OptimalGait, DisplacementError> {
    let gait = best_symmetric(problem)?;
    if gait.certificate.pass() {
        Ok(gait)
    } else {
        let gait = Box::new(gait);
        Err(DisplacementError::Saddle { gait })
    }
}

/// The same, be it a saddle among all closed curves.
pub(crate) fn best_symmetric(
    problem: &DisplacementProblem,
) -> Result<OptimalGait, DisplacementError> {
    let model = problem.validated()?;
    refuse_immobile(&model, &problem.bounds)?;
    let links = &problem.swimmer.links;
    let bounds = problem.searched();
    let region = Region::new(&bounds, links);
    let (mut answer, seen) = best(problem, &model, (&bounds, &region));
    if problem.may_touch() {
        let carries = answer
            .as_ref()
            .map_or(0.0, |gait| gait.displacement_over_length.abs());
        let farthest = seen.farthest(carries * (1.0 + OUTDONE));
        let farthest = farthest.map(|(_, far)| far);
        match &mut answer {
            Ok(gait) => gait.outdone_over_length = farthest,
            Err(DisplacementError::NoOptimum { outdone, .. }) => *outdone = farthest,
            Err(_) => {}
        }
    }
    answer
}

/// How much farther, relatively, a gait that is no optimum must carry to be told of.
const OUTDONE: f64 = 1e-6;

/// Every gait that the search finds, farthest first: also those that fail their certificate, and those that touch their own
/// images where [`displacement()`] would look for them.
pub(crate) fn every(problem: &DisplacementProblem) -> Result<Vec<OptimalGait>, DisplacementError> {
    let model = problem.validated()?;
    refuse_immobile(&model, &problem.bounds)?;
    let bounds = problem.searched();
    let region = Region::new(&bounds, &problem.swimmer.links);
    let found = candidates(problem, &model, (&bounds, &region), SCAN_POINTS).found;
    let gaits = found
        .iter()
        .filter_map(|candidate| certified(problem, &model, candidate));
    let mut gaits: Vec<_> = gaits.collect();
    gaits.sort_by(|a, b| b.displacement.abs().total_cmp(&a.displacement.abs()));
    Ok(gaits)
}

/// A candidate as a full cycle with its certificate; none where it cannot even be traced.
fn certified(
    problem: &DisplacementProblem,
    model: &Model<f64>,
    candidate: &Candidate,
) -> Option<OptimalGait> {
    let bounds = problem.bounds_of(candidate);
    // The arcs know this closer than the samples do.
    let displacement_over_length = 4.0 * candidate.quarter.end[2];
    let of = (Objective::Displacement, &problem.swimmer, &bounds);
    let mut gait = decided(problem.quarter_samples, |samples| {
        let cycle = candidate.cycle(model, samples)?;
        let stroke = cycle.swum(model)?;
        Some(OptimalGait {
            displacement_over_length,
            displacement: displacement_over_length * problem.swimmer.total_length(),
            ..OptimalGait::of_cycle(of, true, cycle, &stroke)
        })
    })?;
    // What the arcs say of themselves.
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
