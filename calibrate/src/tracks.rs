//! Tracking files: which format is it, what does it hold, where is each point in each frame?
//!
//! Read: the wide Motive export (format 1.2 to 1.25) by the meaning of its headers, and a plain table with named columns.
//! Every other format that is recognised is named ([`TrackError::NotReadYet`]).
//!
//! What [`TrackFile::points`] lists: every group of columns that holds a position — measured markers, unlabeled ones,
//! rigid bodies and their solved markers —, in the order of the file, keyed by type, name and ID together, also when it is
//! blank in every frame. Quaternions and quality columns are no points. A gap is a run of consecutive rows in which the
//! point is missing; runs at the beginning and at the end count as well, a jump in the frame number does not (it is a
//! [`TrackWarning::FrameJumps`]).

mod detect;
mod error;
mod lines;
mod number;
mod table;
mod text;
mod wide;

use std::fmt;
use std::path::Path;

use nalgebra::Vector3;

pub use error::{Place, TrackError, TrackProblem, TrackWarning};
pub use table::TableOptions;

/// The format of a file that was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TrackFormat {
    /// Wide Motive export; the text is its `Format Version`.
    Motive(String),
    /// A table with named columns.
    Table,
}

impl fmt::Display for TrackFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Motive(version) => write!(f, "motive-{version}"),
            Self::Table => f.write_str("table"),
        }
    }
}

/// The unit of length in the file; positions in [`TrackPoint`] are metres whatever it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    /// Metres.
    Metre,
    /// Centimetres.
    Centimetre,
    /// Millimetres.
    Millimetre,
    /// Anything else (pixels), with the metres per unit that the user gave.
    Scaled(f64),
}

impl Unit {
    /// Metres per unit.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 0.01,
            Self::Millimetre => 0.001,
            Self::Scaled(metres) => metres,
        }
    }

    /// The unit of a name such as `Meters`, `mm` or `cm`.
    fn from_name(name: &str) -> Option<Self> {
        Some(match name.trim().to_ascii_lowercase().as_str() {
            "m" | "meter" | "meters" | "metre" | "metres" => Self::Metre,
            "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => Self::Centimetre,
            "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => Self::Millimetre,
            _ => return None,
        })
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Metre => f.write_str("m"),
            Self::Centimetre => f.write_str("cm"),
            Self::Millimetre => f.write_str("mm"),
            Self::Scaled(metres) => write!(f, "{metres} m"),
        }
    }
}

/// What a group of columns is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PointKind {
    /// A measured marker that the tracker has a name for.
    Marker,
    /// A measured marker without a name of its own.
    Unlabeled,
    /// The pivot of a rigid body: solved, not measured.
    RigidBody,
    /// A marker where the solved rigid body says it is: vanishes with the body, and not blank when the marker is hidden.
    RigidBodyMarker,
    /// Any other type, kept but never used for poses unless it is named.
    Other,
}

impl PointKind {
    /// Whether a camera saw this point itself.
    pub fn is_measured(self) -> bool {
        matches!(self, Self::Marker | Self::Unlabeled)
    }
}

impl fmt::Display for PointKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Marker => "marker",
            Self::Unlabeled => "unlabeled",
            Self::RigidBody => "rigid-body",
            Self::RigidBodyMarker => "rigid-body-marker",
            Self::Other => "other",
        })
    }
}

/// One point and where it was in every row.
#[derive(Debug, Clone)]
pub struct TrackPoint {
    /// Its name, as in the file (without quotes).
    pub name: String,
    /// What it is.
    pub kind: PointKind,
    /// Its ID in the file; empty where the file has none.
    pub id: String,
    /// The names of its columns in a plain table (x, y and perhaps z); empty otherwise.
    pub columns: Vec<String>,
    /// One entry a row \[m\]; NaN where it is missing.
    positions: Vec<[f64; 3]>,
}

impl TrackPoint {
    pub(crate) fn new(name: String, kind: PointKind, id: String, columns: Vec<String>) -> Self {
        Self {
            name,
            kind,
            id,
            columns,
            positions: Vec::new(),
        }
    }

    /// Where the point was in this row \[m\], in the file's own axes; `None` where it is missing.
    pub fn position(&self, row: usize) -> Option<Vector3<f64>> {
        let [x, y, z] = *self.positions.get(row)?;
        (!x.is_nan()).then(|| Vector3::new(x, y, z))
    }

    /// In how many rows it is there.
    pub fn present(&self) -> usize {
        self.positions.iter().filter(|p| !p[0].is_nan()).count()
    }

    /// How many runs of rows it is missing in.
    pub fn gaps(&self) -> usize {
        self.gap_lengths().0
    }

    /// The longest run of rows that it is missing in.
    pub fn longest_gap(&self) -> usize {
        self.gap_lengths().1
    }

    fn gap_lengths(&self) -> (usize, usize) {
        let (mut gaps, mut longest, mut run) = (0, 0, 0);
        for [x, ..] in &self.positions {
            if x.is_nan() {
                gaps += usize::from(run == 0);
                run += 1;
                longest = longest.max(run);
            } else {
                run = 0;
            }
        }
        (gaps, longest)
    }

    fn push(&mut self, position: Option<[f64; 3]>) {
        self.positions.push(position.unwrap_or([f64::NAN; 3]));
    }
}

/// What a tracking file holds.
#[derive(Debug, Clone)]
pub struct TrackFile {
    /// Its format.
    pub format: TrackFormat,
    /// Rows a second: the export rate of a Motive file, the median of the time steps of a table.
    pub rate_hz: f64,
    /// The unit of length in the file.
    pub unit: Unit,
    /// The frame number of each row (the row's own number in a table without a frame column).
    pub frame_numbers: Vec<u64>,
    /// The time of each row \[s\]: frame number over rate in a Motive file, the time column in a table.
    pub times: Vec<f64>,
    /// Every group of columns with positions, in the order of the file.
    pub points: Vec<TrackPoint>,
    /// What the reader noticed; none of it made a number wrong.
    pub warnings: Vec<TrackWarning>,
}

impl TrackFile {
    /// How many rows with data there are (what the header says is not asked: it may lie).
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

/// Reads a tracking file whose columns, if it is a table, explain themselves.
///
/// `file` is only for the messages.
///
/// # Errors
/// [`TrackError`]: a format that is recognised but not read yet, a file that is none, or a broken one with line and column.
pub fn read_tracks(bytes: &[u8], file: &Path) -> Result<TrackFile, TrackError> {
    read_tracks_with(bytes, file, &TableOptions::default())
}

/// The same, with what the user knows about the columns of a plain table.
///
/// # Errors
/// As [`read_tracks`].
pub fn read_tracks_with(
    bytes: &[u8],
    file: &Path,
    options: &TableOptions,
) -> Result<TrackFile, TrackError> {
    let text = text::decode(bytes).map_err(|format| TrackError::not_read(file, format))?;
    match detect::detect(&text, file)? {
        detect::Detected::Wide(delimiter) => wide::read(&text, file, delimiter),
        detect::Detected::Table(layout) => table::read(&text, file, &layout, options),
    }
}
