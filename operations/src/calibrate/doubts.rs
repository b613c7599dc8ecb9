//! Doubts about the stated gaits of runs, from their sway and their link logs.

use std::path::Path;

use calibrate::{CampaignData, RunResult, amplitude_by_sway, other_gaits, predict};
use swimmer_files::{Campaign, SwimmerFile};

use super::StatedGait;
use crate::text;

/// Relative deviation of the amplitude that fits the sway of a single run, above which the run belongs to another gait. The swimmer
/// of a single run is an assumption.
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
    let mut doubts = data.doubts.clone();
    let unlike = other_gaits(campaign, runs, swimmer);
    doubts.extend(
        unlike
            .iter()
            .map(|other| format!("{}: {other}", name(other.index))),
    );
    doubts
}

/// Evidence against the stated gait of a single run.
pub(super) fn of_single(
    run: &RunResult,
    stated: &StatedGait,
    period_s: f64,
    swimmer: &SwimmerFile,
) -> Vec<String> {
    let mut doubts = Vec::new();
    let gait = &stated.spec;
    let predicted = predict(swimmer, &stated.curve, period_s).ok();
    if let Some(predicted) = predicted
        && predicted.x_m * run.cycles.x.mean < 0.0
    {
        doubts.push(format!(
            "it swims against the model (X {}, model {}): the gait ran {} --gait), or front and back are exchanged",
            text::length(run.cycles.x.mean),
            text::length(predicted.x_m),
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
        doubts.push(format!(
            "it sways like a gait of {}, not of {}, if the swimmer is `{}`: is the gait another, or the swimmer?",
            text::degrees(amplitude * factor),
            text::degrees(amplitude),
            swimmer.name
        ));
    }
    doubts
}
