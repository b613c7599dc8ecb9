//! Simple closed gaits of most displacement across the heading, without net rotation.

use gait_optimizer::{Arc, Sideways, SidewaysError, SidewaysProblem, sideways};
use serde::{Deserialize, Serialize};

use super::{GaitOutput, searched, split, warn_if_beyond};
use crate::bounds::BoundsRequest;
use crate::context::Stage;
use crate::{Context, Error, SwimmerSource};

/// Search for the gait of most displacement sideways.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Request {
    /// The swimmer.
    pub swimmer: SwimmerSource,
    /// Bounds on the shapes.
    #[serde(default)]
    pub bounds: BoundsRequest,
}

/// The gait. The JSON document of `swimmer optimize sideways`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SidewaysOutput")
)]
pub struct Output {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Displacement across the heading at the first sample, over the total length, positive.
    pub lateral_over_length: f64,
    /// Displacement along that heading, over the total length.
    pub displacement_over_length: f64,
    /// Net rotation \[rad\].
    pub rotation_rad: f64,
    /// Direction of the displacement relative to the mean heading \[rad\]; null if it cannot be evaluated.
    pub heading_rad: Option<f64>,
    /// Number of simple loops found.
    pub loops: usize,
    /// Arcs in order.
    pub arcs: Vec<Arc>,
    /// Certificate and file.
    #[serde(flatten)]
    pub gait: GaitOutput,
}

/// Finds the gait. Warns if it exceeds a limit of the robot.
///
/// # Errors
/// The request is invalid, or the search finds no gait.
pub fn run(request: &Request, context: &mut Context) -> Result<Output, Error> {
    let file = request.swimmer.load(context)?;
    let problem = SidewaysProblem {
        bounds: request.bounds.of(&file),
        threads: context.threads,
        ..SidewaysProblem::new(file.swimmer)
    };
    let found = context.timed(Stage::Loops, |watch| {
        let search = |bounds| Ok(sideways(&SidewaysProblem { bounds, ..problem }, watch)?);
        let is_playable = request.bounds.playable;
        let bounds = problem.bounds;
        searched(
            &file,
            is_playable,
            bounds,
            |found: &Sideways| &found.gait,
            search,
        )
    });
    let (found, seconds) = split(found)?;
    let gait = &found.gait;
    warn_if_beyond(&file, gait, context);
    Ok(Output {
        name: file.name.clone(),
        lateral_over_length: found.lateral_over_length,
        displacement_over_length: gait.displacement_over_length,
        rotation_rad: gait.rotation,
        heading_rad: gait.heading(),
        loops: found.loops,
        arcs: gait.arcs.clone(),
        gait: GaitOutput::new(&file.name, gait, None, seconds),
    })
}

impl From<SidewaysError> for Error {
    /// An invalid problem is bad input; one without an optimum is a failure.
    fn from(error: SidewaysError) -> Self {
        match error {
            SidewaysError::Problem(_) => Self::bad_input(&error),
            SidewaysError::NoOptimum { .. } => Self::failed(&error),
        }
    }
}
