//! The data rows of a wide Motive file: the hot loop of the reader.

use std::path::Path;

use super::header::Header;
use crate::tracks::lines::{Cell, Delimiter, Line, cell_at, split};
use crate::tracks::number::{Number, number};
use crate::tracks::{TrackError, TrackPoint, TrackProblem, TrackWarning};

/// The rows, read.
pub(super) struct Rows {
    pub(super) frame_numbers: Vec<u64>,
    pub(super) points: Vec<TrackPoint>,
}

pub(super) fn read<'a>(
    lines: impl Iterator<Item = Line<'a>>,
    file: &Path,
    delimiter: Delimiter,
    header: &Header,
    warnings: &mut Vec<TrackWarning>,
) -> Result<Rows, TrackError> {
    let mut rows = Rows {
        frame_numbers: Vec::new(),
        points: header.points.clone(),
    };
    let mut cells: Vec<Cell<'a>> = Vec::with_capacity(header.width);
    let mut notes = Notes::default();
    let comma = delimiter.allows_decimal_comma();
    let metres = header.unit.metres();
    let mut last_line = header.axis_line;
    for line in lines {
        last_line = line.number;
        if line.is_blank() {
            continue;
        }
        split(&line, delimiter, file, &mut cells)?;
        let extra = cells
            .iter()
            .skip(header.width)
            .any(|cell| !cell.raw.is_empty());
        if cells.len() < header.width && !line.ended && !rows.frame_numbers.is_empty() {
            warnings.push(TrackWarning::LastLineCut { line: line.number });
            break;
        }
        if cells.len() < header.width || extra {
            let problem = TrackProblem::RowLength {
                cells: cells.len(),
                expected: header.width,
            };
            return Err(line.error(file, line.text.len(), problem));
        }
        let frame = frame_number(&cells, &line, file)?;
        if let Some(previous) = rows.frame_numbers.last().copied() {
            if frame <= previous {
                return Err(line.error(file, 0, TrackProblem::FrameOrder { previous, frame }));
            }
            notes.jumped(frame - previous - 1);
        }
        notes.time(frame, cells.get(1).map_or("", |cell| cell.raw), comma);
        rows.frame_numbers.push(frame);
        for (point, columns) in rows.points.iter_mut().zip(&header.columns) {
            let place = position(&cells, columns, &line, file, comma, &point.name, &mut notes)?;
            point.push(place.map(|place| place.map(|value| value * metres)));
        }
    }
    if rows.frame_numbers.is_empty() {
        let line = Line {
            number: last_line,
            text: "",
            ended: true,
        };
        return Err(line.error(file, 0, TrackProblem::NoData));
    }
    notes.tell(header.rate_hz, warnings);
    Ok(rows)
}

fn frame_number(cells: &[Cell<'_>], line: &Line<'_>, file: &Path) -> Result<u64, TrackError> {
    let cell = cell_at(cells, 0);
    cell.raw.parse().map_err(|_| {
        line.error(
            file,
            cell.at,
            TrackProblem::NotAFrameNumber {
                text: cell.text().into_owned(),
            },
        )
    })
}

fn position(
    cells: &[Cell<'_>],
    columns: &[usize; 3],
    line: &Line<'_>,
    file: &Path,
    comma: bool,
    point: &str,
    notes: &mut Notes,
) -> Result<Option<[f64; 3]>, TrackError> {
    let mut values = [f64::NAN; 3];
    let mut missing = 0;
    for ((value, column), axis) in values.iter_mut().zip(columns).zip(["X", "Y", "Z"]) {
        let cell = cell_at(cells, *column);
        match number(cell.raw, comma) {
            Number::Finite(finite) => *value = finite,
            Number::Missing => missing += 1,
            Number::Wrong => {
                let text = cell.text().into_owned();
                let cell_name = format!("{point}, Position {axis}");
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
    if missing == 1 || missing == 2 {
        notes.half_blank(line.number);
    }
    Ok((missing == 0).then_some(values))
}

/// What is worth a warning at the end.
#[derive(Default)]
struct Notes {
    jumps: usize,
    skipped: u64,
    half_blank: Option<(usize, usize)>,
    first_time: Option<(u64, f64)>,
    last_time: Option<(u64, f64)>,
}

impl Notes {
    fn jumped(&mut self, skipped: u64) {
        self.jumps += usize::from(skipped > 0);
        self.skipped = self.skipped.saturating_add(skipped);
    }

    fn half_blank(&mut self, line: usize) {
        self.half_blank.get_or_insert((0, line)).0 += 1;
    }

    fn time(&mut self, frame: u64, text: &str, comma: bool) {
        if let Number::Finite(time) = number(text, comma) {
            self.first_time.get_or_insert((frame, time));
            self.last_time = Some((frame, time));
        }
    }

    fn tell(&self, rate_hz: f64, warnings: &mut Vec<TrackWarning>) {
        if self.jumps > 0 {
            warnings.push(TrackWarning::FrameJumps {
                jumps: self.jumps,
                frames: self.skipped,
            });
        }
        if let Some((count, first_line)) = self.half_blank {
            warnings.push(TrackWarning::HalfBlank { count, first_line });
        }
        if let (Some((f0, t0)), Some((f1, t1))) = (self.first_time, self.last_time) {
            let (frames, time) = ((f1 - f0) as f64, t1 - t0);
            // Two rounded times may be 1e-6 s off each, whatever the span.
            if f1 > f0 && (time - frames / rate_hz).abs() > 2e-6 + 1e-3 * frames / rate_hz {
                warnings.push(TrackWarning::TimeColumn {
                    header_hz: rate_hz,
                    column_hz: frames / time,
                });
            }
        }
    }
}
