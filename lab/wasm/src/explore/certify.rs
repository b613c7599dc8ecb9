//! `certify`: evaluates the necessary conditions for a gait, with the keys of `swimmer certify --json`.

use gait_optimizer::{Bounds, Objective};
use operations::{Files, GaitSource};
use serde::Deserialize;

use super::bounds::{BoundsAsked, objective};
use crate::calls::{Lab, Outcome, json, parsed};
use crate::input::SwimmerText;

#[derive(Deserialize)]
struct Asked {
    swimmer: SwimmerText,
    gait: GaitSource,
    objective: Option<String>,
    #[serde(default)]
    bounds: BoundsAsked,
}

/// Certifies a gait.
pub(super) fn certify(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: Asked = parsed(bytes)?;
    let swimmer = asked.swimmer.read()?;
    let file = asked.gait.file(Files::Unavailable)?;
    let objective = objective(asked.objective.as_deref())?.unwrap_or(file.objective);
    if objective == Objective::Unspecified {
        return Err("certifying the gait: say what it shall be optimal for".to_owned());
    }
    let told = asked.bounds.into();
    let bounds = if told == Bounds::default() {
        file.bounds
    } else {
        told
    };
    let certificate = gait_optimizer::certify(&swimmer.swimmer, &file, objective, &bounds)
        .map_err(|why| why.to_string())?;
    json(&certificate)
}
