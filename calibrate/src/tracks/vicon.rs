//! Vicon Nexus' CSV, the section of trajectories: its name, the rate, `subject:marker` above x, y, z, a row of units.

use std::path::Path;

use super::cells::{Cell, cell_at, split};
use super::grid::{self, Clock, Columns, Grid};
use super::lines::{Delimiter, Line, Lines};
use super::number;
use super::{
    Draft, Place, PointKind, TrackError, TrackFormat, TrackOptions, TrackPoint, TrackProblem,
    TrackWarning, Unit,
};

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    file: &Path,
    delimiter: Delimiter,
    options: &TrackOptions,
) -> Result<Draft, TrackError> {
    let rows: Vec<Line<'_>> = lines
        .head()
        .filter(|line| !line.is_blank())
        .take(5)
        .collect();
    let [_, rate_line, names, axes, units] = rows.as_slice() else {
        return Err(TrackError::Broken {
            place: Place {
                file: file.to_owned(),
                line: rows.len() + 1,
                column: 1,
            },
            problem: TrackProblem::NoHeaderRow {
                row: "units (mm, mm, mm)",
            },
        });
    };
    let rate = cell_at(&split(rate_line, delimiter, file)?, 0);
    let rate_hz = number::rate(&rate, rate_line, file, delimiter.allows_decimal_comma())?;
    let name_cells = split(names, delimiter, file)?;
    let axis_cells = split(axes, delimiter, file)?;
    let unit_cells = split(units, delimiter, file)?;
    if !cell_at(&axis_cells, 0).is("Frame") {
        return Err(axes.error(file, 0, TrackProblem::NoAxisRow));
    }
    let (mut points, mut columns, mut own) = (Vec::new(), Vec::new(), None);
    for (column, cell) in name_cells.iter().enumerate() {
        if cell.raw.is_empty() {
            continue;
        }
        for (offset, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
            let letter = cell_at(&axis_cells, column + offset);
            if !letter.is(axis) {
                let point = cell.text().into_owned();
                let axis = axis.chars().next().unwrap_or('?');
                let problem = TrackProblem::MissingAxis { point, axis };
                return Err(axes.error(file, letter.at, problem));
            }
            let text = cell_at(&unit_cells, column + offset);
            let unit = unit_of(units, &text, file)?;
            if *own.get_or_insert(unit) != unit {
                let text = format!("{unit} beside another unit");
                return Err(units.error(file, 0, TrackProblem::UnknownUnit { text }));
            }
        }
        let name = cell.text().into_owned();
        let kind = PointKind::of_marker(&name);
        points.push(TrackPoint::new(name, kind, String::new(), Vec::new()));
        columns.push(Columns::of([column, column + 1, column + 2]));
    }
    let Some(own) = own else {
        return Err(names.error(file, 0, TrackProblem::NoPoints));
    };
    let width = columns
        .iter()
        .flat_map(|columns: &Columns| columns.axes)
        .flatten()
        .max()
        .map_or(0, |last| last + 1);
    let (unit, metres, overridden) = options.unit(own);
    let grid = Grid {
        clock: Clock::Numbered {
            frame: 0,
            first: 1,
            rate_hz,
            time: None,
        },
        metres,
        columns,
        section: true,
        ..Grid::under(units.number, delimiter, width, points)
    };
    let warnings: Vec<TrackWarning> = overridden.into_iter().collect();
    Ok(Draft {
        format: TrackFormat::Vicon,
        rate_hz: Some(rate_hz),
        unit,
        image: false,
        body: grid::read(lines, file, grid)?,
        warnings,
    })
}

fn unit_of(line: &Line<'_>, cell: &Cell<'_>, file: &Path) -> Result<Unit, TrackError> {
    Unit::from_name(cell.raw).ok_or_else(|| {
        let text = cell.text().into_owned();
        line.error(file, cell.at, TrackProblem::UnknownUnit { text })
    })
}
