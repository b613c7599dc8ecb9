//! The rule for every FILE that a command writes: what is there already is refused unless `--overwrite`, and so is a folder that is
//! missing, before anything is done. Whoever writes says where.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::{Failure, Outcome};

/// `true` if `--overwrite` was given: set once for all commands, as `--json` is.
static OVERWRITE: AtomicBool = AtomicBool::new(false);

/// From here on files that exist are replaced.
pub(crate) fn allow_overwriting() {
    OVERWRITE.store(true, Ordering::Relaxed);
}

/// Checks that a file may be written there, before the work begins. A device or a pipe is written through.
///
/// # Errors
/// [`Failure::BadInput`].
pub(crate) fn may_be_written(file: &Path) -> Outcome {
    checked(file, OVERWRITE.load(Ordering::Relaxed)).map_err(Failure::BadInput)
}

fn checked(file: &Path, overwrite: bool) -> Result<(), String> {
    let shown = file.display();
    if file.is_dir() {
        return Err(format!("{shown} is a folder; name a file in it"));
    }
    if file.is_file() && !overwrite {
        return Err(format!(
            "{shown} exists; name a new file, or replace it with --overwrite"
        ));
    }
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => Err(format!(
            "cannot write {shown}: there is no folder {}; make it, or name another",
            folder.display()
        )),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_there_stays_and_what_is_missing_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("best.gait");
        checked(&file, false).unwrap();
        std::fs::write(&file, "mine").unwrap();
        assert!(checked(&file, false).unwrap_err().contains("--overwrite"));
        checked(&file, true).unwrap();
        for overwrite in [false, true] {
            checked(folder.path(), overwrite).unwrap_err();
            let lost = checked(&folder.path().join("no/best.gait"), overwrite).unwrap_err();
            assert!(lost.contains("there is no folder"), "{lost}");
        }
        checked(Path::new("best.gait"), false).unwrap();
    }
}
