//! Tracking files: format, points, and the position of each point in each frame.
//!
//! The first lines determine the format, never the file's name:
//!
//! | format | [`TrackFile::format`] | reader |
//! |---|---|---|
//! | Motive CSV 1.2 to 1.25, also saved again from a spreadsheet | `motive-1.23` | `wide` |
//! | Motive CSV without its header | `motive-without-header` | `headerless` |
//! | record lines of Tracking Tools 2.x and Motive 1.x | `trackingtools-1.0`, `motive-1.1` | `records` |
//! | Tracker (video), one track, several, side by side | `tracker` | `tracker` |
//! | DeepLabCut CSV, one animal or several | `deeplabcut` | `deeplabcut` |
//! | TRC | `trc` | `trc` |
//! | Qualisys TSV | `qtm` | `qtm` |
//! | Vicon CSV: trajectories, objects, segments | `vicon` | `vicon` |
//! | SLEAP analysis CSV | `sleap` | `sleap` |
//! | Kinovea, text of trajectories, CSV and KVA | `kinovea` | `kinovea`, `table`, `xml` |
//! | TrackMate, spots as CSV, tracks and whole files as XML | `trackmate` | `table/long`, `xml` |
//! | a table with named columns; poses without any header | `table` | `table`, `pose_table` |
//! | a table of one row for each point in each frame: ArUco, trackpy | `long-table` | `table/long` |
//!
//! Files go by line by line. [`read_tracks`] keeps the places of points, so memory grows with those alone; [`survey_tracks`] keeps
//! none and needs the same memory for any length of file (but for exports with a clock for each track: Tracker side by side
//! and Kinovea's text). A unit that the file does not say is never guessed: [`Unit::Pixel`] and [`Unit::Unknown`] need a scale before there can be poses.
//!
//! [`TrackFile::points`] lists every group of columns that holds a position — measured markers, unlabeled ones,
//! rigid bodies and their solved markers —, in the order of the file, keyed by type, name and ID together, also when it is
//! blank in every frame. Quaternions and quality columns are no points. A gap is a run of consecutive rows in which the
//! point is missing; runs at the beginning and at the end count as well, a jump in the frame number does not (it is a
//! [`TrackWarning::FrameJumps`]).

mod cells;
mod deeplabcut;
mod detect;
mod error;
mod grid;
mod headerless;
mod kinovea;
mod lines;
mod merged;
mod number;
mod options;
mod point;
mod pose_table;
mod qtm;
mod records;
mod rotation;
mod rows;
mod sleap;
mod source;
mod stamp;
mod survey;
mod table;
mod timeline;
mod tracker;
mod trc;
mod unit;
mod utf16;
mod vicon;
mod warning;
mod wide;
mod xml;

use std::fmt;
use std::io::Read;
use std::path::Path;

use swimmer_files::Axes;

pub use error::{FilePosition, TrackError, TrackProblem};
pub use options::{TrackOptions, UsedPoints};
pub use point::{PointKind, TrackPoint, is_called};
pub use survey::{PointPresence, TrackSurvey};
pub use unit::Unit;
pub use warning::TrackWarning;

use detect::Detected;
use grid::Body;
use lines::Lines;
use source::Source;

/// The format of a file that was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TrackFormat {
    /// Wide Motive export, or the record lines of Motive 1.x; the text is the version.
    Motive(String),
    /// Wide Motive export with its header switched off.
    MotiveWithoutHeader,
    /// Record lines of Tracking Tools.
    TrackingTools,
    /// Tracker, the video tool.
    Tracker,
    /// `DeepLabCut`.
    DeepLabCut,
    /// TRC.
    Trc,
    /// Qualisys Track Manager.
    Qtm,
    /// Vicon Nexus.
    Vicon,
    /// SLEAP.
    Sleap,
    /// Kinovea.
    Kinovea,
    /// TrackMate.
    TrackMate,
    /// A table of one row for each point in each frame.
    LongTable,
    /// A table with named columns.
    Table,
}

impl fmt::Display for TrackFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Motive(version) => return write!(f, "motive-{version}"),
            Self::MotiveWithoutHeader => "motive-without-header",
            Self::TrackingTools => "trackingtools-1.0",
            Self::Tracker => "tracker",
            Self::DeepLabCut => "deeplabcut",
            Self::Trc => "trc",
            Self::Qtm => "qtm",
            Self::Vicon => "vicon",
            Self::Sleap => "sleap",
            Self::Kinovea => "kinovea",
            Self::TrackMate => "trackmate",
            Self::LongTable => "long-table",
            Self::Table => "table",
        })
    }
}

/// Content of a tracking file.
#[derive(Debug, Clone)]
pub struct TrackFile {
    /// Its format.
    pub format: TrackFormat,
    /// Rows a second: as the user says, else the header, else rows over the time they span; 0 for a single row without any.
    pub rate_hz: f64,
    /// The unit of length in the file.
    pub unit: Unit,
    /// The frame number of each row (the row's own number in a table without a frame column).
    pub frame_numbers: Vec<u64>,
    /// The time of each row \[s\]: frame number over rate where the header gives one (time columns are rounded), else the
    /// file's own stamps.
    pub times: Vec<f64>,
    /// The file's axes that are the tank's x and y, if the user or the format defines them (in images y runs down).
    pub axes: Option<Axes>,
    /// Every group of columns with positions, in the order of the file.
    pub points: Vec<TrackPoint>,
    /// Irregularities that the reader noticed; all numbers are right.
    pub warnings: Vec<TrackWarning>,
}

impl TrackFile {
    /// Number of rows with data. The header's number is not used, as it may be wrong.
    pub fn frames(&self) -> usize {
        self.times.len()
    }

    /// Rows over the time they span; differs from 1 where frame numbers jump.
    pub fn duration_s(&self) -> f64 {
        match (self.times.first(), self.times.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }
}

/// Context of a reader: file, options, and whether positions are kept or only counted.
#[derive(Debug, Clone, Copy)]
struct Reading<'a> {
    file: &'a Path,
    options: &'a TrackOptions,
    keeps_places: bool,
}

/// Result of a format's reader.
struct Draft {
    format: TrackFormat,
    /// Rate of the header, if it has one.
    rate_hz: Option<f64>,
    unit: Unit,
    /// `true` for positions in an image, whose y runs down.
    image: bool,
    body: Body,
    /// From the header, and from holding it against the rows.
    warnings: Vec<TrackWarning>,
}

impl Draft {
    fn finish(mut self, reading: &Reading<'_>) -> Result<Finished, TrackError> {
        let options = reading.options;
        let mut warnings = std::mem::take(&mut self.body.warnings);
        let header_hz = self.body.rate_hz.or(self.rate_hz);
        warnings.extend(self.warnings);
        // Real stamps of numbered frames: their mean is surer than the median of what jitters.
        let numbered = matches!(
            self.format,
            TrackFormat::Motive(_) | TrackFormat::TrackingTools
        );
        let timing = self.body.timeline;
        let timing = timing
            .finish(header_hz, options.rate(), numbered)
            .map_err(|repeated| {
                let line = lines::TextLine {
                    number: repeated.line,
                    text: "",
                    ended: true,
                };
                let (previous, time) = (repeated.time, repeated.time);
                line.error(reading.file, 0, TrackProblem::TimeOrder { previous, time })
            })?;
        warnings.extend(timing.warnings);
        let down = self.image.then_some(Axes::IMAGE);
        if down.is_some() && options.axes.is_none() && self.format == TrackFormat::Table {
            warnings.push(TrackWarning::PixelsDown);
        }
        let file = TrackFile {
            format: self.format,
            rate_hz: timing.rate_hz,
            unit: self.unit,
            frame_numbers: timing.frames,
            times: timing.times,
            axes: options.axes.or(down),
            points: self.body.points,
            warnings,
        };
        Ok(Finished {
            file,
            rows: timing.rows,
        })
    }
}

/// A file that was read, and how many rows it has also where they were not kept.
struct Finished {
    file: TrackFile,
    rows: usize,
}

/// Reads a tracking file that explains itself.
///
/// `file` is only for the messages.
///
/// # Errors
/// [`TrackError`]: an unknown or broken file, with line and column.
///
/// ```
/// let text = "t,x1,y1,x2,y2\n0,1,2,3,4\n0.01,1.5,2.5,,\n0.02,2,3,4,5\n";
/// let file = calibrate::read_tracks(text.as_bytes(), "run.csv".as_ref()).unwrap();
/// assert_eq!((file.frames(), file.points.len()), (3, 2));
/// assert!((file.rate_hz - 100.0).abs() < 1e-9);
/// ```
pub fn read_tracks(bytes: &[u8], file: &Path) -> Result<TrackFile, TrackError> {
    read_tracks_with(bytes, file, &TrackOptions::default())
}

/// The same from any stream, with what the user knows and the file does not say.
///
/// # Errors
/// As [`read_tracks`], and what the stream answers.
///
/// ```
/// use calibrate::{TrackOptions, read_tracks_with};
///
/// let text = "t,x1,y1,x2,y2\n0,1,2,3,4\n0.01,2,3,4,5\n";
/// let options = TrackOptions { rate_hz: Some(50.0), ..TrackOptions::default() };
/// let file = read_tracks_with(text.as_bytes(), "run.csv".as_ref(), &options).unwrap();
/// assert_eq!(file.rate_hz, 50.0);
/// ```
pub fn read_tracks_with(
    bytes: impl Read,
    file: &Path,
    options: &TrackOptions,
) -> Result<TrackFile, TrackError> {
    let reading = Reading {
        file,
        options,
        keeps_places: true,
    };
    Ok(read(bytes, &reading)?.file)
}

/// Lists the content of a tracking file, in constant memory.
///
/// # Errors
/// As [`read_tracks_with`].
///
/// ```
/// use calibrate::{TrackOptions, survey_tracks};
///
/// let text = "t,x1,y1,x2,y2\n0,1,2,3,4\n0.01,1.5,2.5,,\n0.02,2,3,4,5\n";
/// let survey = survey_tracks(text.as_bytes(), "run.csv".as_ref(), &TrackOptions::default()).unwrap();
/// assert_eq!((survey.points[1].present, survey.points[1].gaps), (2, 1));
/// ```
pub fn survey_tracks(
    bytes: impl Read,
    file: &Path,
    options: &TrackOptions,
) -> Result<TrackSurvey, TrackError> {
    let reading = Reading {
        file,
        options,
        keeps_places: false,
    };
    let Finished { file, rows } = read(bytes, &reading)?;
    Ok(TrackSurvey::of(file, rows))
}

fn read(bytes: impl Read, reading: &Reading<'_>) -> Result<Finished, TrackError> {
    let file = reading.file;
    let text = match source::open(bytes).map_err(|cause| TrackError::read(file, 1, &cause))? {
        Source::Text(text) => text,
        Source::Binary(format) => return Err(TrackError::not_read(file, format)),
    };
    let mut lines = Lines::open(text, file)?;
    let draft = match detect::detect(&lines, file)? {
        Detected::Wide(delimiter) => wide::read(&mut lines, reading, delimiter),
        Detected::Headerless(delimiter) => headerless::read(&mut lines, reading, delimiter),
        Detected::Records(delimiter) => records::read(&mut lines, reading, delimiter),
        Detected::Tracker(delimiter) => tracker::read(&mut lines, reading, delimiter),
        Detected::DeepLabCut(delimiter) => deeplabcut::read(&mut lines, reading, delimiter),
        Detected::Trc => trc::read(&mut lines, reading),
        Detected::Qtm => qtm::read(&mut lines, reading),
        Detected::Vicon(delimiter) => vicon::read(&mut lines, reading, delimiter),
        Detected::Kinovea => kinovea::read(&mut lines, reading),
        Detected::Sleap(delimiter) => sleap::read(&mut lines, reading, delimiter),
        Detected::Poses(delimiter) => pose_table::read(&mut lines, reading, delimiter),
        Detected::Xml => xml::read(&mut lines, reading),
        Detected::Table(layout) => table::read(&mut lines, reading, &layout),
    }?;
    draft.finish(reading)
}
