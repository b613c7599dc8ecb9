//! The playlist: which gaits to play, how often and how fast, with the gait files beside it.

use std::fmt::Write as _;
use std::path::Path;

use forecast::{Family, Plan};
use swimmer_files::{Bounds, GaitFile, SwimmerFile, SwimmerHash, write_atomically};
use swimmer_model::Gait as _;

use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;

/// The format version that is written.
const VERSION: u32 = 1;
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
    let mut text = format!(
        "# A playlist: gaits that start and end at one shape, to be played one after the other.\n\
         # Each step plays `cycles` cycles of `period_s` seconds of a gait file beside this one.\n\
         format = \"swimmer playlist\"\nversion = {VERSION}\nswimmer = {:?}\n",
        file.name
    );
    let mut names = Vec::with_capacity(plan.steps.len());
    for (number, step) in plan.steps.iter().enumerate() {
        let name = format!("{stem}-{}-{}.gait", number + 1, step.member.word());
        let beside = path.with_file_name(&name);
        may_be_written(&beside)?;
        sampled(file, family, step).save(&beside)?;
        let _ = write!(
            text,
            "\n[[step]]\ngait = {name:?}\ncycles = {}\nperiod_s = {:?}\n",
            step.cycles, step.period
        );
        names.push(name);
    }
    write_atomically(path, text.as_bytes())?;
    Ok(names)
}

/// A member's cycle, with its corners.
fn sampled(file: &SwimmerFile, family: &Family, step: &forecast::Step) -> GaitFile {
    let gait = step.member.of(family);
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
