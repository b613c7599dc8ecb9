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
use crate::extremal::gait::{Order, gait};
use crate::extremal::{Extremal, Unpolished, Walls, polish};
use crate::immobile::refuse_immobile;
use crate::optimal_gait::{EfficiencyFigures, OptimalGait};
use crate::problem::{GaitClass, InvalidProblem, validated};
pub use bounded::Reached;
pub(crate) use chain::starts;
use chain::{Found, same_gait};
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
    let mut best: Option<(OptimalGait, Extremal)> = None;
    let mut refused: Option<EfficiencyError> = None;
    for start in starts(&model, problem.branch)? {
        let led_to = chain::extremal_from(&model, problem.branch, problem.method, start);
        match led_to.and_then(|found| accepted(problem, &model, found)) {
            Ok(found) => {
                // An optimum among all curves goes before one among gaits of its symmetry.
                let rank = |gait: &OptimalGait| (gait.certificate.pass(), gait.efficiency);
                if best
                    .as_ref()
                    .is_none_or(|(known, _)| rank(&found.0) > rank(known))
                {
                    best = Some(found);
                }
            }
            Err(error) => {
                if refused
                    .as_ref()
                    .is_none_or(|r| error.distance() > r.distance())
                {
                    refused = Some(error);
                }
            }
        }
    }
    match (best, refused) {
        (Some(free), _) => within_bounds(problem, &model, free),
        (None, Some(error)) => Err(error),
        (None, None) => Err(EfficiencyError::NoStart {
            branch: problem.branch,
            best: f64::NAN,
        }),
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
    let everywhere = Walls::new(&Bounds::default(), &problem.swimmer.links);
    let extremal = polish(&model, &everywhere, direct.gait, true)
        .ok()
        .and_then(|found| same_gait(&model, found, direct.efficiency, problem.branch.sign()))
        .ok_or(EfficiencyError::NotConverged {
            branch: problem.branch,
            order: 0,
            efficiency: direct.efficiency,
        })?;
    let found = Found {
        extremal,
        order: 0,
        method: direct.method,
        direct_efficiency: Some(direct.efficiency),
    };
    let free = accepted(problem, &model, found)?;
    no_saddle(problem.branch, within_bounds(problem, &model, free)?)
}

/// A free optimum under the problem's bounds.
fn within_bounds(
    problem: &EfficiencyProblem,
    model: &Model<f64>,
    (free, extremal): (OptimalGait, Extremal),
) -> Result<OptimalGait, EfficiencyError> {
    if keeps_bounds(problem, &free) {
        return Ok(OptimalGait {
            bounds: problem.bounds,
            ..free
        });
    }
    bounded::bounded(problem, model, &free, &extremal)
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
fn accepted(
    problem: &EfficiencyProblem,
    model: &Model<f64>,
    found: Found,
) -> Result<(OptimalGait, Extremal), EfficiencyError> {
    let branch = problem.branch;
    let mut gait = finished(problem, model, &found, &Bounds::default()).map_err(|_| {
        EfficiencyError::NotConverged {
            branch,
            order: 0,
            efficiency: found.extremal.efficiency(model),
        }
    })?;
    // Continuation asks this of every gait on the way; a free one is asked here.
    let simple = simple_and_turning_once(gait.phi(), gait.phi());
    gait.certificate = gait.certificate.with(simple.to_vec());
    let crossings = crossings(gait.phi());
    if crossings > 0 {
        return Err(EfficiencyError::CrossesItself {
            branch,
            order: found.order,
            efficiency: gait.efficiency,
            crossings,
        });
    }
    if !branch.contains(&gait) {
        return Err(EfficiencyError::OtherBranch {
            branch,
            efficiency: gait.efficiency,
            displacement_over_length: gait.displacement_over_length,
            start_angle: gait.start_angle,
            definition: branch.definition(),
        });
    }
    Ok((certified(branch, gait)?, found.extremal))
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

/// An extremal as a gait with its certificate, not yet looked at.
fn finished(
    problem: &EfficiencyProblem,
    model: &Model<f64>,
    found: &Found,
    bounds: &Bounds,
) -> Result<OptimalGait, Unpolished> {
    let order = Order {
        swimmer: &problem.swimmer,
        model,
        bounds,
        samples: 4 * problem.quarter_samples.max(16),
    };
    let mut gait = gait(&order, &found.extremal)?;
    let power_variation = gait.certificate.value(Condition::PowerFollowedAgain);
    gait.efficiency_figures = Some(EfficiencyFigures {
        residual: found.extremal.solved.residual,
        power_variation: power_variation.unwrap_or(f64::NAN),
        method: found.method,
        direct_efficiency: found.direct_efficiency,
    });
    Ok(gait)
}

/// Whether a free gait keeps the bounds: then it is the optimum under them too.
fn keeps_bounds(problem: &EfficiencyProblem, gait: &OptimalGait) -> bool {
    let walls = Walls::new(&problem.bounds, &problem.swimmer.links);
    gait.phi()
        .iter()
        .all(|phi| walls.nearest(phi).is_none_or(|(_, depth)| depth <= 0.0))
}
