//! Simple closed gaits of most rotation per cycle.

use gait_optimizer::{Arc, Bounds, Turning, TurningError, TurningProblem, turning};
use serde::{Deserialize, Serialize};

use super::{GaitOutput, searched, split, warn_if_beyond};
use crate::bounds::BoundsRequest;
use crate::context::Stage;
use crate::{Context, Error, SwimmerSource};

/// Search for the gait of most rotation.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Request {
    /// The swimmer.
    pub swimmer: SwimmerSource,
    /// Bounds on the shapes.
    #[serde(default)]
    pub bounds: BoundsRequest,
}

/// The gait. The JSON document of `swimmer optimize turning`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "TurningOutput")
)]
pub struct Output {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Bounds of the gait, for text output.
    #[serde(skip)]
    pub bounds: Bounds,
    /// Rotation per cycle \[rad\].
    pub rotation_rad: f64,
    /// Number of connected regions of positive θ curvature.
    pub regions: usize,
    /// Displacement along the heading at the first sample, over the total length.
    pub displacement_over_length: f64,
    /// Displacement across that heading, over the total length.
    pub lateral_over_length: f64,
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
    let swimmer = file.swimmer;
    let search = |bounds| Ok(turning(&TurningProblem { swimmer, bounds })?);
    let found = context.timed(Stage::Search, |_| {
        let (is_playable, bounds) = (request.bounds.playable, request.bounds.of(&file));
        searched(
            &file,
            is_playable,
            bounds,
            |found: &Turning| &found.gait,
            search,
        )
    });
    let (found, seconds) = split(found)?;
    let gait = &found.gait;
    warn_if_beyond(&file, gait, context);
    Ok(Output {
        name: file.name.clone(),
        bounds: gait.bounds,
        rotation_rad: gait.rotation,
        regions: found.regions,
        displacement_over_length: gait.displacement_over_length,
        lateral_over_length: gait.lateral_over_length,
        arcs: gait.arcs.clone(),
        gait: GaitOutput::new(&file.name, gait, None, seconds),
    })
}

impl From<TurningError> for Error {
    /// An invalid problem is bad input; one without a gait is a failure.
    fn from(error: TurningError) -> Self {
        match error {
            TurningError::Problem(_) => Self::bad_input(&error),
            _ => Self::failed(&error),
        }
    }
}
