//! Doubts about the gaits that runs are said to have swum: by how far they swayed, and by their link logs.

use std::path::Path;

use calibrate::{CampaignData, RunResult, amplitude_by_sway, other_gaits, predict};
use swimmer_files::{Campaign, GaitSpec, SwimmerFile};

use crate::quantity;

/// An amplitude that fits the sway less well than this belongs to another gait, as a share: of a single run of a swimmer that is
/// only taken to be this one.
const OFF_ALONE: f64 = 0.1;
/// Evidence against the gaits that a campaign names, run by run.
pub(super) fn of_campaign(
    campaign: &Campaign,
    data: &CampaignData,
    runs: &[RunResult],
    swimmer: &SwimmerFile,
) -> Vec<String> {
    let name = |index: usize| {
        let track = campaign.runs.get(index).map(|run| run.track.as_path());
        let track = track.unwrap_or_else(|| Path::new(""));
        let name = track.file_name().unwrap_or(track.as_os_str());
        name.display().to_string()
    };
    let mut said = data.doubts.clone();
    let unlike = other_gaits(campaign, runs, swimmer);
    said.extend(
        unlike
            .iter()
            .map(|other| format!("{}: {other}", name(other.index))),
    );
    said
}

/// Evidence against the gait that a single run is said to have swum.
pub(super) fn of_single(
    run: &RunResult,
    gait: &GaitSpec,
    period_s: f64,
    swimmer: &SwimmerFile,
) -> Vec<String> {
    let mut said = Vec::new();
    let foretold = gait
        .load()
        .ok()
        .and_then(|gait| predict(swimmer, &gait, period_s).ok());
    if let Some(foretold) = foretold
        && foretold.x_m * run.cycles.x.mean < 0.0
    {
        said.push(format!(
            "it swims against the model (X {}, model {}): the gait ran {} --gait), or front and back are exchanged",
            quantity::length(run.cycles.x.mean),
            quantity::length(foretold.x_m),
            if gait.is_reversed() {
                "counter-clockwise (take :cw off"
            } else {
                "clockwise (add :cw to"
            }
        ));
    }
    if let Some((amplitude, factor)) = amplitude_by_sway(run, gait, period_s, swimmer)
        && (factor - 1.0).abs() > OFF_ALONE
    {
        said.push(format!(
            "it sways like a gait of {}, not of {}, if the swimmer is `{}`: is the gait another, or the swimmer?",
            quantity::angle(amplitude * factor),
            quantity::angle(amplitude),
            swimmer.name
        ));
    }
    said
}
