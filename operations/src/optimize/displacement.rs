//! Simple gaits of most displacement per cycle.

use gait_optimizer::{
    DisplacementError, DisplacementProblem, Heading, displacement_watched, robust_displacement,
};
use serde::{Deserialize, Serialize};
use swimmer_files::Objective;

use super::closed::{ClosedCurve, Found};
use super::timing::{self, TimedGait};
use super::{ALL_SEARCHES, GaitOutput, Quarter, left_out, robust, searched, split, warn_if_beyond};
use crate::bounds::BoundsRequest;
use crate::context::Stage;
use crate::{Context, Error, SwimmerSource};

/// Sign of X of a gait that is run counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Sign {
    /// X > 0.
    #[serde(rename = "+")]
    Plus,
    /// X < 0.
    #[serde(rename = "-")]
    Minus,
}

/// Search for the simple gait of most displacement.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Request {
    /// The swimmer.
    pub swimmer: SwimmerSource,
    /// Bounds on the shapes.
    #[serde(default)]
    pub bounds: BoundsRequest,
    /// Sense of the gait; `None` for the farther one, run so that it swims forwards.
    #[serde(default)]
    pub sign: Option<Sign>,
    /// Uncertainty to design for.
    #[serde(default)]
    pub robust: Option<robust::Request>,
    /// Timing under a limit on the servos' rate.
    #[serde(default)]
    pub timing: Option<timing::Request>,
}

/// The gait. The JSON document of `swimmer optimize displacement`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "DisplacementOutput")
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
    schemars(rename = "SymmetricDisplacementOutput")
)]
pub struct Symmetric {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Requested sense, for text output.
    #[serde(skip)]
    pub sign: Option<Sign>,
    /// Displacement and arcs.
    #[serde(flatten)]
    pub quarter: Quarter,
    /// Number of extremals that the search found in the class, if it counts them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extremals: Option<usize>,
    /// Certificate, timing and file.
    #[serde(flatten)]
    pub gait: GaitOutput,
}

/// A gait of a swimmer whose side links differ.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "ClosedDisplacementOutput")
)]
pub struct Closed {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
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
    let (name, is_playable) = (&file.name, request.bounds.playable);
    let problem = DisplacementProblem {
        bounds: request.bounds.of(&file),
        heading: request.sign.map(|sign| match sign {
            Sign::Plus => Heading::Forwards,
            Sign::Minus => Heading::Backwards,
        }),
        ..DisplacementProblem::new(file.swimmer)
    };
    if let Some(robust) = &request.robust {
        if !ALL_SEARCHES {
            return Err(left_out("the design for an uncertain swimmer"));
        }
        let uncertainty = robust.uncertainty(&file, context)?;
        let over = robust.over.into();
        let found = context.timed(Stage::Search, |watch| {
            robust_displacement(&problem, &uncertainty, over, watch)
                .map_err(|error| robust::refused(error, &request.bounds))
        });
        let output = robust::describe(&file, split(found)?, request.timing, context)?;
        return Ok(Output::Robust(output));
    }
    if !file.swimmer.is_symmetric() {
        if !ALL_SEARCHES {
            return Err(left_out("the search for gaits of side links that differ"));
        }
        if request.sign.is_some() {
            return Err(Error::refused(
                "--sign is that of gaits with the paper's symmetries, and the side links of this swimmer differ: leave it out",
            ));
        }
        let objective = Objective::Displacement;
        let found = Found::search(&file, objective, problem.bounds, is_playable, context);
        let (found, seconds) = split(found)?;
        warn_if_beyond(&file, found.gait(), context);
        let timed = TimedGait::new(request.timing, name, found.gait())?;
        return Ok(Output::Closed(Closed {
            name: name.clone(),
            curve: found.describe(objective),
            gait: GaitOutput::new(name, found.gait(), timed, seconds),
        }));
    }
    let found = context.timed(Stage::Search, |watch| {
        let search = |bounds| {
            let problem = DisplacementProblem { bounds, ..problem };
            Ok(displacement_watched(&problem, watch)?)
        };
        searched(&file, is_playable, problem.bounds, |gait| gait, search)
    });
    let (gait, seconds) = split(found)?;
    warn_if_beyond(&file, &gait, context);
    let timed = TimedGait::new(request.timing, name, &gait)?;
    Ok(Output::Symmetric(Symmetric {
        name: name.clone(),
        sign: request.sign,
        quarter: Quarter::new(&gait),
        extremals: gait.extremals,
        gait: GaitOutput::new(name, &gait, timed, seconds),
    }))
}

impl From<DisplacementError> for Error {
    /// An invalid problem is bad input; one without an optimum is a failure.
    fn from(error: DisplacementError) -> Self {
        match error {
            DisplacementError::Problem(_) => Self::bad_input(&error),
            _ => Self::failed(&error).with_details(error.details()),
        }
    }
}
