//! Summary of a tracking file without its positions.

use std::fmt::Display;

use serde::{Serialize, Serializer};

use super::{PointKind, TrackFile, TrackFormat, TrackWarning, Unit};

/// Summary of a tracking file, under the keys of the JSON output.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "TracksOutput")
)]
pub struct TrackSurvey {
    /// Its format.
    #[serde(serialize_with = "in_words")]
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub format: TrackFormat,
    /// Rows a second, as in [`TrackFile::rate_hz`]; null in JSON if there is a single frame without a rate.
    #[serde(serialize_with = "where_known")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub rate_hz: f64,
    /// The unit of length in the file.
    #[serde(serialize_with = "in_words")]
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub unit: Unit,
    /// Rows with data.
    pub frames: usize,
    /// Its points, in the order of the file.
    pub points: Vec<PointPresence>,
    /// Irregularities that the reader noticed.
    #[serde(serialize_with = "each_in_words")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<String>"))]
    pub warnings: Vec<TrackWarning>,
}

/// A point, and in which rows it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PointPresence {
    /// Its name, as in the file.
    pub name: String,
    /// Type.
    #[serde(serialize_with = "in_words")]
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub kind: PointKind,
    /// Its ID in the file; empty where the file has none.
    pub id: String,
    /// In how many rows it is there.
    pub present: usize,
    /// Number of gaps.
    pub gaps: usize,
    /// The longest of them.
    pub longest_gap: usize,
    /// `true` if the file gives its orientation, so that it can be the `body` of a campaign.
    pub oriented: bool,
}

fn in_words<S: Serializer>(value: &impl Display, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

fn each_in_words<S: Serializer>(values: &[impl Display], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(values.iter().map(ToString::to_string))
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
fn where_known<S: Serializer>(rate_hz: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    Some(*rate_hz)
        .filter(|rate| *rate > 0.0)
        .serialize(serializer)
}

impl TrackSurvey {
    /// Of a file that was read, whether or not its places were kept.
    pub(super) fn of(file: TrackFile, frames: usize) -> Self {
        let points = file.points.into_iter().map(|point| PointPresence {
            present: point.present(),
            oriented: point.is_oriented(),
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
