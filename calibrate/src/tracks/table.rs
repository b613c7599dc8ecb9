//! A plain table with named columns (`t,x1,y1,x2,y2`): comma, semicolon, tab or spaces between them.
//!
//! * Time: a column `t`, `time`, `time_s`, `seconds`, `Time (Seconds)`, …; else `frame` together with [`TableOptions::rate_hz`].
//! * Points: columns whose names are the same but for one letter x, y or z at either end (`x1`/`y1` → `1`, `front_x`/`front_y`
//!   → `front`); a bare `x`/`y` is the point `x,y`. Other pairs are named by the caller ([`TableOptions::pairs`]).
//! * Unit: metres, unless a column's name ends in a unit (`x1_mm`, `x1 [cm]`) or the caller gives a scale.
//! * Blank or NaN is missing. Columns that belong to nothing are not read.

mod header;

use std::path::Path;

use super::detect::TableLayout;
use super::lines::{Cell, Line, cell_at, lines, split};
use super::number::{Number, number};
use super::{TrackError, TrackFile, TrackFormat, TrackProblem, TrackWarning};
use header::Header;

/// What the user knows about a table that its header does not say.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TableOptions {
    /// Metres per unit of the table (pixels); `None` where the columns are metres or name their unit.
    pub metres_per_unit: Option<f64>,
    /// Rows a second, for a table with frame numbers and no time.
    pub rate_hz: Option<f64>,
    /// Further points by the names of their x and y columns; each is named `x,y`.
    pub pairs: Vec<[String; 2]>,
}

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    text: &str,
    file: &Path,
    layout: &TableLayout,
    options: &TableOptions,
) -> Result<TrackFile, TrackError> {
    let mut lines = lines(text).skip_while(|line| line.number < layout.header_line);
    let Some(header_line) = lines.next() else {
        return Err(TrackError::Empty {
            file: file.to_owned(),
        });
    };
    let header = Header::read(header_line, file, layout, options)?;
    let comma = layout.delimiter.allows_decimal_comma();
    let mut points = header.points.clone();
    let (mut times, mut frame_numbers): (Vec<f64>, Vec<u64>) = (Vec::new(), Vec::new());
    let mut cells = Vec::with_capacity(header.width);
    let (mut warnings, mut half_blank) = (Vec::new(), None);
    for line in lines {
        if line.is_blank() || line.text.trim_start().starts_with(['#', '%']) {
            continue;
        }
        split(&line, layout.delimiter, file, &mut cells)?;
        if cells.len() < header.width && !line.ended && !times.is_empty() {
            warnings.push(TrackWarning::LastLineCut { line: line.number });
            break;
        }
        if cells.len() < header.width
            || cells
                .iter()
                .skip(header.width)
                .any(|cell| !cell.raw.is_empty())
        {
            let problem = TrackProblem::RowLength {
                cells: cells.len(),
                expected: header.width,
            };
            return Err(line.error(file, line.text.len(), problem));
        }
        let (frame, time) = header.clock.read(&cells, &line, file, comma, times.len())?;
        if let Some(previous) = times.last().copied().filter(|previous| time <= *previous) {
            return Err(line.error(file, 0, TrackProblem::TimeOrder { previous, time }));
        }
        times.push(time);
        frame_numbers.push(frame);
        for (point, columns) in points.iter_mut().zip(&header.columns) {
            let place = place(&cells, columns, &line, file, comma, &point.columns)?;
            if place.blank > 0 && place.blank < columns.len() {
                half_blank.get_or_insert((0, line.number)).0 += 1;
            }
            point.push(
                (place.blank == 0).then_some(place.at.map(|value| value * header.unit.metres())),
            );
        }
    }
    if times.is_empty() {
        return Err(header_line.error(file, 0, TrackProblem::NoData));
    }
    if let Some((count, first_line)) = half_blank {
        warnings.push(TrackWarning::HalfBlank { count, first_line });
    }
    Ok(TrackFile {
        format: TrackFormat::Table,
        rate_hz: rate(&times, &mut warnings),
        unit: header.unit,
        frame_numbers,
        times,
        points,
        warnings,
    })
}

/// The median rate \[Hz\]; 0 for a single row.
fn rate(times: &[f64], warnings: &mut Vec<TrackWarning>) -> f64 {
    let mut steps: Vec<f64> = times
        .windows(2)
        .map(|pair| {
            pair.iter()
                .rev()
                .copied()
                .reduce(|b, a| b - a)
                .unwrap_or(0.0)
        })
        .collect();
    steps.sort_by(f64::total_cmp);
    let (Some(shortest), Some(longest), Some(median)) =
        (steps.first(), steps.last(), steps.get(steps.len() / 2))
    else {
        return 0.0;
    };
    if longest - shortest > 0.01 * median {
        warnings.push(TrackWarning::UnevenTimes {
            shortest: *shortest,
            longest: *longest,
        });
    }
    1.0 / median
}

struct Placed {
    at: [f64; 3],
    blank: usize,
}

fn place(
    cells: &[Cell<'_>],
    columns: &[usize],
    line: &Line<'_>,
    file: &Path,
    comma: bool,
    names: &[String],
) -> Result<Placed, TrackError> {
    let mut placed = Placed {
        at: [0.0; 3],
        blank: 0,
    };
    for ((value, column), name) in placed.at.iter_mut().zip(columns).zip(names) {
        let cell = cell_at(cells, *column);
        match number(cell.raw, comma) {
            Number::Finite(finite) => *value = finite,
            Number::Missing => placed.blank += 1,
            Number::Wrong => {
                let (text, cell_name) = (cell.text().into_owned(), name.clone());
                return Err(line.error(
                    file,
                    cell.at,
                    TrackProblem::NotANumber {
                        text,
                        cell: cell_name,
                    },
                ));
            }
        }
    }
    Ok(placed)
}
