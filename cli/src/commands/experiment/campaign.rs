//! Campaign of the finished trials, from which `swimmer calibrate` fits the drag model.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use experiment::unattended::{Entry, Journal};
use swimmer_files::write_atomically;

use super::folder::{CAMPAIGN, Folder, SWIMMER};
use crate::failure::Outcome;

/// Writes the campaign into the folder; returns `None` if no trial is finished. The reflectors have their usual names and places, at
/// the ends of the middle link.
///
/// # Errors
/// A disk that refuses.
pub(super) fn write(folder: &Folder, journal: &Journal) -> Outcome<Option<PathBuf>> {
    let tracks: BTreeMap<u32, &str> = journal
        .records
        .iter()
        .filter_map(|record| match &record.entry {
            Entry::Finished { trial, track, .. } => Some((*trial, track.as_str())),
            _ => None,
        })
        .collect();
    let mut text = String::new();
    let half = folder.swimmer.swimmer.links.middle / 2.0;
    let tank = folder.spec.tank;
    let _ = write!(
        text,
        "# Finished trials of an experiment, made by `swimmer experiment report`.\n\
         swimmer = \"{SWIMMER}\"\n\n\
         [reflectors]                # at the ends of the middle link\n\
         front = {{ point = \"Front\", at = [{half:?}, 0.0] }}\n\
         back = {{ point = \"Back\", at = [{:?}, 0.0] }}\n\n\
         # A real tank has walls; with these lines the fit accounts for them.\n\
         # [known]\n\
         # tank = {{ size = [{:?}, {:?}], centre = [0.0, 0.0] }}\n",
        -half, tank.length, tank.width
    );
    let mut runs = 0;
    for trial in &folder.plan.trials {
        let (Some(track), Some(gait)) = (tracks.get(&trial.number), folder.plan.gait(trial)) else {
            continue;
        };
        runs += 1;
        let _ = write!(
            text,
            "\n[[run]]                     # trial {}, {}\ntrack = \"{track}\"\ngait = \"{}\"\nperiod_s = {:?}\n",
            trial.number, trial.gait, gait.file, gait.period_s
        );
    }
    if runs == 0 {
        return Ok(None);
    }
    let path = folder.path.join(CAMPAIGN);
    write_atomically(&path, text.as_bytes())?;
    Ok(Some(path))
}
