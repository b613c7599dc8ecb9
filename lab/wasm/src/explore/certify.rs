//! `certify`: evaluates the necessary conditions for a gait, with the keys of `swimmer certify --json`.

use operations::bounds::BoundsRequest;
use operations::{Context, Files, GaitSource, certify};
use serde::Deserialize;

use super::objective;
use crate::calls::{Lab, Outcome, json, parsed};
use crate::input::SwimmerText;

#[derive(Deserialize)]
struct Request {
    swimmer: SwimmerText,
    gait: GaitSource,
    objective: Option<String>,
    #[serde(default)]
    bounds: BoundsRequest,
}

/// Certifies a gait.
pub(super) fn run(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: Request = parsed(bytes)?;
    let swimmer = request.swimmer.read()?;
    let gait = request.gait.file(Files::Unavailable)?;
    let options = certify::Options {
        objective: objective::parse(request.objective.as_deref())?,
        fixed_period: false,
        bounds: request.bounds,
    };
    let mut context = Context::without_files();
    json(&certify::run(&swimmer, gait, &options, &mut context)?)
}
