//! A plain table with named columns (`t,x1,y1,x2,y2`): comma, semicolon, tab or spaces between them.
//!
//! * Time: a column `t`, `time`, `time_s`, `seconds`, `Time (Seconds)`, …; else `frame` together with [`TrackOptions::rate_hz`].
//! * Points: columns whose names are the same but for one letter x, y or z at either end (`x1`/`y1` → `1`, `front_x`/`front_y`
//!   → `front`); a bare `x`/`y` is the point `x,y`. Other pairs are named by the caller ([`TrackOptions::pairs`]).
//! * Unit: metres, unless a column's name ends in a unit (`x1_mm`, `x1 [cm]`, `x1_px`) or the caller gives a scale. Whether
//!   the reflectors then have their distance is asked later, so that pixels never pass for metres.
//! * Blank or NaN is missing. Columns that belong to nothing are not read.

mod header;

use std::path::Path;

use super::detect::TableLayout;
use super::grid::{self, Grid};
use super::lines::Lines;
use super::{Draft, TrackError, TrackFormat, TrackOptions, Unit};
use header::Header;

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    file: &Path,
    layout: &TableLayout,
    options: &TrackOptions,
) -> Result<Draft, TrackError> {
    let at = layout.header_line;
    let Some(line) = lines.head().find(|line| line.number == at) else {
        return Err(TrackError::Empty {
            file: file.to_owned(),
        });
    };
    let header = Header::read(line, file, layout, options)?;
    let (unit, metres, overridden) = options.unit(header.unit.unwrap_or(Unit::Metre));
    let grid = Grid {
        clock: header.clock,
        metres,
        columns: header.columns,
        comments: true,
        ..Grid::under(at, layout.delimiter, header.width, header.points)
    };
    let body = grid::read(lines, file, grid)?;
    Ok(Draft {
        format: TrackFormat::Table,
        rate_hz: None,
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
