//! A folder of results that appears whole or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use crate::failure::{Failure, Outcome};
use crate::interrupt::{listen, locked};

/// Every folder being filled: what Ctrl-C removes.
static DRAFTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Each draft of this run with the place that it stood for: whoever reads an error knows only the place.
static PLACES: Mutex<Vec<[String; 2]>> = Mutex::new(Vec::new());

/// The text, with the final paths instead of those of the drafts.
pub(crate) fn with_places(text: &str) -> String {
    let places = locked(&PLACES);
    places.iter().fold(text.to_owned(), |text, [draft, place]| {
        text.replace(draft.as_str(), place)
    })
}

/// A folder being filled next to its final place, or inside that place if an empty folder exists there already; dropped before
/// [`Self::publish`], or interrupted, it is removed.
#[derive(Debug)]
pub(crate) struct NewFolder {
    place: PathBuf,
    draft: PathBuf,
    /// The draft is inside the place, which stays: someone may be in it, a link may lead to it.
    inside: bool,
}

impl NewFolder {
    /// Starts a folder that will stand at `place`, which must be free or an empty folder.
    ///
    /// # Errors
    /// [`Failure::BadInput`] when the place is taken or cannot be written to.
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
        let inside = place.is_dir();
        if !inside && place.is_symlink() {
            return bad(format!(
                "{shown} is a symbolic link that leads nowhere; make the folder that it names, or name another one with -o"
            ));
        }
        let ending = format!(".{}.partial", std::process::id());
        let draft = if inside {
            place.join(format!(".swimmer{ending}"))
        } else {
            let Some(name) = place.file_name() else {
                return bad(format!(
                    "{shown} names no folder; give -o a path that ends in a name"
                ));
            };
            let mut draft_name = std::ffi::OsString::from(".");
            draft_name.push(name);
            draft_name.push(ending);
            place.with_file_name(draft_name)
        };
        listen().map_err(|error| {
            Failure::Tried(format!(
                "cannot listen for Ctrl-C ({error}), which would leave half of {shown} behind"
            ))
        })?;
        let mut drafts = locked(&DRAFTS);
        fs::create_dir_all(&draft).map_err(|error| {
            Failure::BadInput(format!("cannot make a folder for {shown}: {error}"))
        })?;
        drafts.push(draft.clone());
        locked(&PLACES).push([draft.display().to_string(), place.display().to_string()]);
        Ok(Self {
            place: place.to_owned(),
            draft,
            inside,
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

    /// Final path of the folder.
    pub(crate) fn place(&self) -> &Path {
        &self.place
    }

    /// Path at which files are written until the folder is complete.
    pub(crate) fn draft(&self) -> &Path {
        &self.draft
    }

    /// Moves the complete folder to its final place.
    ///
    /// # Errors
    /// [`Failure::Tried`] if it cannot be moved there; nothing is left behind then.
    pub(crate) fn publish(self) -> Outcome {
        // Held on the way: Ctrl-C comes before it or after it.
        let mut drafts = locked(&DRAFTS);
        let moved = if self.inside {
            fill(&self.place, &self.draft)
        } else {
            fs::rename(&self.draft, &self.place)
        };
        if moved.is_ok() {
            drafts.retain(|draft| *draft != self.draft);
        }
        drop(drafts);
        moved.map_err(|error| {
            Failure::Tried(format!(
                "the results are complete but cannot be moved to {}: {error}",
                self.place.display()
            ))
        })
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        let mut drafts = locked(&DRAFTS);
        if let Some(index) = drafts.iter().position(|draft| *draft == self.draft) {
            drafts.swap_remove(index);
            let _ = fs::remove_dir_all(&self.draft);
        }
    }
}

/// Every folder being filled; while this is held, none is started, published or dropped.
pub(crate) struct Drafts(MutexGuard<'static, Vec<PathBuf>>);

impl Drafts {
    /// Waits for the folder that is being published just now, if one is.
    pub(crate) fn held() -> Self {
        Self(locked(&DRAFTS))
    }

    /// `true` without a draft.
    pub(crate) fn none(&self) -> bool {
        self.0.is_empty()
    }

    /// Removes them from the disk.
    pub(crate) fn remove(&self) {
        for draft in self.0.iter() {
            let _ = fs::remove_dir_all(draft);
        }
    }
}

/// Moves all that is in `draft`, a folder in `place`, up into `place`; where that fails, everything is back in the draft.
fn fill(place: &Path, draft: &Path) -> io::Result<()> {
    let names = |folder: &Path| -> io::Result<Vec<std::ffi::OsString>> {
        fs::read_dir(folder)?
            .map(|entry| Ok(entry?.file_name()))
            .collect()
    };
    // Empty at the start; a folder that was filled since is left as it is.
    if names(place)?
        .iter()
        .any(|name| Some(name.as_os_str()) != draft.file_name())
    {
        return Err(io::Error::new(
            io::ErrorKind::DirectoryNotEmpty,
            "something was put there meanwhile",
        ));
    }
    let mut moved = Vec::new();
    let result = names(draft)?.into_iter().try_for_each(|name| {
        fs::rename(draft.join(&name), place.join(&name))?;
        moved.push(name);
        Ok(())
    });
    match result {
        Ok(()) => fs::remove_dir(draft),
        Err(error) => {
            for name in moved {
                let _ = fs::rename(place.join(&name), draft.join(&name));
            }
            Err(error)
        }
    }
}

/// `true` if a folder may be put here: the path does not exist, or is an empty folder.
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
    fn an_empty_folder_stays_the_same_folder() {
        let root = tempfile::tempdir().unwrap();
        let place = root.path().join("out");
        fs::create_dir(&place).unwrap();
        // As someone who stands in it says it.
        let here = place.join(".");
        let folder = NewFolder::start(&here).unwrap();
        fs::write(folder.draft().join("a"), "1").unwrap();
        drop(folder);
        assert_eq!(fs::read_dir(&place).unwrap().count(), 0);

        let opened = fs::File::open(&place).unwrap();
        let folder = NewFolder::start(&here).unwrap();
        fs::write(folder.draft().join("a"), "1").unwrap();
        fs::create_dir(folder.draft().join("figures")).unwrap();
        folder.publish().unwrap();
        assert_eq!(fs::read_to_string(place.join("a")).unwrap(), "1");
        assert_eq!(fs::read_dir(&place).unwrap().count(), 2);
        assert_eq!(
            opened.metadata().unwrap().modified().unwrap(),
            fs::metadata(&place).unwrap().modified().unwrap()
        );
    }

    #[test]
    fn a_place_that_was_filled_meanwhile_is_left_alone() {
        let root = tempfile::tempdir().unwrap();
        let folder = NewFolder::start(root.path()).unwrap();
        fs::write(folder.draft().join("a"), "1").unwrap();
        fs::write(root.path().join("thesis.tex"), "mine").unwrap();
        let refused = folder.publish().unwrap_err();
        assert!(matches!(refused, Failure::Tried(_)), "{refused}");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_an_empty_folder_stays() {
        let root = tempfile::tempdir().unwrap();
        let (place, link) = (root.path().join("disk"), root.path().join("out"));
        std::os::unix::fs::symlink("disk", &link).unwrap();
        let refused = NewFolder::start(&link).unwrap_err();
        assert!(matches!(refused, Failure::BadInput(_)), "{refused}");
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);

        fs::create_dir(&place).unwrap();
        let folder = NewFolder::start(&link).unwrap();
        fs::write(folder.draft().join("a"), "1").unwrap();
        folder.publish().unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(place.join("a")).unwrap(), "1");
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
