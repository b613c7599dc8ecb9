//! TRC: three lines of keys, a line of names, a line of axes, tabs.

use std::path::Path;

use super::cells::{Cell, cell_at, split};
use super::grid::{self, Clock, Columns, Grid};
use super::lines::{Delimiter, Lines};
use super::number;
use super::{
    Draft, PointKind, TrackError, TrackFormat, TrackOptions, TrackPoint, TrackProblem,
    TrackWarning, Unit,
};

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    file: &Path,
    options: &TrackOptions,
) -> Result<Draft, TrackError> {
    let rows: Vec<_> = lines
        .head()
        .filter(|line| !line.is_blank())
        .take(5)
        .collect();
    let [first, keys, values, names, axes] = rows.as_slice() else {
        return Err(TrackError::Broken {
            place: super::Place {
                file: file.to_owned(),
                line: rows.len() + 1,
                column: 1,
            },
            problem: TrackProblem::NoHeaderRow {
                row: "axes (X1, Y1, Z1)",
            },
        });
    };
    let delimiter = Delimiter::of(first.text);
    let key_cells = split(keys, delimiter, file)?;
    let value_cells = split(values, delimiter, file)?;
    let find = |key: &'static str| {
        let column = key_cells.iter().position(|cell| cell.is(key));
        column
            .map(|column| cell_at(&value_cells, column))
            .ok_or_else(|| keys.error(file, 0, TrackProblem::NoKey { key }))
    };
    let rate = find("DataRate")?;
    let rate_hz = number::rate(&rate, values, file, delimiter.allows_decimal_comma())?;
    let cell = find("Units")?;
    let own = Unit::from_name(cell.raw).ok_or_else(|| {
        let text = cell.text().into_owned();
        values.error(file, cell.at, TrackProblem::UnknownUnit { text })
    })?;
    let name_cells = split(names, delimiter, file)?;
    let axis_cells = split(axes, delimiter, file)?;
    let time = cell_at(&name_cells, 1);
    if !cell_at(&name_cells, 0)
        .raw
        .to_ascii_lowercase()
        .starts_with("frame")
        || !time.is("Time")
    {
        let text = time.text().into_owned();
        return Err(names.error(file, 0, TrackProblem::NoTimeColumn { text }));
    }
    let (mut points, mut columns) = (Vec::new(), Vec::new());
    for (column, cell) in name_cells.iter().enumerate().skip(2) {
        if cell.raw.is_empty() {
            continue;
        }
        for (offset, axis) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if !is_axis(&cell_at(&axis_cells, column + offset), axis) {
                let point = cell.text().into_owned();
                let at = cell_at(&axis_cells, column + offset).at;
                return Err(axes.error(file, at, TrackProblem::MissingAxis { point, axis }));
            }
        }
        let name = cell.text().into_owned();
        let kind = PointKind::of_marker(&name);
        points.push(TrackPoint::new(name, kind, String::new(), Vec::new()));
        columns.push(Columns::of([column, column + 1, column + 2]));
    }
    if points.is_empty() {
        return Err(names.error(file, 0, TrackProblem::NoPoints));
    }
    let total = find("NumFrames")
        .ok()
        .and_then(|cell| cell.raw.parse().ok());
    let width = 2 + 3 * points.len();
    let (unit, metres, overridden) = options.unit(own);
    let grid = Grid {
        // Frame numbers begin at 1.
        clock: Clock::Numbered {
            frame: 0,
            first: 1,
            rate_hz,
            time: Some(1),
        },
        metres,
        columns,
        ..Grid::under(axes.number, delimiter, width, points)
    };
    let body = grid::read(lines, file, grid)?;
    let mut warnings: Vec<TrackWarning> = overridden.into_iter().collect();
    warnings.extend(TrackWarning::frame_count(total, body.times.len()));
    Ok(Draft {
        format: TrackFormat::Trc,
        rate_hz: Some(rate_hz),
        unit,
        image: false,
        body,
        warnings,
    })
}

/// `X1`, `Y12`, `Z`.
fn is_axis(cell: &Cell<'_>, axis: char) -> bool {
    let mut chars = cell.raw.chars();
    chars
        .next()
        .is_some_and(|letter| letter.eq_ignore_ascii_case(&axis))
        && chars.all(|c| c.is_ascii_digit())
}
