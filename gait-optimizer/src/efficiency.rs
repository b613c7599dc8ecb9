//! Gaits of most Lighthill efficiency (paper, section V), in the class of closed curves with the paper's two symmetries.
//!
//! The chain needs no guess: circles whose X/S has a local maximum over the amplitude start Fourier series of rising order
//! ([`fourier`]); multiple shooting ([`multiple`]) takes a series of low order to an extremal of the maximum principle, and the
//! paper's single shooting ([`shooting`]) polishes it. The certificate ([`proof`]) is worked out from the finished gait.

mod bounded;
mod by_collocation;
mod chain;
mod error;
pub(crate) mod flow;
pub(crate) mod fourier;
pub(crate) mod multiple;
mod proof;
pub(crate) mod second_order;
pub(crate) mod shooting;
pub(crate) mod start;
pub(crate) mod trace;

use std::fmt;

use swimmer_files::{ArcKind, Bounds, Objective};
use swimmer_model::{Links, Model, Swimmer};

use crate::cycle::Cycle;
use crate::extremal::wall::Walls;
use crate::immobile::refuse_immobile;
use crate::optimal_gait::Solution;
use crate::{Arc, OptimalGait};
pub use bounded::Reached;
use by_collocation::by_collocation;
use chain::Found;
pub use error::EfficiencyError;
use proof::Evidence;
use trace::Trace;

/// Which of the two optima.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Branch {
    /// X > 0.
    Small,
    /// X < 0, with a start angle above 2 rad.
    Large,
}

impl Branch {
    fn sign(self) -> f64 {
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

/// What leads to the start of the polish. Every method ends with the paper's single shooting and its certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// The fastest that converges.
    Auto,
    /// Fourier series alone, up to the order from which the single shooting converges.
    Fourier,
    /// Fourier series of order 3, then direct collocation.
    Collocation,
    /// Fourier series of low order, then multiple shooting.
    Shooting,
}

impl Method {
    /// The word on the command line and in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Fourier => "fourier",
            Self::Collocation => "collocation",
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

    fn validate(&self) -> Result<(), EfficiencyError> {
        let Links { front, back, .. } = self.swimmer.links;
        if (front - back).abs() > 1e-12 * front.abs() {
            return Err(EfficiencyError::Asymmetric { front, back });
        }
        let unknown = |name| Err(EfficiencyError::UnknownBound { name });
        if self.bounds.min_angle.is_some() {
            return unknown("min_angle");
        }
        if self.bounds.sector {
            return unknown("sector");
        }
        let (value, middle) = (self.bounds.clearance, self.swimmer.links.middle);
        if !(value >= 0.0 && value < middle) {
            return Err(EfficiencyError::Clearance { value, middle });
        }
        match self.bounds.max_angle {
            Some(value) if !(value > 0.0 && value.is_finite()) => Err(EfficiencyError::Bound {
                name: "max_angle",
                value,
                problem: "an upper bound must be a finite angle above 0",
            }),
            _ => Ok(()),
        }
    }
}

/// Numbers that only an efficiency gait has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EfficiencyFigures {
    /// Max-norm of the shooting conditions φ₁ − φ₂, x, θ, λ₁ + λ₂ at `t₀`, in units L = `c_t` = `t_f` = 1 (quarter).
    pub residual: f64,
    /// (max − min)/mean of the power along the samples.
    pub power_variation: f64,
    /// What led to the start of the polish.
    pub method: Method,
    /// ξ of the curve that the polish started from, where it is the result of a direct method of its own.
    pub direct_efficiency: Option<f64>,
}

/// The most efficient gait of a branch. With several local optima on it, the most efficient.
///
/// # Errors
/// [`EfficiencyError`]: what is wrong with the problem, or why the branch has no optimum.
pub fn efficiency(problem: &EfficiencyProblem) -> Result<OptimalGait, EfficiencyError> {
    problem.validate()?;
    let model = Model::new(&problem.swimmer.of_unit_length())?;
    refuse_immobile(&model, &problem.bounds)?;
    let mut best: Option<OptimalGait> = None;
    let mut refused: Option<EfficiencyError> = None;
    for start in chain::starts(&model, problem.branch)? {
        match optimum(problem, &model, start) {
            Ok(gait) => {
                if best.as_ref().is_none_or(|b| gait.efficiency > b.efficiency) {
                    best = Some(gait);
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
        (Some(gait), _) if keeps_bounds(problem, &gait) => Ok(gait),
        (Some(gait), _) => bounded::bounded(problem, &model, &gait),
        (None, Some(error)) => Err(error),
        (None, None) => Err(EfficiencyError::NoStart {
            branch: problem.branch,
            best: f64::NAN,
        }),
    }
}

/// The optimum that one start leads to, certified.
fn optimum(
    problem: &EfficiencyProblem,
    model: &Model<f64>,
    start: [f64; 2],
) -> Result<OptimalGait, EfficiencyError> {
    let branch = problem.branch;
    let found = match problem.method {
        Method::Fourier => chain::by_fourier(model, branch, start)?,
        Method::Collocation => by_collocation(model, branch, start)?,
        Method::Shooting => chain::by_multiple_shooting(model, branch, start)?,
        Method::Auto => match chain::by_multiple_shooting(model, branch, start) {
            Err(error @ EfficiencyError::NotConverged { .. }) => {
                by_collocation(model, branch, start).map_err(|_| error)?
            }
            other => other?,
        },
    };
    let gait = certified(problem, model, &found).ok_or(EfficiencyError::NotConverged {
        branch,
        order: 0,
        efficiency: found.polished.efficiency(),
    })?;
    if !branch.contains(&gait) {
        return Err(EfficiencyError::OtherBranch {
            branch,
            efficiency: gait.efficiency,
            displacement_over_length: gait.displacement_over_length,
            start_angle: gait.start_angle,
            definition: branch.definition(),
        });
    }
    if !gait.certificate.pass() {
        return Err(EfficiencyError::NotCertified {
            branch,
            efficiency: gait.efficiency,
            failed: gait.certificate.failures(),
        });
    }
    Ok(gait)
}

/// A polished extremal as a full cycle with its certificate; none where it cannot be followed again.
fn certified(
    problem: &EfficiencyProblem,
    model: &Model<f64>,
    found: &Found,
) -> Option<OptimalGait> {
    let polished = &found.polished;
    let trace = Trace::new(model, &polished.at_end, problem.quarter_samples.max(16))?;
    let deviations = trace.deviations(polished.efficiency());
    let shapes = trace.shapes();
    let cycle = Cycle::of_smooth_quarter(&shapes);
    let stroke = cycle.swum(model)?;
    let second_order = trace
        .states
        .last()
        .and_then(|last| second_order::test(trace.flow, last));
    let certificate = Evidence {
        polished,
        trace: &trace,
        deviations: &deviations,
        second_order,
        cycle: &cycle,
        stroke: &stroke,
    }
    .certificate();
    let links_cross = cycle.links_cross(model);
    let at = |shape: Option<&nalgebra::Vector2<f64>>| shape.map_or([f64::NAN; 2], |s| [s.x, s.y]);
    let mut gait = OptimalGait::new(Solution {
        objective: Objective::Efficiency,
        swimmer: problem.swimmer,
        bounds: problem.bounds,
        symmetric: true,
        arcs: vec![Arc {
            kind: ArcKind::Regular,
            from: at(shapes.first()),
            to: at(shapes.last()),
        }],
        cycle,
        stroke,
        links_cross,
        certificate,
    });
    // The extremal knows these closer than the samples do.
    gait.efficiency = polished.efficiency();
    gait.displacement_over_length = 4.0 * polished.at_end[1];
    gait.displacement = gait.displacement_over_length * problem.swimmer.total_length();
    gait.efficiency_figures = Some(EfficiencyFigures {
        residual: polished.residual,
        power_variation: deviations.power_variation,
        method: found.method,
        direct_efficiency: found.direct_efficiency,
    });
    Some(gait)
}

/// Whether a free gait keeps the bounds: then it is the optimum under them too.
fn keeps_bounds(problem: &EfficiencyProblem, gait: &OptimalGait) -> bool {
    let walls = Walls::new(&problem.bounds, &problem.swimmer.links);
    gait.phi()
        .iter()
        .all(|phi| walls.nearest(phi).is_none_or(|(_, depth)| depth <= 0.0))
}
