//! TRC: three lines of keys, a line of names, a line of axes; tabs, or what Cortex and hand-made files put for them.

use std::path::Path;

use super::cells::{Cell, cell_at, split};
use super::grid::{self, Clock, Columns, Grid};
use super::lines::{Delimiter, Lines, TextLine};
use super::number;
use super::{
    Draft, PointKind, Reading, TrackError, TrackFormat, TrackPoint, TrackProblem, TrackWarning,
    Unit,
};

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(lines: &mut Lines<'_>, reading: &Reading<'_>) -> Result<Draft, TrackError> {
    let Reading { file, options, .. } = *reading;
    let rows: Vec<_> = lines
        .head()
        .filter(|line| !line.is_blank())
        .take(5)
        .collect();
    let [first, keys, values, names, axes] = rows.as_slice() else {
        return Err(TrackError::Broken {
            place: super::FilePosition {
                file: file.to_owned(),
                line: rows.len() + 1,
                column: 1,
            },
            problem: TrackProblem::NoHeaderRow {
                row: "axes (X1, Y1, Z1)",
            },
        });
    };
    let by_tabs = first.text.contains('\t') || keys.text.contains('\t');
    let delimiter = if by_tabs {
        Delimiter::Tab
    } else {
        Delimiter::of(keys.text)
    };
    let (key_cells, value_cells) = (
        split(keys, delimiter, file)?,
        split(values, delimiter, file)?,
    );
    let find = |key: &'static str| {
        value(&key_cells, &value_cells, key)
            .ok_or_else(|| keys.error(file, 0, TrackProblem::NoKey { key }))
    };
    let rate = find("DataRate")?;
    let rate_hz = number::rate(&rate, values, file, delimiter.allows_decimal_comma())?;
    let (rate_hz, other_rate) = options.rate_over(rate_hz);
    let cell = find("Units")?;
    let own = Unit::from_name(cell.raw).ok_or_else(|| {
        let text = cell.text().into_owned();
        values.error(file, cell.at, TrackProblem::UnknownUnit { text })
    })?;
    let points = points(names, axes, delimiter, file)?;
    let total = find("NumFrames")
        .ok()
        .and_then(|cell| cell.raw.parse().ok());
    let width = 2 + 3 * points.len();
    let data = lines
        .head()
        .find(|line| line.number > axes.number && !line.is_blank());
    let delimiter = data.map_or(delimiter, |line| {
        rows_delimiter(&line, delimiter, width, file)
    });
    let columns = (0..points.len()).map(|i| Columns::of([2, 3, 4].map(|axis| axis + 3 * i)));
    let columns = columns.collect();
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
    let body = grid::read(lines, reading, grid)?;
    let mut warnings: Vec<TrackWarning> = overridden.into_iter().chain(other_rate).collect();
    warnings.extend(TrackWarning::frame_count(total, body.timeline.len()));
    Ok(Draft {
        format: TrackFormat::Trc,
        rate_hz: Some(rate_hz),
        unit,
        image: false,
        body,
        warnings,
    })
}

/// The value under a key: in its column, or where extra tabs have moved columns, in its order.
fn value<'a>(keys: &[Cell<'a>], values: &[Cell<'a>], key: &str) -> Option<Cell<'a>> {
    let full = |cells: &[Cell<'a>]| -> Vec<Cell<'a>> {
        cells
            .iter()
            .filter(|cell| !cell.raw.is_empty())
            .copied()
            .collect()
    };
    let (in_keys, in_values) = (full(keys), full(values));
    if in_keys.len() == in_values.len() {
        let index = in_keys.iter().position(|cell| cell.is(key))?;
        return in_values.get(index).copied();
    }
    let column = keys.iter().position(|cell| cell.is(key))?;
    Some(cell_at(values, column))
}

/// The markers, by order: Cortex puts spaces and any number of tabs between their names, and X1, Y1, Z1, … below.
fn points(
    names: &TextLine<'_>,
    axes: &TextLine<'_>,
    delimiter: Delimiter,
    file: &Path,
) -> Result<Vec<TrackPoint>, TrackError> {
    let cells = split(names, delimiter, file)?;
    let mut titles: Vec<String> = cells.iter().map(|cell| cell.text().into_owned()).collect();
    if delimiter == Delimiter::Spaces && names.text.trim().contains("  ") {
        // A name may hold a space where two and more stand between names.
        titles = names
            .text
            .split("  ")
            .map(|title| title.trim().to_owned())
            .collect();
    }
    titles.retain(|title| !title.is_empty());
    let mut titles = titles.into_iter();
    let (frame, time) = (
        titles.next().unwrap_or_default(),
        titles.next().unwrap_or_default(),
    );
    if !frame.to_ascii_lowercase().starts_with("frame") || !time.eq_ignore_ascii_case("time") {
        return Err(names.error(file, 0, TrackProblem::NoTimeColumn { text: time }));
    }
    let axis_cells = split(axes, delimiter, file)?;
    let mut letters = axis_cells
        .iter()
        .flat_map(|cell| cell.raw.split_whitespace());
    let mut points = Vec::new();
    for name in titles {
        for axis in ['X', 'Y', 'Z'] {
            if !letters.next().is_some_and(|letter| is_axis(letter, axis)) {
                return Err(axes.error(file, 0, TrackProblem::MissingAxis { point: name, axis }));
            }
        }
        let kind = PointKind::of_marker(&name);
        points.push(TrackPoint::new(name, kind, String::new(), Vec::new()));
    }
    match letters.next() {
        None if points.is_empty() => Err(names.error(file, 0, TrackProblem::NoPoints)),
        None => Ok(points),
        Some(_) => {
            let expected = 3 * points.len();
            let cells = expected + 1 + letters.count();
            Err(axes.error(file, 0, TrackProblem::RowLength { cells, expected }))
        }
    }
}

/// Single tabs, where blank cells are missing markers; or where that gives another number of cells, anything between them.
fn rows_delimiter(line: &TextLine<'_>, header: Delimiter, width: usize, file: &Path) -> Delimiter {
    let count = |delimiter| {
        let cells = split(line, delimiter, file).unwrap_or_default();
        let last = cells.iter().rposition(|cell| !cell.raw.is_empty());
        last.map_or(0, |last| last + 1)
    };
    let by_header = count(header);
    if count(Delimiter::Spaces) == width && (by_header > width || by_header < 2) {
        Delimiter::Spaces
    } else {
        header
    }
}

/// `X1`, `Y12`, `Z`.
fn is_axis(text: &str, axis: char) -> bool {
    let mut chars = text.chars();
    chars
        .next()
        .is_some_and(|letter| letter.eq_ignore_ascii_case(&axis))
        && chars.all(|c| c.is_ascii_digit())
}
