//! Kind of an output file by the ending of its name: a figure, pixels, an animation, a table.

use std::path::Path;

use clap::ValueEnum;
use swimmer_files::write_atomically;

use crate::failure::{Failure, Outcome};
use crate::raster::{pdf, png};

/// Width of a figure in print.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
#[expect(
    missing_docs,
    reason = "clap would print them, and spread each option of the command over several lines"
)]
pub enum FigureWidth {
    // One column of a journal.
    #[value(name = "85")]
    Column,
    // Both columns.
    #[default]
    #[value(name = "170")]
    Page,
}

/// Width of a narrow figure in pixels of the page. Its letters of 15 pixels are 7.2 points high in print.
pub(crate) const COLUMN: i32 = 500;

impl FigureWidth {
    /// Width in millimetres.
    fn mm(self) -> f64 {
        match self {
            Self::Column => 85.0,
            Self::Page => 170.0,
        }
    }
}

/// Options of a command that writes figures.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct FigureOptions {
    /// Width of a figure in print, mm: one column of a journal or both; 170 if left out
    #[arg(long, value_name = "MM", value_enum)]
    pub(crate) width: Option<FigureWidth>,
}

impl FigureOptions {
    /// Width of figures of some kinds; without one, `None` stands for no file.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if a width was given for a file without one.
    pub(crate) fn width(self, kind: Option<Kind>) -> Outcome<FigureWidth> {
        match (self.width, kind) {
            (Some(_), None) => Err(Failure::BadInput(
                "--width is the width of a figure, and none is written: name its file".to_owned(),
            )),
            (Some(_), Some(kind @ (Kind::Gif | Kind::Csv))) => Err(Failure::BadInput(format!(
                "--width is for figures (.svg, .png, .pdf); {} has none",
                kind.description().1
            ))),
            (width, _) => Ok(width.unwrap_or_default()),
        }
    }
}

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
    pub(crate) fn write(self, path: &Path, text: &str, width: FigureWidth) -> Outcome {
        match self {
            Self::Png => write_atomically(path, &png(text, width.mm())?)?,
            Self::Pdf => write_atomically(path, &pdf(&for_print(text, width))?)?,
            Self::Svg => write_atomically(path, for_print(text, width).as_bytes())?,
            Self::Gif | Self::Csv => write_atomically(path, text.as_bytes())?,
        }
        Ok(())
    }
}

/// A drawing (SVG) of a width in print in place of its width on the page, unchanged in its proportions.
fn for_print(drawing: &str, width: FigureWidth) -> String {
    let wide = width.mm();
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
    let tall = (wide * 1e3 * down / across).round() / 1e3;
    let head = head
        .replacen(&width, &format!(" width=\"{wide}mm\""), 1)
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

    /// Letters of 15 pixels, the smallest of charts and pictures in a column.
    #[test]
    fn letters_of_a_column_are_at_least_seven_points_high() {
        let points_per_mm = 72.0 / 25.4;
        let page = 15.0 * FigureWidth::Column.mm() / f64::from(COLUMN) * points_per_mm;
        assert!(page >= 7.0, "{page}");
    }

    #[test]
    fn only_figures_have_a_width() {
        let given = FigureOptions {
            width: Some(FigureWidth::Column),
        };
        for kind in [Kind::Svg, Kind::Png, Kind::Pdf] {
            assert_eq!(given.width(Some(kind)).unwrap(), FigureWidth::Column);
        }
        for kind in [None, Some(Kind::Gif), Some(Kind::Csv)] {
            assert!(matches!(given.width(kind), Err(Failure::BadInput(_))));
            let left_out = FigureOptions { width: None };
            assert_eq!(left_out.width(kind).unwrap(), FigureWidth::Page);
        }
    }

    #[test]
    fn a_figure_is_as_wide_as_two_columns() {
        let drawing = "<svg width=\"720\" height=\"540\" viewBox=\"0 0 5760 4320\" xmlns=\"http://www.w3.org/2000/svg\">\n<rect width=\"9\" height=\"9\"/></svg>\n";
        assert_eq!(
            for_print(drawing, FigureWidth::Page),
            "<svg width=\"170mm\" height=\"127.5mm\" viewBox=\"0 0 5760 4320\" xmlns=\"http://www.w3.org/2000/svg\">\n<rect width=\"9\" height=\"9\"/></svg>\n"
        );
        let narrow = for_print(drawing, FigureWidth::Column);
        assert!(
            narrow.starts_with("<svg width=\"85mm\" height=\"63.75mm\""),
            "{narrow}"
        );
        for other in ["", "<svg viewBox=\"0 0 1 1\"></svg>"] {
            assert_eq!(for_print(other, FigureWidth::Page), other);
        }
        // 170 mm in points.
        let pdf = pdf(&for_print(drawing, FigureWidth::Page)).unwrap();
        let text = String::from_utf8_lossy(&pdf);
        assert!(text.contains("/MediaBox[0 0 481.8"), "{text}");
    }
}
