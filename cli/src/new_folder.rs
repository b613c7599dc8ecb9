//! A folder of results that appears whole or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::failure::{Failure, Outcome};

/// A folder being filled beside the place where it will stand; dropped before [`Self::publish`], it vanishes.
#[derive(Debug)]
pub(crate) struct NewFolder {
    place: PathBuf,
    draft: PathBuf,
}

impl NewFolder {
    /// Starts a folder that will stand at `place`, which must be free or an empty folder.
    ///
    /// # Errors
    /// [`Failure::BadInput`] when the place is taken or cannot be written beside.
    pub(crate) fn start(place: &Path) -> Outcome<Self> {
        let bad = |what: String| Err(Failure::BadInput(what));
        let shown = place.display();
        match is_free(place) {
            Ok(true) => {}
            Ok(false) => {
                return bad(format!(
                    "the folder {shown} is not empty; name another one with -o, or empty it"
                ));
            }
            Err(error) => return bad(format!("cannot put results into {shown}: {error}")),
        }
        let Some(name) = place.file_name() else {
            return bad(format!(
                "{shown} names no folder; give -o a path that ends in a name"
            ));
        };
        let mut draft_name = std::ffi::OsString::from(".");
        draft_name.push(name);
        draft_name.push(format!(".{}.partial", std::process::id()));
        let draft = place.with_file_name(draft_name);
        fs::create_dir_all(&draft).map_err(|error| {
            Failure::BadInput(format!("cannot make a folder for {shown}: {error}"))
        })?;
        Ok(Self {
            place: place.to_owned(),
            draft,
        })
    }

    /// Starts a folder called `name`, or the first free one of `name-2`, `name-3`, … when that is taken.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub(crate) fn start_free(name: &str) -> Outcome<Self> {
        let numbered = (2..1000).map(|number| PathBuf::from(format!("{name}-{number}")));
        let free = std::iter::once(PathBuf::from(name))
            .chain(numbered)
            .find(|place| !matches!(is_free(place), Ok(false)));
        Self::start(&free.unwrap_or_else(|| PathBuf::from(name)))
    }

    /// Where the folder will stand.
    pub(crate) fn place(&self) -> &Path {
        &self.place
    }

    /// Where files are written until the folder is whole.
    pub(crate) fn draft(&self) -> &Path {
        &self.draft
    }

    /// Puts the whole folder in its place.
    ///
    /// # Errors
    /// [`Failure::Tried`] when it cannot be moved there; nothing is left beside it then.
    pub(crate) fn publish(mut self) -> Outcome {
        let fail = |error: io::Error| {
            Failure::Tried(format!(
                "the results are complete but cannot be moved to {}: {error}",
                self.place.display()
            ))
        };
        if self.place.exists() {
            // Empty a moment ago; a folder that was filled since is refused here.
            fs::remove_dir(&self.place).map_err(fail)?;
        }
        fs::rename(&self.draft, &self.place).map_err(fail)?;
        self.draft = PathBuf::new();
        Ok(())
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        if !self.draft.as_os_str().is_empty() {
            let _ = fs::remove_dir_all(&self.draft);
        }
    }
}

/// Whether a folder may be put here: nothing is there, or an empty folder.
fn is_free(place: &Path) -> io::Result<bool> {
    match fs::read_dir(place) {
        Ok(mut entries) => Ok(entries.next().is_none()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(true),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_or_nothing() {
        let root = tempfile::tempdir().unwrap();
        let place = root.path().join("out");
        let folder = NewFolder::start(&place).unwrap();
        fs::write(folder.draft().join("a"), "1").unwrap();
        drop(folder);
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);

        fs::create_dir(&place).unwrap();
        let folder = NewFolder::start(&place).unwrap();
        fs::write(folder.draft().join("a"), "1").unwrap();
        folder.publish().unwrap();
        assert_eq!(fs::read_to_string(place.join("a")).unwrap(), "1");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_taken_place_is_refused() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("thesis.tex"), "mine").unwrap();
        let refused = NewFolder::start(root.path()).unwrap_err();
        assert!(matches!(refused, Failure::BadInput(_)), "{refused}");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
    }

    #[test]
    fn the_next_free_name_is_taken() {
        let root = tempfile::tempdir().unwrap();
        let name = root.path().join("demo-out");
        let name = name.to_str().unwrap();
        for expected in ["demo-out", "demo-out-2", "demo-out-3"] {
            let folder = NewFolder::start_free(name).unwrap();
            assert_eq!(folder.place(), root.path().join(expected));
            fs::write(folder.draft().join("report.html"), "x").unwrap();
            folder.publish().unwrap();
        }
    }
}
