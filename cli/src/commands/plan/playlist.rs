//! The playlist of a plan: gaits with their cycles and periods, and the gait files in the same folder.

use std::path::Path;

use forecast::{Family, Plan, Scaled};
use swimmer_files::{
    AnyGait, Bounds, GaitFile, GaitSpec, Playlist, PlaylistStep, SwimmerFile, SwimmerHash,
};
use swimmer_model::Gait as _;

use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;

/// Samples of a gait between two corners.
const BETWEEN: usize = 48;

/// Writes the playlist and its gaits; the names of the gait files, one a step.
pub(super) fn write_playlist(
    path: &Path,
    file: &SwimmerFile,
    family: &Family,
    plan: &Plan,
) -> Outcome<Vec<String>> {
    let stem = path
        .file_stem()
        .and_then(|stem| stem.to_str())
        .ok_or_else(|| {
            Failure::BadInput(format!("{} names no file; give -o a name", path.display()))
        })?;
    let mut names = Vec::with_capacity(plan.steps.len());
    let mut steps = Vec::with_capacity(plan.steps.len());
    for (number, (step, cycle)) in plan.steps.iter().zip(plan.gaits(family)).enumerate() {
        let name = format!("{stem}-{}-{}.gait", number + 1, plan.word(step));
        let beside = path.with_file_name(&name);
        may_be_written(&beside)?;
        let gait = sampled(file, &cycle);
        gait.save(&beside)?;
        steps.push(PlaylistStep {
            gait: GaitSpec::File {
                path: name.clone().into(),
                reversed: false,
            },
            curve: AnyGait::from_file(&gait).map_err(|error| Failure::Tried(error.to_string()))?,
            made_for: None,
            cycles: step.cycles,
            period: step.period,
        });
        names.push(name);
    }
    let playlist = Playlist {
        swimmer: Some(file.name.clone()),
        steps,
    };
    playlist.save(path)?;
    Ok(names)
}

/// A member's cycle, with its corners.
fn sampled(file: &SwimmerFile, gait: &Scaled) -> GaitFile {
    let mut ends: Vec<f64> = (0..gait.pieces())
        .filter(|&piece| gait.corner_at_end(piece))
        .map(|piece| gait.piece_end(piece))
        .filter(|end| *end < 1.0 - 1e-12)
        .collect();
    ends.insert(0, 0.0);
    let corners = ends.clone();
    ends.push(1.0);
    let (mut u, mut phi) = (Vec::new(), Vec::new());
    for pair in ends.windows(2) {
        for k in 0..BETWEEN {
            let at = pair[0] + (pair[1] - pair[0]) * k as f64 / BETWEEN as f64;
            u.push(at);
            phi.push(gait.at(at).phi);
        }
    }
    u.push(1.0);
    phi.extend(phi.first().copied());
    GaitFile {
        swimmer_name: Some(file.name.clone()),
        swimmer_hash: Some(SwimmerHash::of(&file.swimmer)),
        bounds: Bounds::default(),
        corners,
        u,
        phi,
        ..GaitFile::default()
    }
}
