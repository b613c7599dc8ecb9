//! Kind of an output file by the ending of its name: a figure, pixels, an animation, a table.

use std::path::Path;

use swimmer_files::write_atomically;

use crate::failure::{Failure, Outcome};
use crate::raster::png;

/// A kind of file that shows something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Svg,
    Png,
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
        let found = kinds.iter().find(|kind| kind.ending_and_name().0 == ending);
        found.copied().ok_or_else(|| {
            let known: Vec<String> = kinds
                .iter()
                .map(|kind| {
                    format!(
                        ".{} for {}",
                        kind.ending_and_name().0,
                        kind.ending_and_name().1
                    )
                })
                .collect();
            Failure::BadInput(format!(
                "cannot tell from `{}` what to write: end the name in {}",
                path.display(),
                listed(&known)
            ))
        })
    }

    /// Its ending and what one gets.
    fn ending_and_name(self) -> (&'static str, &'static str) {
        match self {
            Self::Svg => ("svg", "a figure"),
            Self::Png => ("png", "a figure in pixels"),
            Self::Gif => ("gif", "an animation"),
            Self::Csv => ("csv", "a table"),
        }
    }

    /// Writes a drawing, as pixels where that is its kind, or the text of a table.
    ///
    /// # Errors
    /// Errors of the painting and of the writing.
    pub(crate) fn write(self, path: &Path, text: &str) -> Outcome {
        match self {
            Self::Png => write_atomically(path, &png(text)?)?,
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
