//! File of the lab page.

use std::borrow::Cow;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};
use serde::Serialize;
use swimmer_files::SwimmerFile;

use crate::failure::{Failure, Outcome};
use crate::output::aside;

const NAME: &str = "swimmer-lab.html";
/// Page that a release holds in its program.
#[cfg(feature = "embedded-page")]
const EMBEDDED: Option<&[u8]> = Some(include_bytes!(env!("SWIMMER_LAB_PAGE")));
#[cfg(not(feature = "embedded-page"))]
const EMBEDDED: Option<&[u8]> = None;
/// Mark in the head of every lab page.
const MARK: &str = "<meta name=\"swimmer-lab\" content=\"";

/// The mark is within this many bytes.
const HEAD: usize = 4096;

/// Returns the page: the named one, or else the program's own.
///
/// # Errors
/// [`Failure::BadInput`] if there is no page, with the way to make one, or if the file is no lab page.
pub(super) fn load(named: Option<&Path>) -> Outcome<Cow<'static, [u8]>> {
    let Some(path) = named else {
        return own()?.ok_or_else(|| {
            Failure::BadInput(format!(
                "there is no lab page here: in a checkout make it with `cargo xtask lab` (it needs node), or name a release's with --page {NAME}"
            ))
        });
    };
    read(path).map(Cow::Owned)
}

/// Returns the page that is part of the program or, in a checkout, the one that `cargo xtask lab` made; `None` if it made none.
///
/// # Errors
/// As [`load`].
pub(crate) fn own() -> Outcome<Option<Cow<'static, [u8]>>> {
    if let Some(page) = EMBEDDED {
        return Ok(Some(Cow::Borrowed(page)));
    }
    find().map(|path| read(&path).map(Cow::Owned)).transpose()
}

fn read(path: &Path) -> Outcome<Vec<u8>> {
    let shown = path.display();
    let page = fs::read(path)
        .map_err(|error| Failure::BadInput(format!("cannot read the page {shown}: {error}")))?;
    // Its head is ASCII; behind it modules lie as bytes.
    let head = String::from_utf8_lossy(page.get(..HEAD).unwrap_or(&page));
    let Some((_, after)) = head.split_once(MARK) else {
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

/// State of the page's Explore tab in a link; other parts of the state keep their defaults.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct ShownDocument {
    gaits: [ShownGait; 1],
    /// Bound of the optimiser \[rad\].
    max_angle: f64,
    /// Period of a cycle \[s\].
    period: f64,
    /// Text of the swimmer file.
    swimmer: String,
}

/// Gait that the page searches.
#[derive(Serialize)]
struct ShownGait {
    kind: &'static str,
    what: &'static str,
}

/// A link from a page in the same folder to the lab page `name`, open at a swimmer and the farthest gait within a bound \[rad\]: the
/// page finds that gait itself.
pub(crate) fn beside(name: &str, swimmer: &SwimmerFile, max_angle: f64, period_s: f64) -> String {
    let shown = ShownDocument {
        gaits: [ShownGait {
            kind: "optimum",
            what: "displacement",
        }],
        max_angle,
        period: period_s,
        swimmer: swimmer.to_toml(),
    };
    let text = serde_json::to_string(&shown).unwrap_or_default();
    format!(
        "{name}#open={}",
        utf8_percent_encode(&text, NON_ALPHANUMERIC)
    )
}

/// Page of this checkout: target/lab/swimmer-lab.html for target/debug/swimmer.
fn find() -> Option<PathBuf> {
    let program = env::current_exe().ok()?;
    let page = program.parent()?.join("../lab").join(NAME);
    page.is_file().then_some(page)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_holds_the_swimmer_and_breaks_no_page() {
        let robot = SwimmerFile::preset("robot").unwrap();
        let link = beside("lab.html", &robot, 2.4, 20.0);
        let (name, shown) = link.split_once("#open=").unwrap();
        assert_eq!(name, "lab.html");
        assert!(
            shown
                .chars()
                .all(|letter| letter.is_ascii_alphanumeric() || letter == '%')
        );
        assert!(shown.contains("%22maxAngle%22%3A2%2E4"), "{shown}");
    }
}
