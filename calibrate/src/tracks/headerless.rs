//! A wide Motive export whose header was switched off: frame, time, data. Nothing says what the columns are, nor the unit, so
//! they are taken for positions, three by three, only where nothing speaks against it, and a scale must be given.

use super::cells::{Cell, split};
use super::grid::{self, Clock, Columns, Grid};
use super::lines::{Delimiter, Lines, TextLine};
use super::number::{Number, number};
use super::{
    Draft, PointKind, Reading, TrackError, TrackFormat, TrackPoint, TrackProblem, TrackWarning,
    Unit,
};

/// Rows that are looked at for rotations.
const LOOKED_AT: usize = 50;
/// Tolerance of the squared norm of a rotation's four numbers: they are written with six digits.
const UNIT_LENGTH: f64 = 1e-4;

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    delimiter: Delimiter,
) -> Result<Draft, TrackError> {
    let Reading { file, options, .. } = *reading;
    let rows = lines.head().filter(|line| !line.is_blank());
    let rows: Vec<(TextLine<'_>, Vec<Cell<'_>>)> = rows
        .take(LOOKED_AT)
        .map_while(|line| Some((line, split(&line, delimiter, file).ok()?)))
        .collect();
    let Some((first, cells)) = rows.first() else {
        return Err(TrackError::Empty {
            file: file.to_owned(),
        });
    };
    let comma = delimiter.allows_decimal_comma();
    let value = |cells: &[Cell<'_>], column: usize| match number(cells.get(column)?.raw, comma) {
        Number::Finite(value) => Some(value),
        _ => None,
    };
    let columns = cells.len() - 2;
    if columns == 0 || !columns.is_multiple_of(3) {
        return Err(first.error(file, 0, TrackProblem::Triples { columns }));
    }
    for start in 2..cells.len().saturating_sub(3) {
        let squares = rows.iter().filter_map(|(_, cells)| {
            (start..start + 4)
                .map(|column| value(cells, column).map(|value| value * value))
                .sum::<Option<f64>>()
        });
        let (mut seen, mut unit) = (0, 0);
        for square in squares {
            seen += 1;
            unit += usize::from((square - 1.0).abs() < UNIT_LENGTH);
        }
        if seen > 0 && seen == unit {
            let at = cells.get(start).map_or(0, |cell| cell.at);
            return Err(first.error(file, at, TrackProblem::LooksLikeRotation));
        }
    }
    // Rate: frames over time between the first and the last row that was looked at.
    let clock = |cells: &[Cell<'_>]| Some((value(cells, 0)?, value(cells, 1)?));
    let ends = (
        clock(cells),
        rows.last().and_then(|(_, cells)| clock(cells)),
    );
    let scale_and_rate = match ends {
        (Some((f0, t0)), Some((f1, t1))) if f1 > f0 && t1 > t0 => {
            Some(whole((f1 - f0) / (t1 - t0)))
        }
        _ => None,
    };
    let (rate_hz, other_rate) = match scale_and_rate {
        Some(rate) => options.rate_over(rate),
        None => (options.need_rate(first, file)?, None),
    };
    // The frame at time zero: 0 in Motive, 1 elsewhere.
    let first = clock(cells).map_or(0.0, |(frame, time)| frame - (time * rate_hz).round());
    let (unit, metres, _) = options.unit(Unit::Unknown);
    let point = |index: usize| {
        let name = format!("column {}", 3 * index + 3);
        TrackPoint::new(name, PointKind::Marker, String::new(), Vec::new())
    };
    let grid = Grid {
        clock: Clock::Numbered {
            frame: 0,
            first: u64::from(first > 0.5),
            rate_hz,
            time: Some(1),
        },
        metres,
        columns: (0..columns / 3)
            .map(|index| Columns::of([2, 3, 4].map(|column| column + 3 * index)))
            .collect(),
        ..Grid::under(
            0,
            delimiter,
            cells.len(),
            (0..columns / 3).map(point).collect(),
        )
    };
    Ok(Draft {
        format: TrackFormat::MotiveWithoutHeader,
        rate_hz: Some(rate_hz),
        unit,
        image: false,
        body: grid::read(lines, reading, grid)?,
        warnings: std::iter::once(TrackWarning::NoHeader)
            .chain(other_rate)
            .collect(),
    })
}

/// A whole rate where rounded times hide it.
fn whole(rate_hz: f64) -> f64 {
    let whole = rate_hz.round();
    if (rate_hz - whole).abs() < 1e-3 * whole {
        whole
    } else {
        rate_hz
    }
}
