//! Folder of an atlas: its gaits and a picture of them.

use std::fs;
use std::path::PathBuf;

use gait_optimizer::OptimalGait;

use super::picture;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;

/// Writes the gaits and a picture of them into the folder, if there is one. Adds the path of each gait to its keys and that of
/// the picture to the text. Returns the path of the picture.
pub(super) fn fill<'a>(
    folder: Option<NewFolder>,
    (name, title): (&str, &str),
    gaits: impl Iterator<Item = (&'a OptimalGait, String)>,
    keys: &mut [Document],
    answer: &mut Document,
) -> Outcome<Option<PathBuf>> {
    let Some(folder) = folder else {
        return Ok(None);
    };
    let gaits: Vec<_> = gaits.collect();
    for (number, ((gait, _), keys)) in gaits.iter().zip(keys).enumerate() {
        let file = format!("{:02}.gait", number + 1);
        gait.gait_file(name).save(&folder.draft().join(&file))?;
        keys.key("gait", folder.place().join(&file));
    }
    let path = folder.draft().join("atlas.svg");
    fs::write(&path, picture::svg(title.to_owned(), &gaits)?)
        .map_err(|error| Failure::Tried(format!("cannot write {}: {error}", path.display())))?;
    let picture = folder.place().join("atlas.svg");
    folder.publish()?;
    answer.line(format!("  drawn in {}", picture.display()));
    Ok(Some(picture))
}
