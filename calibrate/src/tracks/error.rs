//! Errors of tracking files, with file, line and column.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// A place in a file, 1-based; the column counts characters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FilePosition {
    /// The file.
    pub file: PathBuf,
    /// The line.
    pub line: usize,
    /// The column.
    pub column: usize,
}

impl fmt::Display for FilePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file.display(), self.line, self.column)
    }
}

/// Error of reading a tracking file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// A line does not say what it must.
    #[error("{place}: {problem}")]
    Broken {
        /// Where.
        place: FilePosition,
        /// The problem.
        problem: TrackProblem,
    },
    /// A format that is recognised, but that there is no reader for.
    #[error(
        "{}: this is a `{format}` file, which is not read; export it as text: {}", file.display(), text_export(format)
    )]
    NotRead {
        /// The file.
        file: PathBuf,
        /// The format's name.
        format: String,
    },
    /// The file could not be read to its end.
    #[error("{}:{line}: {cause}", file.display())]
    Stream {
        /// The file.
        file: PathBuf,
        /// The line that was being read.
        line: usize,
        /// The system's reason.
        cause: String,
    },
    /// Nothing that is known begins like this.
    #[error(
        "{}:1:1: no known tracking format begins with `{beginning}`; read are exports of Motive, Tracking Tools, Tracker, DeepLabCut, \
         SLEAP, Kinovea, TrackMate, TRC, QTM and Vicon, and tables with named columns such as t,x1,y1,x2,y2", file.display()
    )]
    Unrecognised {
        /// The file.
        file: PathBuf,
        /// First characters of the file.
        beginning: String,
    },
    /// There is nothing in it.
    #[error("{}:1:1: the file is empty", file.display())]
    Empty {
        /// The file.
        file: PathBuf,
    },
}

/// Way to export text instead of a binary format.
fn text_export(format: &str) -> &'static str {
    match format {
        "hdf5" => {
            "DeepLabCut also writes CSV (deeplabcut.analyze_videos with save_as_csv=True, or \
             deeplabcut.analyze_videos_converth5_to_csv), SLEAP by sleap-convert --format analysis.csv"
        }
        "c3d" => {
            "CSV from Motive (File, Export Tracking Data), TSV from QTM, CSV from Nexus, or TRC, which OpenSim and Mokka make of it"
        }
        "xlsx" => "save the sheet as CSV",
        _ => "Motive CSV, TRC, QTM TSV, or a table with named columns such as t,x1,y1,x2,y2",
    }
}

impl TrackError {
    pub(super) fn not_read(file: &Path, format: &str) -> Self {
        Self::NotRead {
            file: file.to_owned(),
            format: format.to_owned(),
        }
    }

    pub(super) fn read(file: &Path, line: usize, cause: &io::Error) -> Self {
        Self::Stream {
            file: file.to_owned(),
            line,
            cause: cause.to_string(),
        }
    }

    /// The place of the error, if it has one.
    pub fn place(&self) -> Option<&FilePosition> {
        match self {
            Self::Broken { place, .. } => Some(place),
            _ => None,
        }
    }
}

/// Problem of a line.
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
        /// Expected content of the cell.
        cell: String,
    },
    /// A frame number is invalid.
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
        "this row has {cells} cells where the header and the other rows have {expected}; it was cut, two rows ran together, or a \
         cell was lost or put in"
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
        /// Kind of row.
        row: &'static str,
    },
    /// The second column is not the time.
    #[error("the column after `Frame` is `{text}`, not `Time`")]
    NoTimeColumn {
        /// The text.
        text: String,
    },
    /// The first row lacks a key.
    #[error("the first row has no `{key}`; export the file again with its header")]
    NoKey {
        /// Name of the key.
        key: &'static str,
    },
    /// A unit of length that is not known; guessing one would make every length wrong.
    #[error("unknown unit of length `{text}`; known are Meters, Centimeters and Millimeters")]
    UnknownUnit {
        /// The unit's name.
        text: String,
    },
    /// A frame rate is no positive number.
    #[error("`{text}` is not a frame rate in hertz")]
    Rate {
        /// The text.
        text: String,
    },
    /// Positions relative to a body are of no use here.
    #[error("the coordinate space is `{text}`; export again with coordinate space Global")]
    CoordinateSpace {
        /// The text.
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
    /// A requested column is missing.
    #[error("there is no column `{name}`; the columns are {columns}")]
    NoColumn {
        /// The requested name.
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
    /// Frame numbers alone do not say when.
    #[error(
        "the rows have frame numbers but no times; say how many frames a second there are (`rate_hz` under [tracks] in the \
         campaign, or --rate)"
    )]
    NoRate,
    /// The file ends in the middle of its only row, or seems to.
    #[error(
        "the file ends here without a line's end, so this row's last number may have lost digits; end the line if it is whole"
    )]
    MayBeCut,
    /// A line that no recording has.
    #[error("this line is longer than {megabytes} MiB; no tracking file has such lines")]
    LineTooLong {
        /// The limit \[MiB\].
        megabytes: usize,
    },
    /// The number of a record's fields contradicts its own counts.
    #[error(
        "this `{word}` record has {fields} fields where its own counts ask for {expected}; it was cut, or its counts are wrong"
    )]
    FieldCount {
        /// The record's first word.
        word: String,
        /// Fields that are there.
        fields: usize,
        /// Number of fields by its counts.
        expected: usize,
    },
    /// A line that begins with no record word.
    #[error(
        "`{text}` begins no record; the words are comment, righthanded, lefthanded, info, trackable, rigidbody and frame"
    )]
    UnknownRecord {
        /// First characters.
        text: String,
    },
    /// A field that counts or numbers something is no whole number.
    #[error("`{text}` is no whole number, in the field of the {field}")]
    NotACount {
        /// The field's text.
        text: String,
        /// The text.
        field: &'static str,
    },
    /// An unknown version of the record family.
    #[error("record lines of version {version} are not known; known are 1.0 and 1.1")]
    RecordVersion {
        /// The version.
        version: String,
    },
    /// An angle without a unit that cannot be meant in radians.
    #[error(
        "{text} is more than a whole turn if it is in radians; name the unit in the column's title: yaw_deg, or yaw_rad for an angle \
         that goes on counting"
    )]
    AngleUnit {
        /// The cell's text.
        text: String,
    },
    /// XML that no reader is for.
    #[error(
        "this is XML with the root `{root}`, which is not read; read are Kinovea's .kva, and TrackMate's files and exported tracks. Export \
         a table with named columns such as t,x1,y1,x2,y2{}",
        hint.map_or(String::new(), |hint| format!(" ({hint})"))
    )]
    UnknownXml {
        /// The root element's name.
        root: String,
        /// Menu path of the text export in its program.
        hint: Option<&'static str>,
    },
    /// XML that cannot be parsed.
    #[error("this XML cannot be read: {cause}")]
    BrokenXml {
        /// The parser's reason.
        cause: String,
    },
    /// An XML element without an attribute that it must have.
    #[error("`{element}` has no number in `{attribute}`")]
    NoAttribute {
        /// The element.
        element: String,
        /// The attribute.
        attribute: String,
    },
    /// Without a header, columns can only be taken three by three.
    #[error(
        "without a header the columns behind frame and time can only be positions, three each, but there are {columns}; export \
         the file again with its header"
    )]
    Triples {
        /// Columns behind frame and time.
        columns: usize,
    },
    /// Without a header, four columns are a quaternion in every row.
    #[error(
        "without a header nothing says what columns are, and these four look like a rotation, not like positions; export the file \
         again with its header"
    )]
    LooksLikeRotation,
    /// A header and nothing below it.
    #[error("no data follow this header")]
    NoData,
}
