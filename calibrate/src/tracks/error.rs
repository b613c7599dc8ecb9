//! What can be wrong with a tracking file, and where.

use std::fmt;
use std::path::{Path, PathBuf};

/// A place in a file, 1-based; the column counts characters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// The line.
    pub line: usize,
    /// The column.
    pub column: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file.display(), self.line, self.column)
    }
}

/// Why a tracking file gave no tracks.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// A line does not say what it must.
    #[error("{place}: {problem}")]
    Broken {
        /// Where.
        place: Place,
        /// What is wrong.
        problem: TrackProblem,
    },
    /// A format that is recognised, but that no reader exists for yet.
    #[error(
        "{}: this is a `{format}` file, which is not read yet; export it as a Motive CSV (format 1.21 to 1.25) or as a table \
         with named columns such as t,x1,y1,x2,y2", file.display()
    )]
    NotReadYet {
        /// The file.
        file: PathBuf,
        /// The format's name.
        format: String,
    },
    /// Nothing that is known begins like this.
    #[error(
        "{}:1:1: no known tracking format begins with `{beginning}`; read are Motive CSV exports (format 1.21 to 1.25) and \
         tables with named columns such as t,x1,y1,x2,y2", file.display()
    )]
    Unrecognised {
        /// The file.
        file: PathBuf,
        /// How it begins.
        beginning: String,
    },
    /// There is nothing in it.
    #[error("{}:1:1: the file is empty", file.display())]
    Empty {
        /// The file.
        file: PathBuf,
    },
}

impl TrackError {
    pub(super) fn not_read(file: &Path, format: &str) -> Self {
        Self::NotReadYet {
            file: file.to_owned(),
            format: format.to_owned(),
        }
    }

    /// The place, where the error has one.
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::Broken { place, .. } => Some(place),
            _ => None,
        }
    }
}

/// What is wrong with a line.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrackProblem {
    /// A quote opens and never closes on its line.
    #[error("a quote opens here and is not closed on this line; close it or remove it")]
    UnclosedQuote,
    /// Something stands between a closing quote and the next delimiter.
    #[error("text follows a closing quote; put a delimiter between them")]
    AfterQuote,
    /// A cell that must hold a number holds something else.
    #[error("`{text}` is not a number, in the cell of {cell}; blank means missing")]
    NotANumber {
        /// The cell's text.
        text: String,
        /// What the cell is.
        cell: String,
    },
    /// A frame number is none.
    #[error("`{text}` is not a frame number")]
    NotAFrameNumber {
        /// The cell's text.
        text: String,
    },
    /// Frame numbers must grow.
    #[error("frame {frame} follows frame {previous}; frame numbers must grow")]
    FrameOrder {
        /// The frame before.
        previous: u64,
        /// This frame.
        frame: u64,
    },
    /// Times must grow.
    #[error("time {time} s follows {previous} s; times must grow")]
    TimeOrder {
        /// The time before \[s\].
        previous: f64,
        /// This time \[s\].
        time: f64,
    },
    /// A row has not as many cells as the header.
    #[error(
        "this row has {cells} cells where the header has {expected}; it was cut or two rows ran together"
    )]
    RowLength {
        /// Cells in the row.
        cells: usize,
        /// Cells in the header.
        expected: usize,
    },
    /// No row of a Motive file begins with `Frame`.
    #[error("no row below begins with `Frame`; export the file again with its header")]
    NoAxisRow,
    /// A row that the header must have is not there.
    #[error("the header has no {row} row; export the file again with its header")]
    NoHeaderRow {
        /// Which row.
        row: &'static str,
    },
    /// The second column is not the time.
    #[error("the column after `Frame` is `{text}`, not `Time`")]
    NoTimeColumn {
        /// What it is.
        text: String,
    },
    /// The first row lacks a key.
    #[error("the first row has no `{key}`; export the file again with its header")]
    NoKey {
        /// Which key.
        key: &'static str,
    },
    /// A unit of length that is not known; guessing one would make every length wrong.
    #[error("unknown unit of length `{text}`; known are Meters, Centimeters and Millimeters")]
    UnknownUnit {
        /// The unit's name.
        text: String,
    },
    /// A table's columns are in a unit whose length only the user knows.
    #[error("column `{column}` is in `{unit}`; give its length in metres (scale)")]
    ScaleNeeded {
        /// The column.
        column: String,
        /// Its unit.
        unit: String,
    },
    /// A frame rate is no positive number.
    #[error("`{text}` is not a frame rate in hertz")]
    Rate {
        /// What it says.
        text: String,
    },
    /// Positions relative to a body are of no use here.
    #[error("the coordinate space is `{text}`; export again with coordinate space Global")]
    CoordinateSpace {
        /// What it says.
        text: String,
    },
    /// A point lacks one of its axes.
    #[error("point `{point}` has no {axis} position column")]
    MissingAxis {
        /// The point.
        point: String,
        /// The axis letter.
        axis: char,
    },
    /// No columns with positions.
    #[error("no column here holds a position")]
    NoPoints,
    /// A table needs to know when.
    #[error("no column is called t, time or frame, so the rate is unknown; name one of them")]
    NoTime,
    /// A column that was asked for is not there.
    #[error("there is no column `{name}`; the columns are {columns}")]
    NoColumn {
        /// The name that was asked for.
        name: String,
        /// The columns that are there.
        columns: String,
    },
    /// Two columns have the same name.
    #[error("two columns are called `{name}`; give each its own name")]
    TwiceTheSameColumn {
        /// The name.
        name: String,
    },
    /// A header and nothing below it.
    #[error("no data follow this header")]
    NoData,
}

/// What a reader noticed without being stopped by it.
#[derive(Debug, Clone, PartialEq)]
pub enum TrackWarning {
    /// A format version that no sample was seen of.
    UnseenVersion(String),
    /// Frame numbers jump: how often, and how many frames are left out in all.
    FrameJumps {
        /// How many jumps.
        jumps: usize,
        /// Frames that are not in the file.
        frames: u64,
    },
    /// The header's count of frames is not the count of rows.
    FrameCount {
        /// What the header says.
        header: u64,
        /// Rows with data.
        rows: usize,
    },
    /// The time column runs at another rate than the header says; the header's rate was used.
    TimeColumn {
        /// The header's rate \[Hz\].
        header_hz: f64,
        /// The time column's rate \[Hz\].
        column_hz: f64,
    },
    /// Positions with one axis blank were taken as missing.
    HalfBlank {
        /// How many.
        count: usize,
        /// The first line with one.
        first_line: usize,
    },
    /// The last line was cut and left out.
    LastLineCut {
        /// Its number.
        line: usize,
    },
    /// The time steps of a table differ by more than a hundredth.
    UnevenTimes {
        /// The shortest \[s\].
        shortest: f64,
        /// The longest \[s\].
        longest: f64,
    },
}

impl fmt::Display for TrackWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnseenVersion(version) => {
                write!(
                    f,
                    "format version {version} was never seen; it was read by the meaning of its headers"
                )
            }
            Self::FrameJumps { jumps, frames } => {
                write!(
                    f,
                    "the frame number jumps {jumps} times, over {frames} frames that are not in the file"
                )
            }
            Self::FrameCount { header, rows } => {
                write!(f, "the header says {header} frames, the file has {rows}")
            }
            Self::TimeColumn {
                header_hz,
                column_hz,
            } => write!(
                f,
                "the header says {header_hz} frames a second, the time column {column_hz:.4}; the header's rate was used"
            ),
            Self::HalfBlank { count, first_line } => write!(
                f,
                "{count} positions with a blank axis were taken as missing, the first on line {first_line}"
            ),
            Self::LastLineCut { line } => write!(f, "line {line}, the last, was cut and left out"),
            Self::UnevenTimes { shortest, longest } => {
                write!(f, "time steps range from {shortest:.6} s to {longest:.6} s")
            }
        }
    }
}
