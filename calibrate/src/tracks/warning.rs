//! Warnings of the readers.

use std::fmt;

/// Irregularity that does not stop a reader.
#[derive(Debug, Clone, PartialEq)]
pub enum TrackWarning {
    /// A format version that no sample was seen of.
    UnseenVersion(String),
    /// Frame numbers jump: how often, and how many frames are left out in all.
    FrameJumps {
        /// Number of jumps.
        jumps: usize,
        /// Frames that are not in the file.
        frames: u64,
    },
    /// The header's count of frames is not the count of rows.
    FrameCount {
        /// Value of the header.
        header: u64,
        /// Rows with data.
        rows: usize,
    },
    /// The time column runs at another rate than the header says.
    TimeColumn {
        /// The header's rate \[Hz\].
        header_hz: f64,
        /// The time column's rate \[Hz\].
        column_hz: f64,
        /// `true` if the difference is so large that the time column was used.
        column_used: bool,
    },
    /// Positions with one axis blank were taken as missing.
    HalfBlank {
        /// Number.
        count: usize,
        /// The first line with one.
        first_line: usize,
    },
    /// The last line was cut and left out.
    LastLineCut {
        /// Its number.
        line: usize,
    },
    /// There was no header: columns were taken for x, y, z of one point after another.
    NoHeader,
    /// There was no header: columns were taken for a time and a pose.
    Poses,
    /// The system of the file is left-handed; Z was turned round.
    LeftHanded,
    /// A track has columns, but no x and y.
    NoPositions {
        /// The track.
        track: String,
        /// Its columns.
        columns: String,
    },
    /// Positions that were left out because their likelihood is low.
    Unlikely {
        /// Number.
        count: usize,
        /// The least likelihood that counts.
        threshold: f64,
    },
    /// Pixels whose y was taken to run down, as in images.
    PixelsDown,
    /// The user's scale was used instead of the file's own unit.
    UnitOverridden {
        /// The file's unit.
        unit: String,
    },
    /// The user's rate was used instead of the file's own.
    RateOverridden {
        /// The file's rate \[Hz\].
        file_hz: f64,
        /// The user's \[Hz\].
        used_hz: f64,
    },
    /// Times were rounded; the rows were counted over their span.
    RoundedTimes {
        /// The last digit's unit \[s\].
        unit_s: f64,
        /// The rate \[Hz\].
        rate_hz: f64,
    },
    /// Frame numbers that do not grow while times do: the times were used.
    Renumbered {
        /// Number.
        count: usize,
        /// The first line with one.
        first_line: usize,
    },
    /// Frames number rigid bodies otherwise than the bodies' own records; each pose went to the body whose markers it explains.
    BodyNumbers {
        /// Poses that went to a body of another number.
        renumbered: usize,
        /// Poses that no body's markers explain; they were left out.
        left_out: usize,
    },
    /// The time steps of a table differ by more than a hundredth.
    UnevenTimes {
        /// The shortest \[s\].
        shortest: f64,
        /// The longest \[s\].
        longest: f64,
    },
}

impl TrackWarning {
    /// Warning if the header's count differs from the number of rows.
    pub(super) fn frame_count(header: Option<u64>, rows: usize) -> Option<Self> {
        let header = header.filter(|header| *header != rows as u64)?;
        Some(Self::FrameCount { header, rows })
    }
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
                column_used,
            } => write!(
                f,
                "the header says {header_hz} frames a second, the time column {column_hz:.4}; the {} rate was used",
                if *column_used { "time column's" } else { "header's" }
            ),
            Self::HalfBlank { count, first_line } => write!(
                f,
                "{count} positions with a blank axis were taken as missing, the first on line {first_line}"
            ),
            Self::LastLineCut { line } => write!(f, "line {line}, the last, was cut and left out"),
            Self::NoHeader => f.write_str(
                "there is no header; the columns behind frame and time were taken for x, y, z of one point after another",
            ),
            Self::Poses => f.write_str(
                "there is no header; the columns were taken for the time, the position and the orientation of one body",
            ),
            Self::LeftHanded => {
                f.write_str("the file's axes are left-handed; Z was turned round to make them right-handed")
            }
            Self::NoPositions { track, columns } => write!(
                f,
                "`{track}` has the columns {columns} but no x and y, so it has no positions"
            ),
            Self::Unlikely { count, threshold } => write!(
                f,
                "{count} positions with a likelihood below {threshold} were taken as missing"
            ),
            Self::PixelsDown => f.write_str(
                "y was taken to run down, as in images; say axes = \"x,y\" if it runs up",
            ),
            Self::UnitOverridden { unit } => write!(
                f,
                "the file says its lengths are in {unit}; the scale that was given was used instead"
            ),
            Self::RateOverridden { file_hz, used_hz } => write!(
                f,
                "the file's own rate is {file_hz:.6} Hz; the {used_hz} Hz that were given were used instead"
            ),
            Self::RoundedTimes { unit_s, rate_hz } => write!(
                f,
                "times are rounded to {unit_s} s; counting rows over their span gives {rate_hz:.4} Hz, and rows are that far apart"
            ),
            Self::Renumbered { count, first_line } => write!(
                f,
                "{count} frame numbers do not grow, the first on line {first_line}, but the times do; the times were used"
            ),
            Self::BodyNumbers {
                renumbered,
                left_out,
            } => write!(
                f,
                "rigid bodies are numbered differently in frames and in their own records: {renumbered} poses went to the body whose \
                 markers they explain, {left_out} that explain none were left out"
            ),
            Self::UnevenTimes { shortest, longest } => {
                write!(f, "time steps range from {shortest:.6} s to {longest:.6} s")
            }
        }
    }
}
