//! Gaits of greatest Lighthill efficiency (paper, section V) among closed curves with the paper's two symmetries.
//!
//! No initial guess is needed. Circles whose X/S has a local maximum over the amplitude start Fourier series of rising order
//! ([`fourier`]). Shooting polishes a series of low order to an extremal of Pontryagin's principle (`extremal`, which also
//! computes the gait with its certificate).

mod bounded;
mod chain;
mod error;
mod fourier;
mod near;
mod orders;

use std::fmt;

use swimmer_files::{AnyGait, Bounds};
use swimmer_model::{Model, Swimmer};

use crate::certificate::{Condition, crossings, simple_and_turning_once};
use crate::extremal::gait::gait;
use crate::extremal::{Extremal, Unpolished, polish, walls};
use crate::immobile::refuse_immobile;
use crate::optimal_gait::{EfficiencyFigures, OptimalGait};
use crate::parallel::Watch;
use crate::problem::{GaitClass, InvalidProblem, validated};
pub use bounded::ReachedBounds;
pub(crate) use chain::starts;
use chain::{Origin, same_gait};
pub use error::EfficiencyError;
pub(crate) use fourier::{Expansion, Objective, Value, climb};
pub use near::EfficiencySeed;
pub use orders::efficiency_by_order;

/// Branch of efficiency optima.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Branch {
    /// X > 0.
    Small,
    /// X < 0, with a start angle above 2 rad.
    Large,
}

impl Branch {
    /// Sign of X.
    pub fn sign(self) -> f64 {
        match self {
            Self::Small => 1.0,
            Self::Large => -1.0,
        }
    }

    fn definition(self) -> &'static str {
        match self {
            Self::Small => "X > 0 and a positive start angle",
            Self::Large => "X < 0 and a start angle above 2 rad",
        }
    }

    fn contains(self, gait: &OptimalGait) -> bool {
        self.sign() * gait.displacement_over_length > 0.0 && gait.start_angle > self.least_start()
    }

    /// Least start angle \[rad\].
    fn least_start(self) -> f64 {
        match self {
            Self::Small => 0.0,
            Self::Large => 2.0,
        }
    }
}

impl fmt::Display for Branch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Small => "small",
            Self::Large => "large",
        })
    }
}

/// Method for the initial guess. Every method ends with the same shooting and certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Fastest method that converges.
    Auto,
    /// Fourier series alone, up to the order at which they have converged.
    Fourier,
    /// Fourier series of low order.
    Shooting,
}

impl Method {
    /// Name on the command line and in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Fourier => "fourier",
            Self::Shooting => "shooting",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// Inputs of the search for an efficiency gait.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EfficiencyProblem {
    /// Swimmer with equal side links.
    pub swimmer: Swimmer<f64>,
    /// Branch.
    pub branch: Branch,
    /// Method for the initial guess.
    pub method: Method,
    /// Bounds on the joint angles, of which `max_angle` and `no_overlap` are used.
    pub bounds: Bounds,
    /// Number of samples of the quarter; the cycle has four times as many.
    pub quarter_samples: usize,
}

impl EfficiencyProblem {
    /// Problem without bounds.
    pub fn new(swimmer: Swimmer<f64>, branch: Branch) -> Self {
        Self {
            swimmer,
            branch,
            method: Method::Auto,
            bounds: Bounds::default(),
            quarter_samples: 192,
        }
    }

    /// Validates the problem and returns the model of its swimmer with L = 1.
    ///
    /// # Errors
    /// [`InvalidProblem`] if the problem is invalid.
    pub fn validated(&self) -> Result<Model<f64>, InvalidProblem> {
        self.swimmer.check_efficiency()?;
        validated(&self.swimmer, &self.bounds, GaitClass::Symmetric)
    }
}

/// Returns the gait of greatest efficiency of a branch, the best of several local optima.
///
/// # Errors
/// [`EfficiencyError`] if the problem is invalid or the branch has no optimum.
pub fn efficiency(problem: &EfficiencyProblem) -> Result<OptimalGait, EfficiencyError> {
    efficiency_watched(problem, &|_| ())
}

/// As [`efficiency()`]. `watch` receives the share of the orders of a Fourier series that have been solved, then 1 after each
/// certificate, and the share of the way to the bounds.
///
/// # Errors
/// As [`efficiency()`].
pub fn efficiency_watched(
    problem: &EfficiencyProblem,
    watch: Watch<'_>,
) -> Result<OptimalGait, EfficiencyError> {
    no_saddle(problem.branch, best_symmetric(problem, watch)?)
}

/// Gait of greatest efficiency of a branch among those with the paper's symmetries, even if it is a saddle among all closed curves.
pub(crate) fn best_symmetric(
    problem: &EfficiencyProblem,
    watch: Watch<'_>,
) -> Result<OptimalGait, EfficiencyError> {
    let model = problem.validated()?;
    refuse_immobile(&model, &problem.bounds)?;
    let branch = problem.branch;
    let mut refused = EfficiencyError::NoStart {
        branch,
        best: f64::NAN,
    };
    let mut led_to = Vec::new();
    for start in starts(&model, branch)? {
        match chain::extremal_from(&model, (branch, problem.method), start, watch) {
            Ok(found) => led_to.push(found),
            Err(error) => refused = refused.or_farther(error),
        }
    }
    let efficiency = |(extremal, _): &(Extremal, Origin)| extremal.efficiency(&model);
    led_to.sort_by(|a, b| efficiency(b).total_cmp(&efficiency(a)));
    let mut best: Option<PolishedGait> = None;
    for (extremal, origin) in led_to {
        let polished = free(problem, &model, extremal, origin);
        watch(1.0);
        match polished {
            // An optimum among all curves has priority over one among symmetric gaits.
            Ok(found) if found.gait.certificate.pass() => {
                best = Some(found);
                break;
            }
            Ok(found) => best = best.or(Some(found)),
            Err(error) => refused = refused.or_farther(error),
        }
    }
    match best {
        Some(free) => within_bounds(problem, &model, &free, watch),
        None => Err(refused),
    }
}

/// Free gait of a direct method with the paper's two symmetries, counter-clockwise from φ₁ = φ₂ > 0.
#[derive(Debug, Clone, Copy)]
pub struct Direct<'a> {
    /// Name of the method.
    pub method: &'static str,
    /// The gait.
    pub gait: &'a AnyGait,
    /// ξ of the method itself.
    pub efficiency: f64,
}

/// Solves as [`efficiency()`] does, from the gait of another method: polishes it by shooting, certifies it and, if the problem has
/// bounds, follows it while they tighten. `watch` is that of [`efficiency_watched`].
///
/// ```
/// use gait_optimizer::{Branch, Direct, EfficiencyProblem, efficiency, efficiency_from};
/// use swimmer_model::Swimmer;
///
/// let mut problem = EfficiencyProblem::new(Swimmer::purcell(), Branch::Small);
/// let near = efficiency(&problem).unwrap();
/// problem.swimmer.chi = 2.01;
/// let direct = Direct { method: "another swimmer's", gait: &near.gait().unwrap(), efficiency: near.efficiency };
/// let found = efficiency_from(&problem, &direct, &|_| ()).unwrap();
/// assert!((found.efficiency - efficiency(&problem).unwrap().efficiency).abs() < 1e-12);
/// ```
///
/// # Errors
/// As [`efficiency()`]; [`EfficiencyError::NotConverged`] if there is no optimum near the gait.
pub fn efficiency_from(
    problem: &EfficiencyProblem,
    direct: &Direct<'_>,
    watch: Watch<'_>,
) -> Result<OptimalGait, EfficiencyError> {
    let model = problem.validated()?;
    refuse_immobile(&model, &problem.bounds)?;
    let everywhere = walls(&Bounds::default(), &problem.swimmer.links);
    let extremal = polish(&model, &everywhere, direct.gait, true)
        .ok()
        .and_then(|found| same_gait(&model, found, direct.efficiency, problem.branch.sign()))
        .ok_or(EfficiencyError::NotConverged {
            branch: problem.branch,
            order: 0,
            efficiency: direct.efficiency,
        })?;
    let origin = Origin {
        order: 0,
        method: direct.method,
        direct_efficiency: Some(direct.efficiency),
    };
    let free = free(problem, &model, extremal, origin)?;
    watch(1.0);
    no_saddle(
        problem.branch,
        within_bounds(problem, &model, &free, watch)?,
    )
}

/// Follows a free optimum to the bounds of the problem.
fn within_bounds(
    problem: &EfficiencyProblem,
    model: &Model<f64>,
    free: &PolishedGait,
    watch: Watch<'_>,
) -> Result<OptimalGait, EfficiencyError> {
    let walls = walls(&problem.bounds, &problem.swimmer.links);
    let depths = free.gait.phi().iter().filter_map(|phi| walls.nearest(phi));
    // A free gait that satisfies the bounds is the bounded optimum too.
    if depths.map(|(_, depth)| depth).all(|depth| depth <= 0.0) {
        return Ok(OptimalGait {
            bounds: problem.bounds,
            ..free.gait.clone()
        });
    }
    bounded::bounded(problem, model, free, watch)
}

/// Refuses a gait that is a saddle among all closed curves.
fn no_saddle(branch: Branch, gait: OptimalGait) -> Result<OptimalGait, EfficiencyError> {
    if gait.certificate.pass() {
        return Ok(gait);
    }
    let gait = Box::new(gait);
    Err(EfficiencyError::Saddle { branch, gait })
}

/// Converts a free extremal to a gait of the branch, certified among symmetric gaits.
fn free(
    problem: &EfficiencyProblem,
    model: &Model<f64>,
    extremal: Extremal,
    origin: Origin,
) -> Result<PolishedGait, EfficiencyError> {
    let (branch, order) = (problem.branch, origin.order);
    let efficiency = extremal.efficiency(model);
    let found = finished((problem, model, &Bounds::default()), extremal, origin).map_err(|_| {
        EfficiencyError::NotConverged {
            branch,
            order,
            efficiency,
        }
    })?;
    let gait = &found.gait;
    let crossings = crossings(gait.phi());
    if crossings > 0 {
        return Err(EfficiencyError::CrossesItself {
            branch,
            order,
            efficiency: gait.efficiency,
            crossings,
        });
    }
    if !branch.contains(gait) {
        return Err(EfficiencyError::OtherBranch {
            branch,
            efficiency: gait.efficiency,
            displacement_over_length: gait.displacement_over_length,
            start_angle: gait.start_angle,
            definition: branch.definition(),
        });
    }
    Ok(PolishedGait {
        gait: certified(branch, found.gait)?,
        ..found
    })
}

/// Refuses a gait that is not certified among symmetric gaits.
fn certified(branch: Branch, gait: OptimalGait) -> Result<OptimalGait, EfficiencyError> {
    if gait.certificate.holds_among_symmetric() {
        return Ok(gait);
    }
    Err(EfficiencyError::NotCertified {
        branch,
        efficiency: gait.efficiency,
        failed: gait.certificate.failures(),
    })
}

/// Gait and the extremal from which it was sampled.
#[derive(Debug, Clone)]
struct PolishedGait {
    gait: OptimalGait,
    extremal: Extremal,
}

/// Converts an extremal to a gait with its certificate, which the caller inspects.
fn finished(
    (problem, model, bounds): (&EfficiencyProblem, &Model<f64>, &Bounds),
    extremal: Extremal,
    origin: Origin,
) -> Result<PolishedGait, Unpolished> {
    let samples = 4 * problem.quarter_samples.max(16);
    let mut gait = gait((&problem.swimmer, model, bounds), &extremal, samples)?;
    // Gaits that cross themselves belong to the atlas.
    let simple = simple_and_turning_once(gait.phi(), gait.phi());
    gait.certificate = gait.certificate.with(simple.to_vec());
    let power_variation = gait.certificate.value(Condition::ConstantPower);
    gait.efficiency_figures = Some(EfficiencyFigures {
        residual: extremal.residual,
        power_variation: power_variation.unwrap_or(f64::NAN),
        method: origin.method,
        direct_efficiency: origin.direct_efficiency,
    });
    Ok(PolishedGait { gait, extremal })
}
