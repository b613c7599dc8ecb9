//! Kind of an output file by the ending of its name: a figure, pixels, an animation, a table.

use std::path::Path;

use swimmer_files::write_atomically;

use crate::failure::{Failure, Outcome};
use crate::raster::{pdf, png};

/// A kind of file that shows something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Svg,
    Png,
    Pdf,
    Gif,
    Csv,
}

impl Kind {
    /// The kind that a name stands for, one of those that a command can write.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if its ending is not one of theirs.
    pub(crate) fn of(path: &Path, kinds: &[Self]) -> Outcome<Self> {
        let ending = path.extension().and_then(|ending| ending.to_str());
        let ending = ending.unwrap_or_default().to_ascii_lowercase();
        let found = kinds.iter().find(|kind| kind.description().0 == ending);
        found.copied().ok_or_else(|| {
            let known: Vec<String> = kinds
                .iter()
                .map(|kind| format!(".{} for {}", kind.description().0, kind.description().1))
                .collect();
            Failure::BadInput(format!(
                "cannot tell from `{}` what to write: end the name in {}",
                path.display(),
                listed(&known)
            ))
        })
    }

    /// Ending of the name, and what the file shows.
    fn description(self) -> (&'static str, &'static str) {
        match self {
            Self::Svg => ("svg", "a figure"),
            Self::Png => ("png", "a figure in pixels"),
            Self::Pdf => ("pdf", "a figure for print"),
            Self::Gif => ("gif", "an animation"),
            Self::Csv => ("csv", "a table"),
        }
    }

    /// Writes a drawing (SVG), converted to its kind, or the text of a table.
    ///
    /// # Errors
    /// The drawing cannot be converted, or the file cannot be written.
    pub(crate) fn write(self, path: &Path, text: &str) -> Outcome {
        match self {
            Self::Png => write_atomically(path, &png(text)?)?,
            Self::Pdf => write_atomically(path, &pdf(text)?)?,
            Self::Svg | Self::Gif | Self::Csv => write_atomically(path, text.as_bytes())?,
        }
        Ok(())
    }
}

/// `a, b or c`.
fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}
