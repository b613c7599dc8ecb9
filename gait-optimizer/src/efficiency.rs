//! Gaits of most Lighthill efficiency (paper, section V), in the class of closed curves with the paper's two symmetries.
//!
//! The chain needs no guess: circles whose X/S has a local maximum over the amplitude start Fourier series of rising order
//! ([`fourier`]), and shooting takes a series of low order to an extremal of the maximum principle (`extremal`, which also
//! makes the gait with its certificate).

mod bounded;
mod chain;
mod error;
mod fourier;
mod near;

use std::fmt;

use swimmer_files::{AnyGait, Bounds};
use swimmer_model::{Model, Swimmer};

use crate::certificate::{Condition, crossings, simple_and_turning_once};
use crate::extremal::gait::gait;
use crate::extremal::{Extremal, Unpolished, polish, walls};
use crate::immobile::refuse_immobile;
use crate::optimal_gait::{EfficiencyFigures, OptimalGait};
use crate::problem::{GaitClass, InvalidProblem, validated};
pub use bounded::Reached;
pub(crate) use chain::starts;
use chain::{Origin, same_gait};
pub use error::EfficiencyError;
pub(crate) use fourier::{Expansion, Objective, Value, climb};
pub use near::EfficiencySeed;

/// Which of the two optima.
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

    /// Start angles are above this \[rad\].
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

/// What leads to the guess that is shot from. Every method ends with the same shooting and certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// The fastest that converges.
    Auto,
    /// Fourier series alone, up to the order at which they have settled.
    Fourier,
    /// Fourier series of low order.
    Shooting,
}

impl Method {
    /// The word on the command line and in JSON.
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

/// An efficiency problem: whose gait, which of the optima, how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EfficiencyProblem {
    /// The swimmer; its side links must be alike.
    pub swimmer: Swimmer<f64>,
    /// Which optimum.
    pub branch: Branch,
    /// How.
    pub method: Method,
    /// Bounds on the joint angles; `max_angle` and `no_overlap` apply.
    pub bounds: Bounds,
    /// Samples of the quarter gait; the cycle has four times as many.
    pub quarter_samples: usize,
}

impl EfficiencyProblem {
    /// The problem without bounds.
    pub fn new(swimmer: Swimmer<f64>, branch: Branch) -> Self {
        Self {
            swimmer,
            branch,
            method: Method::Auto,
            bounds: Bounds::default(),
            quarter_samples: 192,
        }
    }

    /// The model of the problem's swimmer with L = 1.
    ///
    /// # Errors
    /// [`InvalidProblem`]: what is wrong with the problem.
    pub fn validated(&self) -> Result<Model<f64>, InvalidProblem> {
        validated(&self.swimmer, &self.bounds, GaitClass::Symmetric)
    }
}

/// The most efficient gait of a branch. With several local optima on it, the most efficient.
///
/// # Errors
/// [`EfficiencyError`]: what is wrong with the problem, or why the branch has no optimum.
pub fn efficiency(problem: &EfficiencyProblem) -> Result<OptimalGait, EfficiencyError> {
    no_saddle(problem.branch, best_symmetric(problem)?)
}

/// The most efficient gait of a branch among those with the paper's symmetries, be it a saddle among all closed curves.
pub(crate) fn best_symmetric(problem: &EfficiencyProblem) -> Result<OptimalGait, EfficiencyError> {
    let model = problem.validated()?;
    refuse_immobile(&model, &problem.bounds)?;
    let branch = problem.branch;
    let mut refused = EfficiencyError::NoStart {
        branch,
        best: f64::NAN,
    };
    let mut led_to = Vec::new();
    for start in starts(&model, branch)? {
        match chain::extremal_from(&model, (branch, problem.method), start) {
            Ok(found) => led_to.push(found),
            Err(error) => refused = refused.or_farther(error),
        }
    }
    let efficiency = |(extremal, _): &(Extremal, Origin)| extremal.efficiency(&model);
    led_to.sort_by(|a, b| efficiency(b).total_cmp(&efficiency(a)));
    let mut best: Option<Found> = None;
    for (extremal, origin) in led_to {
        match free(problem, &model, extremal, origin) {
            // An optimum among all curves goes before one among gaits of its symmetry.
            Ok(found) if found.gait.certificate.pass() => {
                best = Some(found);
                break;
            }
            Ok(found) => best = best.or(Some(found)),
            Err(error) => refused = refused.or_farther(error),
        }
    }
    match best {
        Some(free) => within_bounds(problem, &model, &free),
        None => Err(refused),
    }
}

/// A free gait with the paper's two symmetries, from φ₁ = φ₂ > 0 counter-clockwise, that a direct method found by itself.
#[derive(Debug, Clone, Copy)]
pub struct Direct<'a> {
    /// The method's name.
    pub method: &'static str,
    /// The gait.
    pub gait: &'a AnyGait,
    /// The method's own ξ.
    pub efficiency: f64,
}

/// As [`efficiency()`], with a gait of another method to start from, where that one is: it is shot, certified and, where the problem
/// has bounds, followed as they tighten.
///
/// ```
/// use gait_optimizer::{Branch, Direct, EfficiencyProblem, efficiency, efficiency_from};
/// use swimmer_model::Swimmer;
///
/// let mut problem = EfficiencyProblem::new(Swimmer::purcell(), Branch::Small);
/// let near = efficiency(&problem).unwrap();
/// problem.swimmer.chi = 2.01;
/// let direct = Direct { method: "another swimmer's", gait: &near.gait().unwrap(), efficiency: near.efficiency };
/// let found = efficiency_from(&problem, &direct).unwrap();
/// assert!((found.efficiency - efficiency(&problem).unwrap().efficiency).abs() < 1e-12);
/// ```
///
/// # Errors
/// As [`efficiency()`]; [`EfficiencyError::NotConverged`] where no optimum lies near the gait.
pub fn efficiency_from(
    problem: &EfficiencyProblem,
    direct: &Direct<'_>,
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
    no_saddle(problem.branch, within_bounds(problem, &model, &free)?)
}

/// A free optimum under the problem's bounds.
fn within_bounds(
    problem: &EfficiencyProblem,
    model: &Model<f64>,
    free: &Found,
) -> Result<OptimalGait, EfficiencyError> {
    let walls = walls(&problem.bounds, &problem.swimmer.links);
    let depths = free.gait.phi().iter().filter_map(|phi| walls.nearest(phi));
    // A free gait that keeps the bounds is the optimum under them too.
    if depths.map(|(_, depth)| depth).all(|depth| depth <= 0.0) {
        return Ok(OptimalGait {
            bounds: problem.bounds,
            ..free.gait.clone()
        });
    }
    bounded::bounded(problem, model, free)
}

/// A gait that no other nearby outdoes, with the paper's symmetries or without.
fn no_saddle(branch: Branch, gait: OptimalGait) -> Result<OptimalGait, EfficiencyError> {
    if gait.certificate.pass() {
        return Ok(gait);
    }
    let gait = Box::new(gait);
    Err(EfficiencyError::Saddle { branch, gait })
}

/// A free extremal as a gait of the branch, certified among those of its symmetry.
fn free(
    problem: &EfficiencyProblem,
    model: &Model<f64>,
    extremal: Extremal,
    origin: Origin,
) -> Result<Found, EfficiencyError> {
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
    Ok(Found {
        gait: certified(branch, found.gait)?,
        ..found
    })
}

/// A gait that no other with the paper's symmetries outdoes nearby.
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

/// A gait and the extremal that it samples.
#[derive(Debug, Clone)]
struct Found {
    gait: OptimalGait,
    extremal: Extremal,
}

/// An extremal as a gait with its certificate, not yet looked at.
fn finished(
    (problem, model, bounds): (&EfficiencyProblem, &Model<f64>, &Bounds),
    extremal: Extremal,
    origin: Origin,
) -> Result<Found, Unpolished> {
    let samples = 4 * problem.quarter_samples.max(16);
    let mut gait = gait((&problem.swimmer, model, bounds), &extremal, samples)?;
    // An atlas lists gaits that cross themselves as well.
    let simple = simple_and_turning_once(gait.phi(), gait.phi());
    gait.certificate = gait.certificate.with(simple.to_vec());
    let power_variation = gait.certificate.value(Condition::ConstantPower);
    gait.efficiency_figures = Some(EfficiencyFigures {
        residual: extremal.residual,
        power_variation: power_variation.unwrap_or(f64::NAN),
        method: origin.method,
        direct_efficiency: origin.direct_efficiency,
    });
    Ok(Found { gait, extremal })
}
