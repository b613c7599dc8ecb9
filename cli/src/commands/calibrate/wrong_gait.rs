//! Whether each run swam the gait that it is said to have swum: by how far it swayed, by its link log, and by other runs that hold
//! the very same recording.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use calibrate::{RunResult, amplitude_by_sway, other_gaits, predict};
use link_protocol::{Direction, Message, StateName};
use swimmer_files::{
    AnyGait, Campaign, GaitSpec, LinkFrame, SwimmerFile, hash_of, plays, read_link_log,
};
use swimmer_model::Gait as _;

use crate::quantity;

/// An amplitude that fits the sway less well than this belongs to another gait, as a share: of a single run of a swimmer that is
/// only taken to be this one.
const OFF_ALONE: f64 = 0.1;
/// A joint that was told to be further off than this was told another gait, rad: dead bands and rounding are far smaller.
const OFF_LOG: f64 = 0.035;

/// What speaks against the gaits that a campaign names, run by run.
pub(super) fn of_campaign(
    campaign: &Campaign,
    runs: &[RunResult],
    swimmer: &SwimmerFile,
) -> Vec<String> {
    let folder = |path: &Path| path.file_name().map_or_else(|| path.into(), PathBuf::from);
    let name = |index: usize| {
        let track = campaign.runs.get(index).map(|run| run.track.as_path());
        folder(track.unwrap_or_else(|| Path::new("")))
            .display()
            .to_string()
    };
    let mut said = twice(campaign);
    for run in &campaign.runs {
        said.extend(
            by_log(run)
                .into_iter()
                .map(|why| format!("{}: {why}", folder(&run.track).display())),
        );
    }
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

/// The middle one.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
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

/// What the run's link log says otherwise, and that it has no end.
fn by_log(run: &swimmer_files::CampaignRun) -> Vec<String> {
    let Some(log) = run
        .timing
        .log
        .as_deref()
        .and_then(|path| read_link_log(path).ok())
    else {
        return Vec::new();
    };
    let mut said = Vec::new();
    if !log.ended {
        said.push(format!(
            "its link log has no end: its writer was killed or its disk was full; the {} frames before were used",
            log.frames.len()
        ));
    }
    let plays = plays(&log.frames);
    let Some(play) = plays.get(run.timing.play.unwrap_or(1).wrapping_sub(1)) else {
        return said;
    };
    if (play.period_s / run.period_s - 1.0).abs() > 0.01 {
        said.push(format!(
            "the link log says otherwise: a cycle took {} s, not {} s",
            play.period_s, run.period_s
        ));
    }
    if let Ok(gait) = run.gait.load() {
        said.extend(told_another(&log.frames, play.started_s..play.ended_s, &gait).map(|(told, named)| {
            format!(
                "the link log says otherwise: its joints were told up to {}, and {} turns them up to {}{}",
                quantity::angle(told),
                quantity::gait(&run.gait),
                quantity::angle(named),
                if (told - named).abs() < OFF_LOG {
                    " the same way round or not: add or remove :cw"
                } else {
                    ""
                }
            )
        }));
    }
    said
}

/// The largest angles told and named, where half of what the joints were told is not this gait.
fn told_another(
    frames: &[LinkFrame],
    within: std::ops::Range<f64>,
    gait: &AnyGait,
) -> Option<(f64, f64)> {
    let mut off = Vec::new();
    let (mut told, mut named) = (0.0_f64, 0.0_f64);
    for frame in frames
        .iter()
        .filter(|frame| frame.direction == Direction::ToHost)
    {
        let Some(Ok(Message::Telemetry(telemetry))) =
            frame.received().map(|received| received.message)
        else {
            continue;
        };
        let at = telemetry.robot_us as f64 * 1e-6;
        if telemetry.state != StateName::Playing || !within.contains(&at) {
            continue;
        }
        let setpoint = telemetry.setpoint.map(|angle| f64::from(angle) * 1e-4);
        let phi = gait.at(f64::from(telemetry.phase) / 65_536.0).phi;
        off.push((setpoint[0] - phi.x).abs().max((setpoint[1] - phi.y).abs()));
        told = told.max(setpoint[0].abs()).max(setpoint[1].abs());
        named = named.max(phi.x.abs()).max(phi.y.abs());
    }
    (!off.is_empty() && median(off) > OFF_LOG).then_some((told, named))
}
