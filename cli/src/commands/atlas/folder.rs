//! What an atlas leaves in its folder: its gaits and a picture of them.

use std::fs;
use std::path::PathBuf;

use gait_optimizer::OptimalGait;

use super::picture;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;

/// Where there is a folder: puts the gaits into it, each of whose keys then say where, and a picture of them with the value of each,
/// which the answer's lines name. Gives where the picture will lie.
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
