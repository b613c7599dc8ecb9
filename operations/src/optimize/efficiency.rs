//! Gaits of most Lighthill efficiency.

use gait_optimizer::{
    Branch, EfficiencyError, EfficiencyProblem, OptimalGait, Watch, efficiency_watched,
    robust_efficiency,
};
use serde::{Deserialize, Serialize};
use swimmer_files::{Bounds, Objective, SwimmerFile};

use super::closed::{ClosedCurve, Found};
use super::timing::{self, TimedGait};
use super::{
    ALL_SEARCHES, EfficiencyFigures, GaitOutput, Quarter, left_out, robust, searched, split,
    warn_if_beyond,
};
use crate::bounds::BoundsRequest;
use crate::context::Stage;
use crate::{Context, Error, SwimmerSource};

/// Default order of a robust gait's series.
const ROBUST_ORDER: usize = 6;

/// Local optimum.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Optimum {
    /// X > 0.
    #[default]
    Small,
    /// X < 0, with a start angle above 2 rad.
    Large,
}

/// Method of the initial guess.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The first that succeeds.
    #[default]
    Auto,
    /// Fourier series.
    Fourier,
    /// Direct collocation from a circle.
    Collocation,
    /// Multiple shooting from a Fourier gait of low order.
    Shooting,
}

/// Search for a gait of most efficiency.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Request {
    /// The swimmer.
    pub swimmer: SwimmerSource,
    /// Local optimum.
    #[serde(default)]
    pub optimum: Optimum,
    /// Method of the initial guess.
    #[serde(default)]
    pub method: Method,
    /// Bounds on the shapes.
    #[serde(default)]
    pub bounds: BoundsRequest,
    /// Uncertainty to design for.
    #[serde(default)]
    pub robust: Option<robust::Request>,
    /// Order of the Fourier series of a robust gait.
    #[serde(default)]
    pub order: Option<usize>,
    /// Timing under a limit on the servos' rate.
    #[serde(default)]
    pub timing: Option<timing::Request>,
}

/// The gait. The JSON document of `swimmer optimize efficiency`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "EfficiencyOutput")
)]
#[serde(untagged)]
pub enum Output {
    /// A gait with the paper's symmetries.
    Symmetric(Symmetric),
    /// A gait of a swimmer whose side links differ.
    Closed(Closed),
    /// A gait for an uncertain swimmer.
    Robust(robust::Output),
}

/// A gait with the paper's symmetries.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SymmetricEfficiencyOutput")
)]
pub struct Symmetric {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Efficiency ξ of the gait as timed.
    pub efficiency: f64,
    /// Efficiency at constant power, if a limit on the rate changes the timing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efficiency_constant_power: Option<f64>,
    /// Displacement and arcs.
    #[serde(flatten)]
    pub quarter: Quarter,
    /// Numerical quality.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub figures: Option<EfficiencyFigures>,
    /// Certificate, timing and file.
    #[serde(flatten)]
    pub gait: GaitOutput,
}

/// A gait of a swimmer whose side links differ.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "ClosedEfficiencyOutput")
)]
pub struct Closed {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Efficiency ξ of the gait as timed.
    pub efficiency: f64,
    /// Displacement and arcs.
    #[serde(flatten)]
    pub curve: ClosedCurve,
    /// Certificate, timing and file.
    #[serde(flatten)]
    pub gait: GaitOutput,
}

impl Output {
    /// The gait.
    pub fn gait(&self) -> &GaitOutput {
        match self {
            Self::Symmetric(output) => &output.gait,
            Self::Closed(output) => &output.gait,
            Self::Robust(output) => &output.gait,
        }
    }

    /// The gait, so that a front end can name its file.
    pub fn gait_mut(&mut self) -> &mut GaitOutput {
        match self {
            Self::Symmetric(output) => &mut output.gait,
            Self::Closed(output) => &mut output.gait,
            Self::Robust(output) => &mut output.gait,
        }
    }
}

/// Finds the gait. Warns if it exceeds a limit of the robot.
///
/// # Errors
/// The request is invalid, or the search finds no gait.
pub fn run(request: &Request, context: &mut Context) -> Result<Output, Error> {
    let file = request.swimmer.load(context)?;
    let branch = match request.optimum {
        Optimum::Small => Branch::Small,
        Optimum::Large => Branch::Large,
    };
    let problem = EfficiencyProblem {
        method: match request.method {
            Method::Auto | Method::Collocation => gait_optimizer::Method::Auto,
            Method::Fourier => gait_optimizer::Method::Fourier,
            Method::Shooting => gait_optimizer::Method::Shooting,
        },
        bounds: request.bounds.of(&file),
        ..EfficiencyProblem::new(file.swimmer, branch)
    };
    if let Some(robust) = &request.robust {
        if !ALL_SEARCHES {
            return Err(left_out("the design for an uncertain swimmer"));
        }
        let uncertainty = robust.uncertainty(&file, context)?;
        let over = robust.over.into();
        let order = (branch, request.order.unwrap_or(ROBUST_ORDER));
        let found = context.timed(Stage::Search, |watch| {
            let (swimmer, bounds) = (&problem.swimmer, &problem.bounds);
            robust_efficiency(swimmer, order, bounds, &uncertainty, over, watch)
                .map_err(|error| robust::refused(error, &request.bounds))
        });
        let output = robust::describe(&file, split(found)?, request.timing, context)?;
        return Ok(Output::Robust(output));
    }
    if request.order.is_some() {
        return Err(Error::refused(
            "--order is that of a robust gait's Fourier series: give --robust FIT.json or --gain LOW HIGH",
        ));
    }
    if !file.swimmer.is_symmetric() {
        if !ALL_SEARCHES {
            return Err(left_out("the search for gaits of side links that differ"));
        }
        return without_symmetry(request, &file, problem.bounds, context).map(Output::Closed);
    }
    let found = context.timed(Stage::Search, |watch| {
        let search = |bounds| {
            let problem = EfficiencyProblem { bounds, ..problem };
            solve(request.method, &problem, watch)
        };
        let is_playable = request.bounds.playable;
        searched(&file, is_playable, problem.bounds, |gait| gait, search)
    });
    let (gait, seconds) = split(found)?;
    warn_if_beyond(&file, &gait, context);
    let timed = TimedGait::new(request.timing, &file.name, &gait)?;
    Ok(Output::Symmetric(Symmetric {
        name: file.name.clone(),
        efficiency: timed
            .as_ref()
            .map_or(gait.efficiency, |timed| timed.efficiency),
        efficiency_constant_power: timed.as_ref().map(|_| gait.efficiency),
        quarter: Quarter::new(&gait),
        figures: EfficiencyFigures::of_solver(&gait),
        gait: GaitOutput::new(&file.name, &gait, timed, seconds),
    }))
}

/// Solves by the optimiser, or by direct collocation if that method is requested.
fn solve(
    method: Method,
    problem: &EfficiencyProblem,
    watch: Watch<'_>,
) -> Result<OptimalGait, Error> {
    match method {
        Method::Collocation => by_collocation(problem, watch),
        Method::Auto | Method::Fourier | Method::Shooting => {
            Ok(efficiency_watched(problem, watch)?)
        }
    }
}

#[cfg(feature = "all-searches")]
fn by_collocation(problem: &EfficiencyProblem, watch: Watch<'_>) -> Result<OptimalGait, Error> {
    use collocation::CollocationError;

    collocation::efficiency(problem, watch).map_err(|error| match error {
        CollocationError::Polish(error) => error.into(),
        other => Error::failed(&other),
    })
}

#[cfg(not(feature = "all-searches"))]
fn by_collocation(_: &EfficiencyProblem, _: Watch<'_>) -> Result<OptimalGait, Error> {
    Err(left_out("the method `collocation`"))
}

/// Best gait of the closed-curve search, for side links that differ.
fn without_symmetry(
    request: &Request,
    file: &SwimmerFile,
    bounds: Bounds,
    context: &mut Context,
) -> Result<Closed, Error> {
    if request.optimum == Optimum::Large || request.method != Method::Auto {
        return Err(Error::refused(
            "--gait large and --method are of gaits with the paper's symmetries, and the side links of this swimmer differ: \
             leave them out",
        ));
    }
    let objective = Objective::Efficiency;
    let found = Found::search(file, objective, bounds, request.bounds.playable, context);
    let (found, seconds) = split(found)?;
    let gait = found.gait();
    warn_if_beyond(file, gait, context);
    let timed = TimedGait::new(request.timing, &file.name, gait)?;
    Ok(Closed {
        name: file.name.clone(),
        efficiency: timed
            .as_ref()
            .map_or(gait.efficiency, |timed| timed.efficiency),
        curve: found.describe(objective),
        gait: GaitOutput::new(&file.name, gait, timed, seconds),
    })
}

impl From<EfficiencyError> for Error {
    /// An invalid problem is bad input; one without an optimum is a failure.
    fn from(error: EfficiencyError) -> Self {
        if error.is_bad_input() {
            Self::bad_input(&error)
        } else {
            Self::failed(&error).with_details(error.details())
        }
    }
}
