//! Folder of an atlas: its gaits and a picture of them.

use std::path::PathBuf;

use gait_optimizer::OptimalGait;

use super::picture;
use crate::failure::Outcome;
use crate::new_folder::NewFolder;
use crate::picture_file::{FigureWidth, Kind};

/// Gait of an atlas.
pub(super) struct Entry<'a> {
    pub(super) gait: &'a OptimalGait,
    /// Value in the legend.
    pub(super) value: String,
    /// Place for the path of its file.
    pub(super) path: &'a mut Option<PathBuf>,
}

/// Writes the gaits of a swimmer of this name and a picture of them into the folder. Returns the path of the picture.
pub(super) fn fill(
    folder: NewFolder,
    name: &str,
    title: String,
    entries: Vec<Entry<'_>>,
    width: FigureWidth,
) -> Outcome<PathBuf> {
    let mut gaits = Vec::with_capacity(entries.len());
    for (number, Entry { gait, value, path }) in entries.into_iter().enumerate() {
        let file = format!("{:02}.gait", number + 1);
        gait.gait_file(name).save(&folder.draft().join(&file))?;
        *path = Some(folder.place().join(&file));
        gaits.push((gait, value));
    }
    let path = folder.draft().join("atlas.svg");
    Kind::Svg.write(&path, &picture::svg(title, &gaits, width)?, width)?;
    let picture = folder.place().join("atlas.svg");
    folder.publish()?;
    Ok(picture)
}
