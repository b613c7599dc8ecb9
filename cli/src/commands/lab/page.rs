//! Where the page lies.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use crate::failure::{Failure, Outcome};
use crate::output::aside;

const NAME: &str = "swimmer-lab.html";
/// What every lab page says of itself in its head.
const MARK: &str = "<meta name=\"swimmer-lab\" content=\"";

/// Reads the page: the one that was named, the one beside this program (a release's), or the one that this checkout's
/// `cargo xtask lab` made.
///
/// # Errors
/// [`Failure::BadInput`] where there is none, with how to make one.
pub(super) fn load(named: Option<&Path>) -> Outcome<String> {
    let path = named.map(Path::to_path_buf).or_else(find).ok_or_else(|| {
        Failure::BadInput(format!(
            "there is no lab page here: in a checkout make it with `cargo xtask lab` (it needs node), or name a release's with --page {NAME}"
        ))
    })?;
    let shown = path.display();
    let page = fs::read_to_string(&path)
        .map_err(|error| Failure::BadInput(format!("cannot read the page {shown}: {error}")))?;
    let Some((_, after)) = page.split_once(MARK) else {
        return Err(Failure::BadInput(format!(
            "{shown} is no lab page; name the {NAME} of `cargo xtask lab` or of a release"
        )));
    };
    let version = after.split([' ', '"']).next().unwrap_or_default();
    if version != env!("CARGO_PKG_VERSION") {
        aside(&format!(
            "note: the page {shown} is of version {version}, this program of {}: they may speak past each other",
            env!("CARGO_PKG_VERSION")
        ));
    }
    Ok(page)
}

/// The page of this checkout or this release, where there is one.
fn find() -> Option<PathBuf> {
    let program = env::current_exe().ok()?;
    let folder = program.parent()?;
    // target/debug/swimmer and target/lab/swimmer-lab.html
    [folder.join(NAME), folder.join("../lab").join(NAME)]
        .into_iter()
        .find(|path| path.is_file())
}
