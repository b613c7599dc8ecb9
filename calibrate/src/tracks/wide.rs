//! The wide Motive export (format 1.2 to 1.25), read by what its headers mean: versions put rows and columns at other
//! places, and so do people who save it again from a spreadsheet.

mod header;
mod rows;

use std::path::Path;

use super::lines::{Delimiter, lines};
use super::{TrackError, TrackFile, TrackFormat, TrackWarning};

/// Versions that a sample or a reader's source was seen of.
const SEEN: [&str; 6] = ["1.2", "1.21", "1.22", "1.23", "1.24", "1.25"];

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(text: &str, file: &Path, delimiter: Delimiter) -> Result<TrackFile, TrackError> {
    let mut lines = lines(text);
    let header = header::read(&mut lines, file, delimiter)?;
    let mut warnings = Vec::new();
    if !SEEN.contains(&header.version.as_str()) {
        warnings.push(TrackWarning::UnseenVersion(header.version.clone()));
    }
    let rows = rows::read(lines, file, delimiter, &header, &mut warnings)?;
    if let Some(total) = header
        .frames
        .filter(|total| *total != rows.frame_numbers.len() as u64)
    {
        warnings.push(TrackWarning::FrameCount {
            header: total,
            rows: rows.frame_numbers.len(),
        });
    }
    Ok(TrackFile {
        format: TrackFormat::Motive(header.version),
        rate_hz: header.rate_hz,
        unit: header.unit,
        times: rows
            .frame_numbers
            .iter()
            .map(|frame| *frame as f64 / header.rate_hz)
            .collect(),
        frame_numbers: rows.frame_numbers,
        points: rows.points,
        warnings,
    })
}
