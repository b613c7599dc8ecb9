//! Kind of an output file by the ending of its name: a figure, pixels, an animation, a table.

use std::path::Path;

use swimmer_files::write_atomically;

use crate::failure::{Failure, Outcome};
use crate::raster::{pdf, png};

/// Width of a figure in print: both columns of a journal.
const WIDTH_MM: f64 = 170.0;

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

    /// Ending of the name.
    pub(crate) fn ending(self) -> &'static str {
        self.description().0
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
            Self::Png => write_atomically(path, &png(text, WIDTH_MM)?)?,
            Self::Pdf => write_atomically(path, &pdf(&for_print(text))?)?,
            Self::Svg => write_atomically(path, for_print(text).as_bytes())?,
            Self::Gif | Self::Csv => write_atomically(path, text.as_bytes())?,
        }
        Ok(())
    }
}

/// A drawing (SVG) of [`WIDTH_MM`] in place of its width on the page, unchanged in its proportions.
fn for_print(drawing: &str) -> String {
    let Some((head, rest)) = drawing.split_once('>') else {
        return drawing.to_owned();
    };
    let side = |name: &str| {
        let (_, value) = head.split_once(&format!(" {name}=\""))?;
        let (value, _) = value.split_once('"')?;
        Some((format!(" {name}=\"{value}\""), value.parse::<f64>().ok()?))
    };
    let (Some((width, across)), Some((height, down))) = (side("width"), side("height")) else {
        return drawing.to_owned();
    };
    // Thousandths of a millimetre.
    let tall = (WIDTH_MM * 1e3 * down / across).round() / 1e3;
    let head = head
        .replacen(&width, &format!(" width=\"{WIDTH_MM}mm\""), 1)
        .replacen(&height, &format!(" height=\"{tall}mm\""), 1);
    format!("{head}>{rest}")
}

/// `a, b or c`.
fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_as_wide_as_two_columns() {
        let drawing = "<svg width=\"720\" height=\"540\" viewBox=\"0 0 5760 4320\" xmlns=\"http://www.w3.org/2000/svg\">\n<rect width=\"9\" height=\"9\"/></svg>\n";
        assert_eq!(
            for_print(drawing),
            "<svg width=\"170mm\" height=\"127.5mm\" viewBox=\"0 0 5760 4320\" xmlns=\"http://www.w3.org/2000/svg\">\n<rect width=\"9\" height=\"9\"/></svg>\n"
        );
        for other in ["", "<svg viewBox=\"0 0 1 1\"></svg>"] {
            assert_eq!(for_print(other), other);
        }
        // 170 mm in points.
        let pdf = pdf(&for_print(drawing)).unwrap();
        let text = String::from_utf8_lossy(&pdf);
        assert!(text.contains("/MediaBox[0 0 481.8"), "{text}");
    }
}
