//! Qualisys Track Manager's TSV: `KEY<tab>value` lines, a row of column names (which the export may leave out), millimetres; of
//! markers (3D) or of rigid bodies (6D).

use std::path::Path;

use super::cells::{Cell, cell_at, split};
use super::grid::{self, Clock, Columns, Grid};
use super::lines::{Delimiter, Lines, TextLine};
use super::number;
use super::rotation::Rotation;
use super::{
    Draft, PointKind, Reading, TrackError, TrackFormat, TrackPoint, TrackProblem, TrackWarning,
    Unit,
};

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(lines: &mut Lines<'_>, reading: &Reading<'_>) -> Result<Draft, TrackError> {
    let Reading { file, options, .. } = *reading;
    let delimiter = Delimiter::Tab;
    let mut head: Vec<(TextLine<'_>, Vec<Cell<'_>>)> = Vec::new();
    for line in lines.head().filter(|line| !line.is_blank()) {
        let cells = split(&line, delimiter, file)?;
        let first = cell_at(&cells, 0);
        // Keys begin with a letter, rows with a number or a blank.
        if !first.raw.starts_with(|c: char| c.is_ascii_alphabetic()) {
            break;
        }
        head.push((line, cells));
    }
    let Some((last, _)) = head.last() else {
        return Err(TrackError::Empty {
            file: file.to_owned(),
        });
    };
    let find = |key: &'static str| {
        let row = head.iter().find(|(_, cells)| cell_at(cells, 0).is(key));
        row.ok_or_else(|| last.error(file, 0, TrackProblem::NoKey { key }))
    };
    let (line, cells) = find("FREQUENCY")?;
    let rate = cell_at(cells, 1);
    let (rate_hz, other_rate) = options.rate_over(number::rate(&rate, line, file, true)?);
    let bodies = find("BODY_NAMES").is_ok();
    let (names_line, names) = find(if bodies { "BODY_NAMES" } else { "MARKER_NAMES" })?;
    let names: Vec<String> = names
        .iter()
        .skip(1)
        .filter(|cell| !cell.raw.is_empty())
        .map(|cell| cell.text().into_owned())
        .collect();
    if names.is_empty() {
        return Err(names_line.error(file, 0, TrackProblem::NoPoints));
    }
    let titles = head.last().filter(|(_, cells)| {
        cells
            .iter()
            .any(|cell| names.iter().any(|name| cell.raw == format!("{name} X")) || cell.is("X"))
    });
    let (frame, time, columns) = if bodies {
        of_bodies(titles, &names, file)?
    } else {
        columns(titles, &names, file)?
    };
    let used = columns.iter().flat_map(|columns| {
        let rotation = columns.rotation.as_ref().map_or(&[][..], Rotation::columns);
        let axes = columns.axes.into_iter().flatten();
        axes.chain(rotation.iter().copied())
    });
    let width = used.max().map_or(0, |last| last + 1);
    let total = find("NO_OF_FRAMES")
        .ok()
        .and_then(|(_, cells)| cell_at(cells, 1).raw.parse().ok());
    let points = names
        .into_iter()
        .map(|name| {
            let kind = if bodies {
                PointKind::RigidBody
            } else {
                PointKind::of_marker(&name)
            };
            let point = TrackPoint::new(name, kind, String::new(), Vec::new());
            if bodies { point.oriented() } else { point }
        })
        .collect();
    let (unit, metres, overridden) = options.unit(Unit::Millimetre);
    let grid = Grid {
        clock: match frame {
            // Frame numbers begin at 1.
            Some(frame) => Clock::Numbered {
                frame,
                first: 1,
                rate_hz,
                time,
            },
            None => Clock::Counted { rate_hz },
        },
        metres,
        columns,
        origin_is_missing: true,
        ..Grid::under(last.number, delimiter, width, points)
    };
    let body = grid::read(lines, reading, grid)?;
    let mut warnings: Vec<TrackWarning> = overridden.into_iter().chain(other_rate).collect();
    warnings.extend(TrackWarning::frame_count(total, body.timeline.len()));
    Ok(Draft {
        format: TrackFormat::Qtm,
        rate_hz: Some(rate_hz),
        unit,
        image: false,
        body,
        warnings,
    })
}

/// Columns of the frame, of the time, and of each marker: by their titles, or without any in the order of the names.
type Places = (Option<usize>, Option<usize>, Vec<Columns>);

fn columns(
    titles: Option<&(TextLine<'_>, Vec<Cell<'_>>)>,
    names: &[String],
    file: &Path,
) -> Result<Places, TrackError> {
    let Some((line, cells)) = titles else {
        let ordered = (0..names.len())
            .map(|index| Columns::of([0, 1, 2].map(|axis| axis + 3 * index)))
            .collect();
        return Ok((None, None, ordered));
    };
    let column = |title: &str| cells.iter().position(|cell| cell.raw == title);
    let mut columns = Vec::with_capacity(names.len());
    for name in names {
        let mut axes = [0; 3];
        for (place, axis) in axes.iter_mut().zip(['X', 'Y', 'Z']) {
            *place = column(&format!("{name} {axis}")).ok_or_else(|| {
                let point = name.clone();
                line.error(file, 0, TrackProblem::MissingAxis { point, axis })
            })?;
        }
        columns.push(Columns::of(axes));
    }
    Ok((column("Frame"), column("Time"), columns))
}

/// Titles of a body's columns, of which the position and the matrix are read.
const BODY: [&str; 16] = [
    "X", "Y", "Z", "Roll", "Pitch", "Yaw", "Residual", "Rot[0]", "Rot[1]", "Rot[2]", "Rot[3]",
    "Rot[4]", "Rot[5]", "Rot[6]", "Rot[7]", "Rot[8]",
];
/// Index of the first element of the matrix among them.
const MATRIX: usize = 7;

/// Columns of rigid bodies, which stand one after the other: the title of the first column begins with the body's name, or not.
fn of_bodies(
    titles: Option<&(TextLine<'_>, Vec<Cell<'_>>)>,
    names: &[String],
    file: &Path,
) -> Result<Places, TrackError> {
    let mut columns = Vec::with_capacity(names.len());
    let mut from = 0;
    for name in names {
        let mut of_body = [0; BODY.len()];
        for (place, title) in of_body.iter_mut().zip(BODY) {
            *place = match titles {
                None => from,
                Some((line, cells)) => {
                    let is = |cell: &Cell<'_>| {
                        cell.is(title)
                            || cell
                                .raw
                                .strip_prefix(name.as_str())
                                .is_some_and(|rest| rest.trim() == title)
                    };
                    let rest = cells.iter().enumerate().skip(from);
                    let found = rest.into_iter().find(|(_, cell)| is(cell));
                    found.map(|(column, _)| column).ok_or_else(|| {
                        let (name, cell) = (name.clone(), title.to_owned());
                        line.error(
                            file,
                            0,
                            TrackProblem::NoColumn {
                                name: format!("{name} {cell}"),
                                columns: titles_of(cells),
                            },
                        )
                    })?
                }
            };
            from = *place + 1;
        }
        let [x, y, z, ..] = of_body;
        let mut matrix = [0; 9];
        for (column, place) in matrix.iter_mut().zip(of_body.iter().skip(MATRIX)) {
            *column = *place;
        }
        columns.push(Columns {
            rotation: Some(Rotation::Matrix(matrix)),
            ..Columns::of([x, y, z])
        });
    }
    let column =
        |title: &str| titles.and_then(|(_, cells)| cells.iter().position(|cell| cell.raw == title));
    Ok((column("Frame"), column("Time"), columns))
}

fn titles_of(cells: &[Cell<'_>]) -> String {
    let titles: Vec<&str> = cells.iter().map(|cell| cell.raw).collect();
    titles.join(", ")
}
