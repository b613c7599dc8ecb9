//! Poses without a header: rows of `t x y θ`, or of `t x y z qx qy qz qw` as trajectory tools write them. Nothing says the unit of
//! length, so a scale must be given; angles are radians.

use std::path::Path;

use super::cells::split;
use super::grid::{self, Clock, Columns, Grid};
use super::lines::{Delimiter, Lines, TextLine};
use super::number::{Number, number};
use super::rotation::{Rotation, normalized};
use super::{Draft, PointKind, Reading, TrackError, TrackFormat, TrackPoint, TrackWarning, Unit};

/// Cells of a plane pose and of one in space.
const PLANE: usize = 4;
const SPACE: usize = 8;
/// Rows by which such a table is recognised.
const ROWS: usize = 50;

/// The delimiter, if the first rows are such poses.
pub(super) fn delimiter(
    first: &TextLine<'_>,
    below: &[TextLine<'_>],
    file: &Path,
) -> Option<Delimiter> {
    let delimiter = Delimiter::of(first.text);
    let comma = delimiter.allows_decimal_comma();
    let values = |line: &TextLine<'_>| -> Option<Vec<f64>> {
        let cells = split(line, delimiter, file).ok()?;
        let value = |text: &str| match number(text, comma) {
            Number::Finite(value) => Some(value),
            _ => None,
        };
        cells.iter().map(|cell| value(cell.raw)).collect()
    };
    let lines = std::iter::once(first).chain(below).take(ROWS);
    let rows: Vec<Vec<f64>> = lines.map(values).collect::<Option<_>>()?;
    let width = rows.first()?.len();
    let is_turn = |row: &Vec<f64>| matches!(row.as_slice(), [_, _, _, _, x, y, z, w] if normalized([*x, *y, *z, *w]).is_some());
    let later = rows.iter().skip(1);
    let grow = rows.iter().zip(later).all(|(a, b)| b.first() > a.first());
    let poses = width == PLANE || (width == SPACE && rows.iter().all(is_turn));
    (rows.len() > 1 && grow && poses && rows.iter().all(|row| row.len() == width))
        .then_some(delimiter)
}

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    delimiter: Delimiter,
) -> Result<Draft, TrackError> {
    let first = lines.head().find(|line| !line.is_blank());
    let cells = first.map_or(Ok(Vec::new()), |line| split(&line, delimiter, reading.file))?;
    let columns = if cells.len() == PLANE {
        Columns {
            axes: [Some(1), Some(2), None],
            likelihood: None,
            rotation: Some(Rotation::Yaw(3, 1.0)),
        }
    } else {
        Columns {
            rotation: Some(Rotation::Quaternion([4, 5, 6, 7])),
            ..Columns::of([1, 2, 3])
        }
    };
    let name = "pose".to_owned();
    let point = TrackPoint::new(name, PointKind::RigidBody, String::new(), Vec::new()).oriented();
    let (unit, metres, _) = reading.options.unit(Unit::Unknown);
    let grid = Grid {
        clock: Clock::Stamped {
            time: 0,
            seconds: 1.0,
            frame: None,
        },
        metres,
        columns: vec![columns],
        short_angles: true,
        ..Grid::under(0, delimiter, cells.len(), vec![point])
    };
    Ok(Draft {
        format: TrackFormat::Table,
        rate_hz: None,
        unit,
        image: false,
        body: grid::read(lines, reading, grid)?,
        warnings: vec![TrackWarning::Poses],
    })
}
