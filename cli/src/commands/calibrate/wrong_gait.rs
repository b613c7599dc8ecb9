//! Whether each run swam the gait that it is said to have swum: by how far it swayed, by its link log, and by other runs that hold
//! the very same recording.

use std::collections::HashMap;
use std::path::Path;

use calibrate::{CampaignData, RunResult, amplitude_by_sway, other_gaits, predict};
use swimmer_files::{Campaign, GaitSpec, SwimmerFile, hash_of};

use crate::quantity;

/// An amplitude that fits the sway less well than this belongs to another gait, as a share: of a single run of a swimmer that is
/// only taken to be this one.
const OFF_ALONE: f64 = 0.1;
/// What speaks against the gaits that a campaign names, run by run.
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
    let mut said = twice(campaign);
    said.extend_from_slice(&data.doubts);
    let unlike = other_gaits(campaign, runs, swimmer);
    said.extend(
        unlike
            .iter()
            .map(|other| format!("{}: {other}", name(other.index))),
    );
    said
}

/// What speaks against the gait that a single run is said to have swum.
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
            "it swims against the model (X {}, model {}): the gait ran clockwise (add :cw to --gait), or front and back are exchanged",
            quantity::length(run.cycles.x.mean),
            quantity::length(foretold.x_m)
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

/// Runs whose files hold the same bytes. Recordings may be gigabytes: only those of one length are read, a piece at a time.
fn twice(campaign: &Campaign) -> Vec<String> {
    let mut of_length: HashMap<u64, Vec<&Path>> = HashMap::new();
    for run in &campaign.runs {
        if run.told.is_none()
            && run.exclude.is_none()
            && let Ok(file) = std::fs::metadata(&run.track)
        {
            of_length.entry(file.len()).or_default().push(&run.track);
        }
    }
    let mut said = Vec::new();
    for files in of_length.into_values().filter(|files| files.len() > 1) {
        let mut seen: HashMap<String, &Path> = HashMap::new();
        for file in files {
            let Ok(hash) = hash_of(file) else { continue };
            match seen.get(&hash) {
                Some(other) => said.push(format!(
                    "{} and {} hold the same recording: one of two runs names the wrong file",
                    other.display(),
                    file.display()
                )),
                None => {
                    seen.insert(hash, file);
                }
            }
        }
    }
    said.sort();
    said
}
