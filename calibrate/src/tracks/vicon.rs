//! Vicon's CSV, a section of trajectories (`X,Y,Z`) or of rigid bodies (`Objects`, `Segments`: `RX,RY,RZ,TX,TY,TZ`, a rotation
//! vector and a position): its name, the rate, names above the axes, a row of units.

use std::ops::Range;
use std::path::Path;

use super::cells::{Cell, cell_at, split};
use super::grid::{self, Clock, Columns, Grid};
use super::lines::{Delimiter, Lines, TextLine};
use super::number;
use super::rotation::Rotation;
use super::{
    Draft, FilePosition, PointKind, Reading, TrackError, TrackFormat, TrackPoint, TrackProblem,
    TrackWarning, Unit,
};

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    delimiter: Delimiter,
) -> Result<Draft, TrackError> {
    let Reading { file, options, .. } = *reading;
    let rows: Vec<TextLine<'_>> = lines
        .head()
        .filter(|line| !line.is_blank())
        .take(5)
        .collect();
    let [_, rate_line, names, axes, units] = rows.as_slice() else {
        return Err(TrackError::Broken {
            place: FilePosition {
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
    let (rate_hz, other_rate) = options.rate_over(rate_hz);
    let name_cells = split(names, delimiter, file)?;
    let axis_cells = split(axes, delimiter, file)?;
    let unit_cells = split(units, delimiter, file)?;
    if !cell_at(&axis_cells, 0).is("Frame") {
        return Err(axes.error(file, 0, TrackProblem::NoAxisRow));
    }
    let (mut points, mut columns, mut own) = (Vec::new(), Vec::new(), None);
    let named = |column: &usize| !cell_at(&name_cells, *column).raw.is_empty();
    let starts: Vec<usize> = (0..name_cells.len()).filter(named).collect();
    for (index, column) in starts.iter().copied().enumerate() {
        let cell = cell_at(&name_cells, column);
        let end = starts.get(index + 1).copied().unwrap_or(axis_cells.len());
        let body = (column..end).any(|at| cell_at(&axis_cells, at).is("TX"));
        let letters = if body {
            ["TX", "TY", "TZ"]
        } else {
            ["X", "Y", "Z"]
        };
        let mut places = [0; 3];
        for (place, axis) in places.iter_mut().zip(letters) {
            let found = (column..end).find(|at| cell_at(&axis_cells, *at).is(axis));
            let Some(at) = found else {
                let point = cell.text().into_owned();
                let axis = axis.chars().next_back().unwrap_or('?');
                let problem = TrackProblem::MissingAxis { point, axis };
                return Err(axes.error(file, cell_at(&axis_cells, column).at, problem));
            };
            *place = at;
            let text = cell_at(&unit_cells, at);
            let unit = unit_of(units, &text, file)?;
            if *own.get_or_insert(unit) != unit {
                let text = format!("{unit} next to another unit");
                return Err(units.error(file, 0, TrackProblem::UnknownUnit { text }));
            }
        }
        let name = cell.text().into_owned();
        let kind = if body {
            PointKind::RigidBody
        } else {
            PointKind::of_marker(&name)
        };
        let rotation = rotation(column..end, &axis_cells, &unit_cells);
        let point = TrackPoint::new(name, kind, String::new(), Vec::new());
        points.push(match rotation {
            Some(_) => point.oriented(),
            None => point,
        });
        columns.push(Columns {
            rotation,
            ..Columns::of(places)
        });
    }
    let Some(own) = own else {
        return Err(names.error(file, 0, TrackProblem::NoPoints));
    };
    let last = axis_cells.iter().rposition(|cell| !cell.raw.is_empty());
    let width = last.map_or(0, |last| last + 1);
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
    let warnings: Vec<TrackWarning> = overridden.into_iter().chain(other_rate).collect();
    Ok(Draft {
        format: TrackFormat::Vicon,
        rate_hz: Some(rate_hz),
        unit,
        image: false,
        body: grid::read(lines, reading, grid)?,
        warnings,
    })
}

/// The rotation vector of a body in these columns.
fn rotation(
    columns: Range<usize>,
    axis_cells: &[Cell<'_>],
    unit_cells: &[Cell<'_>],
) -> Option<Rotation> {
    let find = |axis: &str| {
        let mut columns = columns.clone();
        columns.find(|at| cell_at(axis_cells, *at).is(axis))
    };
    let [x, y, z] = [find("RX")?, find("RY")?, find("RZ")?];
    let radians = match cell_at(unit_cells, x).raw {
        "rad" => 1.0,
        _ => 1_f64.to_radians(),
    };
    Some(Rotation::Vector([x, y, z], radians))
}

fn unit_of(line: &TextLine<'_>, cell: &Cell<'_>, file: &Path) -> Result<Unit, TrackError> {
    Unit::from_name(cell.raw).ok_or_else(|| {
        let text = cell.text().into_owned();
        line.error(file, cell.at, TrackProblem::UnknownUnit { text })
    })
}
