//! What a tracking file holds, without its places.

use super::{PointKind, TrackFile, TrackFormat, TrackWarning, Unit};

/// What a tracking file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackSurvey {
    /// Its format.
    pub format: TrackFormat,
    /// Rows a second, as in [`TrackFile::rate_hz`].
    pub rate_hz: f64,
    /// The unit of length in the file.
    pub unit: Unit,
    /// Rows with data.
    pub frames: usize,
    /// Its points, in the order of the file.
    pub points: Vec<PointPresence>,
    /// What the reader noticed.
    pub warnings: Vec<TrackWarning>,
}

/// A point, and in which rows it is.
#[derive(Debug, Clone, PartialEq)]
pub struct PointPresence {
    /// Its name, as in the file.
    pub name: String,
    /// What it is.
    pub kind: PointKind,
    /// Its ID in the file; empty where the file has none.
    pub id: String,
    /// In how many rows it is there.
    pub present: usize,
    /// How many runs of rows it is missing in.
    pub gaps: usize,
    /// The longest of them.
    pub longest_gap: usize,
}

impl TrackSurvey {
    /// Of a file that was read, whether or not its places were kept.
    pub(super) fn of(file: TrackFile, frames: usize) -> Self {
        let points = file.points.into_iter().map(|point| PointPresence {
            present: point.present(),
            gaps: point.gaps(),
            longest_gap: point.longest_gap(),
            name: point.name,
            kind: point.kind,
            id: point.id,
        });
        Self {
            format: file.format,
            rate_hz: file.rate_hz,
            unit: file.unit,
            frames,
            points: points.collect(),
            warnings: file.warnings,
        }
    }
}
