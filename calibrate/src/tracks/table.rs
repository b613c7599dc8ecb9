//! A plain table with named columns (`t,x1,y1,x2,y2`): comma, semicolon, tab or spaces between them.
//!
//! * Time: a column `t`, `time`, `time_s`, `seconds`, `Time (Seconds)`, …; else `frame` together with [`TrackOptions::rate_hz`].
//! * Points: columns whose names are the same but for one letter x, y or z at either end (`x1`/`y1` → `1`, `front_x`/`front_y`
//!   → `front`); a bare `x`/`y` is the point `x,y`. Other pairs are named by the caller ([`TrackOptions::pairs`]).
//! * Unit: metres, unless a column's name ends in a unit (`x1_mm`, `x1 [cm]`, `x1_px`) or the caller gives a scale. The distance
//!   of the reflectors is checked later, so that pixels are never taken for metres.
//! * Blank or NaN is missing. Columns that belong to nothing are not read.

mod header;
mod long;
mod rotations;

use super::detect::TableLayout;
use super::grid::{self, Clock, Grid};
use super::lines::Lines;
use super::{Draft, Reading, TrackError, TrackFormat, Unit};
use header::Header;

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    layout: &TableLayout,
) -> Result<Draft, TrackError> {
    let Reading { file, options, .. } = *reading;
    let at = layout.header_line;
    let Some(line) = lines.head().find(|line| line.number == at) else {
        return Err(TrackError::Empty {
            file: file.to_owned(),
        });
    };
    let first_row = lines
        .head()
        .filter(|line| !line.text.trim_start().starts_with(['#', '%']) && !line.is_blank())
        .find(|line| line.number > at);
    let header = Header::read(line, first_row, (file, layout), options)?;
    if let Some(id) = header.id {
        return long::read(lines, reading, layout, (header, id));
    }
    // Kinovea writes pixels, or what its user calibrated.
    let unsaid = if header.kinovea {
        Unit::Unknown
    } else {
        Unit::Metre
    };
    let (unit, metres, overridden) = options.unit(header.unit.unwrap_or(unsaid));
    let format = if header.kinovea {
        TrackFormat::Kinovea
    } else {
        TrackFormat::Table
    };
    // Numbered rows have the rate that the user gave.
    let rate_hz = match header.clock {
        Clock::Numbered { rate_hz, .. } => Some(rate_hz),
        _ => None,
    };
    let grid = Grid {
        clock: header.clock,
        metres,
        columns: header.columns,
        comments: true,
        short_angles: header.short_angles,
        ..Grid::under(at, layout.delimiter, header.width, header.points)
    };
    let body = grid::read(lines, reading, grid)?;
    Ok(Draft {
        format,
        rate_hz,
        unit,
        image: header.unit == Some(Unit::Pixel),
        body,
        // Metres by default are no claim of the file's.
        warnings: overridden
            .filter(|_| header.unit.is_some())
            .into_iter()
            .collect(),
    })
}
