//! What an atlas leaves in its folder.

use std::fs;
use std::path::PathBuf;

use gait_optimizer::OptimalGait;

use super::picture;
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;

/// Writes the gait with this number into the folder; where it will lie.
pub(super) fn saved(
    folder: &NewFolder,
    number: usize,
    gait: &OptimalGait,
    name: &str,
) -> Outcome<PathBuf> {
    let file = format!("{:02}.gait", number + 1);
    gait.gait_file(name).save(&folder.draft().join(&file))?;
    Ok(folder.place().join(&file))
}

/// Draws the gaits, each with its value, into the folder; where the picture will lie.
pub(super) fn drawn_in(
    folder: &NewFolder,
    title: String,
    gaits: &[(&OptimalGait, String)],
) -> Outcome<PathBuf> {
    let path = folder.draft().join("atlas.svg");
    fs::write(&path, picture::svg(title, gaits)?)
        .map_err(|error| Failure::Tried(format!("cannot write {}: {error}", path.display())))?;
    Ok(folder.place().join("atlas.svg"))
}
