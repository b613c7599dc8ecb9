//! `DeepLabCut`'s CSV: rows `scorer`, (`individuals`,) `bodyparts`, `coords`, then frame number and x, y, likelihood of each
//! part, in pixels whose y runs down.

use std::path::Path;

use super::cells::{Cell, cell_at, split};
use super::grid::{self, Clock, Columns, Grid};
use super::lines::{Delimiter, Lines, TextLine};
use super::{
    Draft, PointKind, Reading, TrackError, TrackFormat, TrackPoint, TrackProblem, TrackWarning,
    Unit,
};

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    delimiter: Delimiter,
) -> Result<Draft, TrackError> {
    let Reading { file, options, .. } = *reading;
    let mut rows: Vec<(TextLine<'_>, Vec<Cell<'_>>)> = Vec::new();
    for line in lines.head().filter(|line| !line.is_blank()).take(4) {
        rows.push((line, split(&line, delimiter, file)?));
    }
    let labelled = |label: &str| rows.iter().find(|(_, cells)| cell_at(cells, 0).is(label));
    let need = |label: &str, row: &'static str| {
        labelled(label).ok_or_else(|| {
            let line = TextLine {
                number: 1,
                text: "",
                ended: true,
            };
            line.error(file, 0, TrackProblem::NoHeaderRow { row })
        })
    };
    let (_, parts) = need("bodyparts", "`bodyparts`")?;
    let (coords_line, coords) = need("coords", "`coords`")?;
    let individuals = labelled("individuals").map(|(_, cells)| cells.as_slice());
    let name = |column: usize| {
        let part = cell_at(parts, column).text().into_owned();
        match individuals.map(|cells| cell_at(cells, column).text()) {
            // Parts that belong to no single animal.
            Some(animal) if !animal.is_empty() && animal != "single" => format!("{animal}:{part}"),
            _ => part,
        }
    };
    let (points, columns) = parts_and_columns(coords_line, coords, name, file)?;
    if points.is_empty() {
        return Err(coords_line.error(file, 0, TrackProblem::NoPoints));
    }
    let rate_hz = options.need_rate(coords_line, file)?;
    let header_line = rows
        .iter()
        .filter(|(_, cells)| is_header(cells))
        .map(|(line, _)| line.number);
    let (unit, metres, _) = options.unit(Unit::Pixel);
    let grid = Grid {
        clock: Clock::Numbered {
            frame: 0,
            first: 0,
            rate_hz,
            time: None,
        },
        metres,
        columns,
        likelihood: options.least_likelihood(),
        ..Grid::under(
            header_line.max().unwrap_or(coords_line.number),
            delimiter,
            coords.len(),
            points,
        )
    };
    let warnings: Vec<TrackWarning> = Vec::new();
    Ok(Draft {
        format: TrackFormat::DeepLabCut,
        rate_hz: Some(rate_hz),
        unit,
        image: true,
        body: grid::read(lines, reading, grid)?,
        warnings,
    })
}

fn is_header(cells: &[Cell<'_>]) -> bool {
    ["scorer", "individuals", "bodyparts", "coords"]
        .iter()
        .any(|label| cell_at(cells, 0).is(label))
}

/// The parts in order, and each one's columns.
fn parts_and_columns(
    coords_line: &TextLine<'_>,
    coords: &[Cell<'_>],
    name: impl Fn(usize) -> String,
    file: &Path,
) -> Result<(Vec<TrackPoint>, Vec<Columns>), TrackError> {
    let (mut points, mut columns): (Vec<TrackPoint>, Vec<Columns>) = (Vec::new(), Vec::new());
    for (column, coordinate) in coords.iter().enumerate().skip(1) {
        let name = name(column);
        if points.last().is_none_or(|point| point.name != name) {
            points.push(TrackPoint::new(
                name,
                PointKind::Marker,
                String::new(),
                Vec::new(),
            ));
            columns.push(Columns {
                axes: [None; 3],
                likelihood: None,
                rotation: None,
            });
        }
        let Some(last) = columns.last_mut() else {
            continue;
        };
        let slot = match coordinate.raw {
            "x" => &mut last.axes[0],
            "y" => &mut last.axes[1],
            "likelihood" => &mut last.likelihood,
            // Identity and the like.
            _ => continue,
        };
        if slot.replace(column).is_some() {
            let name = format!(
                "{}, {}",
                points.last().map_or("", |p| &p.name),
                coordinate.raw
            );
            let problem = TrackProblem::TwiceTheSameColumn { name };
            return Err(coords_line.error(file, coordinate.at, problem));
        }
    }
    for (point, columns) in points.iter().zip(&columns) {
        for (axis, column) in ['x', 'y'].into_iter().zip(columns.axes) {
            if column.is_none() {
                let point = point.name.clone();
                return Err(coords_line.error(file, 0, TrackProblem::MissingAxis { point, axis }));
            }
        }
    }
    Ok((points, columns))
}
