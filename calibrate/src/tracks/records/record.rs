//! One record line and its fields.

use std::path::Path;

use super::{MOST, Number};
use crate::tracks::cells::{Cell, Cells};
use crate::tracks::lines::{Delimiter, TextLine};
use crate::tracks::number::number;
use crate::tracks::rotation::Rotation;
use crate::tracks::{TrackError, TrackProblem};

/// Position by three coordinates.
pub(super) enum Coordinates {
    /// All three are there.
    Seen([f64; 3]),
    /// None is.
    Missing,
    /// One or two are.
    HalfBlank,
}

pub(super) struct Record<'r> {
    line: TextLine<'r>,
    cells: &'r Cells,
    file: &'r Path,
    comma: bool,
}

impl<'r> Record<'r> {
    pub(super) fn read(
        line: &TextLine<'r>,
        delimiter: Delimiter,
        file: &'r Path,
        cells: &'r mut Cells,
    ) -> Result<Self, TrackError> {
        // Comments may hold anything, quotes left open too.
        if line.text.trim_start().starts_with("comment") {
            cells.split(
                &TextLine {
                    text: "comment",
                    ..*line
                },
                delimiter,
                file,
            )?;
        } else {
            cells.split(line, delimiter, file)?;
        }
        Ok(Self {
            line: *line,
            cells,
            file,
            comma: delimiter.allows_decimal_comma(),
        })
    }

    pub(super) fn word(&self) -> &'r str {
        self.cell(0).raw
    }

    pub(super) fn cell(&self, field: usize) -> Cell<'r> {
        self.cells.at(&self.line, field)
    }

    pub(super) fn error(&self, field: usize, problem: TrackProblem) -> TrackError {
        self.line.error(self.file, self.cell(field).at, problem)
    }

    pub(super) fn unknown(&self) -> TrackError {
        let text = self.word().chars().take(40).collect();
        self.error(0, TrackProblem::UnknownRecord { text })
    }

    /// Checks that the record has exactly this number of fields.
    pub(super) fn expect(&self, expected: usize) -> Result<(), TrackError> {
        if self.cells.len() < expected || self.cells.any_from(&self.line, expected) {
            let problem = TrackProblem::FieldCount {
                word: self.word().to_owned(),
                fields: self.cells.len(),
                expected,
            };
            return Err(self.line.error(self.file, self.line.text.len(), problem));
        }
        Ok(())
    }

    /// Parses a count of markers, bodies or frames.
    pub(super) fn count(&self, at: usize, field: &'static str) -> Result<usize, TrackError> {
        let cell = self.cell(at);
        cell.raw
            .parse()
            .ok()
            .filter(|count| field.starts_with("frames") || *count <= MOST)
            .ok_or_else(|| {
                let text = cell.text().into_owned();
                self.error(at, TrackProblem::NotACount { text, field })
            })
    }

    pub(super) fn frame_number(&self, at: usize) -> Result<u64, TrackError> {
        let cell = self.cell(at);
        cell.raw.parse().map_err(|_| {
            let text = cell.text().into_owned();
            self.error(at, TrackProblem::NotAFrameNumber { text })
        })
    }

    pub(super) fn time(&self, at: usize) -> Result<f64, TrackError> {
        match number(self.cell(at).raw, self.comma) {
            Number::Finite(time) => Ok(time),
            _ => Err(self.not_a_number(at, "time")),
        }
    }

    /// Three coordinates; nothing where any of them is missing.
    pub(super) fn place(&self, at: usize) -> Result<Coordinates, TrackError> {
        let mut place = [0.0; 3];
        let mut missing = 0;
        for ((value, field), axis) in place.iter_mut().zip(at..).zip(["x", "y", "z"]) {
            let text = self.cells.text(&self.line, field).unwrap_or("");
            match number(text, self.comma) {
                Number::Finite(finite) => *value = finite,
                Number::Missing => missing += 1,
                Number::Wrong => return Err(self.not_a_number(field, axis)),
            }
        }
        Ok(match missing {
            0 => Coordinates::Seen(place),
            3 => Coordinates::Missing,
            _ => Coordinates::HalfBlank,
        })
    }

    /// A quaternion (x, y, z, w); `None` if it is missing or no rotation.
    pub(super) fn turn(&self, at: usize) -> Result<Option<[f64; 4]>, TrackError> {
        let columns = [at, at + 1, at + 2, at + 3];
        Rotation::Quaternion(columns).read(|field| {
            match number(self.cells.text(&self.line, field).unwrap_or(""), self.comma) {
                Number::Finite(value) => Ok(Some(value)),
                Number::Missing => Ok(None),
                Number::Wrong => Err(self.not_a_number(field, "rotation")),
            }
        })
    }

    pub(super) fn line(&self) -> usize {
        self.line.number
    }

    fn not_a_number(&self, at: usize, what: &str) -> TrackError {
        let problem = TrackProblem::NotANumber {
            text: self.cell(at).text().into_owned(),
            cell: what.to_owned(),
        };
        self.error(at, problem)
    }
}
