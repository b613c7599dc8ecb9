//! The wide Motive export (format 1.2 to 1.25), read by what its headers mean: versions put rows and columns at other
//! places, and so do people who save it again from a spreadsheet.

mod header;

use super::grid::{self, Clock, Grid};
use super::lines::{Delimiter, Lines};
use super::{Draft, Reading, TrackError, TrackFormat, TrackWarning};

/// Versions that a sample or a reader's source was seen of.
const SEEN: [&str; 6] = ["1.2", "1.21", "1.22", "1.23", "1.24", "1.25"];

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    delimiter: Delimiter,
) -> Result<Draft, TrackError> {
    let Reading { file, options, .. } = *reading;
    let header = header::read(&mut lines.head(), file, delimiter)?;
    let (unit, metres, overridden) = options.unit(header.unit);
    let (rate_hz, other_rate) = options.rate_over(header.rate_hz);
    let mut warnings: Vec<TrackWarning> = overridden.into_iter().chain(other_rate).collect();
    if !SEEN.contains(&header.version.as_str()) {
        warnings.push(TrackWarning::UnseenVersion(header.version.clone()));
    }
    let body = grid::read(
        lines,
        reading,
        Grid {
            clock: Clock::Numbered {
                frame: 0,
                first: 0,
                rate_hz,
                time: Some(1),
            },
            metres,
            columns: header.columns,
            ..Grid::under(header.axis_line, delimiter, header.width, header.points)
        },
    )?;
    warnings.extend(TrackWarning::frame_count(
        header.frames,
        body.timeline.len(),
    ));
    Ok(Draft {
        format: TrackFormat::Motive(header.version),
        rate_hz: Some(rate_hz),
        unit,
        image: false,
        body,
        warnings,
    })
}
