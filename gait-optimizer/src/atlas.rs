//! The atlas: every locally optimal gait that a seeded multi-start finds, with and without the paper's two symmetries.
//!
//! 1. Each start, a random Fourier curve, runs into a stationary curve of low order by Newton's method inside the bounds
//!    ([`newton`]).
//! 2. Curves that are the same gait are merged ([`distinct`]); images under the swimmer's own symmetries and the reversed curve
//!    count as the same gait.
//! 3. Each remaining curve is polished by the maximum principle to an exact extremal and certified; the certificate includes its
//!    second variation over all closed curves. From a saddle of displacement the search continues along an ascent direction.
//!    Curves that cannot be polished are counted, not listed.
//!
//! Gaits that the solvers of quarter gaits find are starts, too. Those that are certified for the very bounds of the atlas, and
//! of displacement are no saddles among all closed curves, are listed in any case, each counted as one start that ended in it.

mod barrier;
mod displacement;
pub(crate) mod distinct;
mod efficiency;
mod newton;
mod objective;
mod pipeline;
mod sections;
mod starts;

use swimmer_files::{Bounds, Objective};
use swimmer_model::{Model, Swimmer};

use crate::extremal::walls;
use crate::immobile::{Immobile, refuse_immobile};
use crate::optimal_gait::OptimalGait;
use crate::parallel::Watch;
use crate::problem::{GaitClass, InvalidProblem, validated};
use crate::region::Region;

/// Origin of the curves that an atlas starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StartCurves {
    /// Fourier curves of several sizes, centres and aspects.
    Random,
    /// Circles off the straight swimmer, their centres on φ₁ = −φ₂: a look beyond the paper's symmetries by four starts, and by
    /// these alone.
    OffCentre,
}

/// Inputs of an atlas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtlasProblem {
    /// The swimmer; its side links may differ.
    pub swimmer: Swimmer<f64>,
    /// [`Objective::Displacement`]: most net displacement |d| of a simple closed curve. [`Objective::Efficiency`]: most
    /// Lighthill efficiency |d|²/S² of any closed curve. Both without net rotation.
    pub objective: Objective,
    /// Bounds on the shapes: the largest angle and crossing links.
    pub bounds: Bounds,
    /// Number of starts.
    pub starts: usize,
    /// Origin of the start curves.
    pub from: StartCurves,
    /// Seed of the starts: the same seed gives the same atlas on any number of threads.
    pub seed: u64,
    /// Order of the Fourier series that the starts are optimised in before the polish.
    pub order: usize,
    /// Threads to work on, at least 1.
    pub threads: usize,
    /// Samples of each gait's cycle.
    pub samples: usize,
}

impl AtlasProblem {
    /// 200 starts of order 6 on one thread, without bounds.
    pub fn new(swimmer: Swimmer<f64>, objective: Objective) -> Self {
        Self {
            swimmer,
            objective,
            bounds: Bounds::default(),
            starts: 200,
            from: StartCurves::Random,
            seed: 1,
            order: 6,
            threads: 1,
            samples: 1024,
        }
    }

    fn validated(&self) -> Result<Model<f64>, AtlasError> {
        if !matches!(
            self.objective,
            Objective::Displacement | Objective::Efficiency
        ) {
            return Err(AtlasError::Objective {
                objective: self.objective,
            });
        }
        if !(1..=100_000).contains(&self.starts) || !(1..=24).contains(&self.order) {
            return Err(AtlasError::Size {
                starts: self.starts,
                order: self.order,
            });
        }
        if self.objective == Objective::Efficiency {
            self.swimmer
                .check_efficiency()
                .map_err(InvalidProblem::from)?;
        }
        Ok(validated(&self.swimmer, &self.bounds, GaitClass::Closed)?)
    }
}

/// One locally optimal gait.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    /// The gait with its figures and its certificate. `gait.symmetric` is set if it has the paper's two symmetries.
    pub gait: OptimalGait,
    /// Net displacement |d| over L, whatever its direction against the first sample's heading.
    pub distance_over_length: f64,
    /// `true` for a simple curve: it turns once and does not cross itself.
    pub simple: bool,
    /// Number of starts that converged to this gait or to one of its images.
    pub found: usize,
}

/// All that was found, and what became of the rest.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Atlas {
    /// Certified optima, best first.
    pub optima: Vec<Optimum>,
    /// Number of starts: the requested ones and the known gaits.
    pub starts: usize,
    /// Starts that did not settle on any stationary curve.
    pub unsettled: usize,
    /// Starts that left for shapes beyond the horizon of the search (without a bound on the angles).
    pub left: usize,
    /// Starts that ended on a curve whose polish failed, or whose certificate does.
    pub uncertified: usize,
    /// The best of these, as its curve of low order has it, or of the known gaits that are optimal only among gaits of their
    /// symmetry, if that is better than every optimum: |d| over L, or ξ. It is not proven to be optimal.
    pub best_uncertified: Option<f64>,
}

/// Error of an atlas.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AtlasError {
    /// It makes no sense.
    #[error(transparent)]
    Problem(#[from] InvalidProblem),
    /// Gaits do not move it.
    #[error(transparent)]
    Immobile(#[from] Immobile),
    /// Another objective.
    #[error(
        "there is no atlas for the objective `{objective}`; it knows displacement and efficiency"
    )]
    Objective {
        /// Asked for.
        objective: Objective,
    },
    /// Too many or too few starts, or too high an order.
    #[error("{starts} starts of order {order}: give 1 to 100000 starts and an order of 1 to 24")]
    Size {
        /// Asked for.
        starts: usize,
        /// Asked for.
        order: usize,
    },
}

/// Makes an atlas.
///
/// # Errors
/// [`AtlasError`]: what is wrong with the problem. An atlas without any optimum is no error.
///
/// ```
/// use gait_optimizer::{AtlasProblem, Bounds, Objective, atlas};
/// use swimmer_model::Swimmer;
///
/// let problem = AtlasProblem {
///     bounds: Bounds::within(1.2),
///     starts: 1,
///     ..AtlasProblem::new(Swimmer::purcell(), Objective::Displacement)
/// };
/// let found = atlas(&problem)?;
/// assert!(found.optima.iter().all(|optimum| optimum.gait.certificate.pass()));
/// # Ok::<(), gait_optimizer::AtlasError>(())
/// ```
pub fn atlas(problem: &AtlasProblem) -> Result<Atlas, AtlasError> {
    atlas_watched(problem, &|_| ())
}

/// [`atlas()`] with a progress callback.
///
/// # Errors
/// As [`atlas()`].
///
/// ```
/// use std::sync::atomic::{AtomicBool, Ordering};
/// use gait_optimizer::{AtlasProblem, Bounds, Objective, atlas_watched};
/// use swimmer_model::Swimmer;
///
/// let bounds = Bounds::within(1.2);
/// let problem = AtlasProblem { bounds, starts: 1, ..AtlasProblem::new(Swimmer::purcell(), Objective::Displacement) };
/// let finished = AtomicBool::new(false);
/// atlas_watched(&problem, &|share| finished.store(share >= 1.0, Ordering::Relaxed))?;
/// assert!(finished.into_inner(), "the last share is one");
/// # Ok::<(), gait_optimizer::AtlasError>(())
/// ```
pub fn atlas_watched(problem: &AtlasProblem, watch: Watch<'_>) -> Result<Atlas, AtlasError> {
    let model = problem.validated()?;
    refuse_immobile(&model, &problem.bounds)?;
    if matches!(problem.objective, Objective::Efficiency) {
        let asked = efficiency::Efficiency {
            problem,
            model: &model,
            walls: &walls(&problem.bounds, &problem.swimmer.links),
        };
        return Ok(pipeline::run(problem, &model, &asked, watch));
    }
    let asked = displacement::Displacement {
        problem,
        model: &model,
        region: &Region::new(&problem.bounds, &problem.swimmer.links),
    };
    Ok(pipeline::run(problem, &model, &asked, watch))
}

#[cfg(test)]
mod tests;
