//! Text of Tracker, the video tool: one track under its name, several under `#multi:`, or exports pasted side by side, each with
//! times of its own. The unit of length is known only to the user: Tracker writes the one of its calibration stick.

use std::ops::Range;
use std::path::Path;

use super::cells::{Cell, Cells, cell_at, split};
use super::grid::{self, Body, Clock, Columns, Grid, decimals, may_be_cut, row_length};
use super::lines::{Delimiter, Lines, TextLine};
use super::merged::{TimedPose, merged};
use super::number::Decimals;
use super::rows::{TakesRows, read_rows};
use super::timeline::Timeline;
use super::{
    Draft, FilePosition, PointKind, Reading, TrackError, TrackFormat, TrackPoint, TrackProblem,
    TrackWarning, Unit,
};

/// Columns of one track, and what they said.
struct Track {
    name: String,
    time: usize,
    /// x and y; `None` for a track of other quantities.
    place: Option<[usize; 2]>,
    /// With the row that it was on.
    seen: Vec<(usize, TimedPose)>,
}

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    delimiter: Delimiter,
) -> Result<Draft, TrackError> {
    let Reading { file, options, .. } = *reading;
    let (unit, metres, _) = options.unit(Unit::Unknown);
    let mut reader = Reader::begin(lines, reading, delimiter)?;
    if let [(time, _)] = reader.clocks[..] {
        // One clock: rows as in any table, which go by without being kept.
        let warnings = std::mem::take(&mut reader.warnings);
        return Ok(Draft {
            format: TrackFormat::Tracker,
            rate_hz: None,
            unit,
            image: false,
            body: grid::read(lines, reading, reader.grid(time, metres))?,
            warnings,
        });
    }
    let header_line = reader.header_line;
    let cut = read_rows(lines, file, header_line, &mut reader)?;
    reader.warnings.extend(cut);
    if let Some((count, first_line)) = reader.half_blank {
        let warning = TrackWarning::HalfBlank { count, first_line };
        reader.warnings.push(warning);
    }
    Ok(Draft {
        format: TrackFormat::Tracker,
        rate_hz: None,
        unit,
        image: false,
        body: body(reader.timeline, reader.tracks, metres, reader.together),
        warnings: reader.warnings,
    })
}

/// Tracks whose clocks agree in every row have rows as they stand; else one row for each time that any track has.
fn body(timeline: Timeline, tracks: Vec<Track>, metres: f64, together: bool) -> Body {
    if !together {
        let of = |track: Track| {
            let seen = track.seen.into_iter().map(|(_, seen)| seen);
            (track.name, seen.collect())
        };
        return merged(
            timeline.emptied(),
            tracks.into_iter().map(of).collect(),
            metres,
        );
    }
    let points = tracks.into_iter().map(|track| {
        let mut point = TrackPoint::new(track.name, PointKind::Marker, String::new(), Vec::new());
        for (row, seen) in track.seen {
            point.push(row, seen.place.map(|value| value * metres));
        }
        point.finish(timeline.len());
        point
    });
    Body {
        points: points.collect(),
        timeline,
        warnings: Vec::new(),
        rate_hz: None,
    }
}

struct Reader<'f> {
    file: &'f Path,
    delimiter: Delimiter,
    decimals: Decimals,
    header_line: usize,
    width: usize,
    /// Columns of times, each with its last one.
    clocks: Vec<(usize, f64)>,
    tracks: Vec<Track>,
    warnings: Vec<TrackWarning>,
    cells: Cells,
    /// Times of the rows, by the first clock that has one.
    timeline: Timeline,
    /// `true` while all clocks agree in every row.
    together: bool,
    last_decimals: usize,
    extent: Option<usize>,
    half_blank: Option<(usize, usize)>,
}

impl TakesRows for Reader<'_> {
    fn take_line(&mut self, line: &TextLine<'_>) -> Result<(), TrackError> {
        self.row(line)
    }

    fn has_rows(&self) -> bool {
        self.timeline.len() > 0
    }
}

impl<'f> Reader<'f> {
    /// Reads names and columns.
    fn begin(
        lines: &Lines<'_>,
        reading: &Reading<'f>,
        delimiter: Delimiter,
    ) -> Result<Self, TrackError> {
        let file = reading.file;
        let multi = |line: &TextLine<'_>| line.text.to_ascii_lowercase().starts_with("#multi:");
        let mut rows = lines.head().filter(|line| !line.is_blank() && !multi(line));
        let (Some(names), Some(titles)) = (rows.next(), rows.next()) else {
            return Err(TrackError::Broken {
                place: FilePosition {
                    file: file.to_owned(),
                    line: 2,
                    column: 1,
                },
                problem: TrackProblem::NoHeaderRow { row: "`t x y`" },
            });
        };
        let name_cells = split(&names, delimiter, file)?;
        let mut cells = split(&titles, delimiter, file)?;
        while cells.last().is_some_and(|cell| cell.raw.is_empty()) {
            cells.pop();
        }
        let mut reader = Self {
            file,
            delimiter,
            decimals: if delimiter.allows_decimal_comma() {
                Decimals::Open
            } else {
                Decimals::Point
            },
            header_line: titles.number,
            width: cells.len(),
            clocks: Vec::new(),
            tracks: Vec::new(),
            warnings: Vec::new(),
            cells: Cells::default(),
            timeline: Timeline::new(reading.keeps_places),
            together: true,
            last_decimals: 0,
            extent: None,
            half_blank: None,
        };
        let starts: Vec<usize> = (0..name_cells.len())
            .filter(|column| !cell_at(&name_cells, *column).raw.is_empty())
            .collect();
        for (index, start) in starts.iter().copied().enumerate() {
            let end = starts.get(index + 1).copied().unwrap_or(cells.len());
            let name = cell_at(&name_cells, start).text().into_owned();
            reader.track(name, start..end, &cells, &titles)?;
        }
        if reader.tracks.is_empty() {
            return Err(names.error(file, 0, TrackProblem::NoPoints));
        }
        Ok(reader)
    }

    /// The same as a table of one clock.
    fn grid(&mut self, time: usize, metres: f64) -> Grid {
        let tracks = std::mem::take(&mut self.tracks);
        let columns = tracks.iter().map(|track| Columns {
            axes: track
                .place
                .map_or([None; 3], |[x, y]| [Some(x), Some(y), None]),
            likelihood: None,
            rotation: None,
        });
        let columns = columns.collect();
        let point = |track: Track| {
            TrackPoint::new(track.name, PointKind::Marker, String::new(), Vec::new())
        };
        let points = tracks.into_iter().map(point).collect();
        Grid {
            clock: Clock::Stamped {
                time,
                seconds: 1.0,
                frame: None,
            },
            metres,
            columns,
            ..Grid::under(self.header_line, self.delimiter, self.width, points)
        }
    }

    fn track(
        &mut self,
        name: String,
        range: Range<usize>,
        cells: &[Cell<'_>],
        line: &TextLine<'_>,
    ) -> Result<(), TrackError> {
        let find = |title: &str| {
            range
                .clone()
                .find(|column| cell_at(cells, *column).is(title))
        };
        // Tracks under `#multi:` share the first column's time.
        let shared = cells.first().filter(|cell| cell.is("t")).map(|_| 0);
        let Some(time) = find("t").or(shared) else {
            return Err(line.error(self.file, 0, TrackProblem::NoTime));
        };
        if self.clocks.iter().all(|(column, _)| *column != time) {
            self.clocks.push((time, f64::NEG_INFINITY));
        }
        let place = match (find("x"), find("y")) {
            (Some(x), Some(y)) => Some([x, y]),
            (None, None) => {
                let titles = range.filter_map(|column| cells.get(column).map(|cell| cell.raw));
                let titles: Vec<&str> = titles.filter(|title| !title.is_empty()).collect();
                self.warnings.push(TrackWarning::NoPositions {
                    track: name.clone(),
                    columns: titles.join(", "),
                });
                None
            }
            (x, _) => {
                let axis = if x.is_some() { 'y' } else { 'x' };
                let problem = TrackProblem::MissingAxis { point: name, axis };
                return Err(line.error(self.file, 0, problem));
            }
        };
        self.tracks.push(Track {
            name,
            time,
            place,
            seen: Vec::new(),
        });
        Ok(())
    }

    /// A row, taken whole or not at all.
    fn row(&mut self, line: &TextLine<'_>) -> Result<(), TrackError> {
        self.cells.split(line, self.delimiter, self.file)?;
        row_length(line, &self.cells, self.width, &mut self.extent, self.file)?;
        let mut stamps = Vec::with_capacity(self.clocks.len());
        for index in 0..self.clocks.len() {
            let Some((column, previous)) = self.clocks.get(index).copied() else {
                continue;
            };
            let stamp = self.value(line, column, "time")?;
            let text = self.cells.at(line, column).raw;
            self.timeline.written(text, 1.0);
            let rounded = self.together && self.timeline.may_repeat();
            let wrong = |time: &f64| *time < previous || (*time <= previous && !rounded);
            if let Some(time) = stamp.filter(wrong) {
                let at = self.cells.at(line, column).at;
                let problem = TrackProblem::TimeOrder { previous, time };
                return Err(line.error(self.file, at, problem));
            }
            stamps.push(stamp);
        }
        let mut places = Vec::with_capacity(self.tracks.len());
        let mut half_blank = false;
        for index in 0..self.tracks.len() {
            let Some(Track {
                time,
                place: Some([x, y]),
                ..
            }) = self.tracks.get(index)
            else {
                places.push(None);
                continue;
            };
            let (time, x, y) = (*time, *x, *y);
            let stamp = self.clocks.iter().position(|(column, _)| *column == time);
            let stamp = stamp.and_then(|clock| stamps.get(clock).copied().flatten());
            let place = (self.value(line, x, "x")?, self.value(line, y, "y")?);
            places.push(match (stamp, place) {
                (Some(time_s), (Some(x), Some(y))) => Some(TimedPose {
                    time_s,
                    place: [x, y, 0.0],
                    turn: None,
                }),
                (None | Some(_), (None, None)) => None,
                (Some(_), _) => {
                    half_blank = true;
                    None
                }
                (None, _) => {
                    let problem = TrackProblem::NotANumber {
                        text: String::new(),
                        cell: "time".to_owned(),
                    };
                    let at = self.cells.at(line, time).at;
                    return Err(line.error(self.file, at, problem));
                }
            });
        }
        let decimals = decimals(self.cells.last(line).map_or("", |cell| cell.raw));
        let first = self.timeline.len() == 0;
        may_be_cut(line, first || decimals < self.last_decimals, self.file)?;
        self.last_decimals = decimals;
        if half_blank {
            self.half_blank.get_or_insert((0, line.number)).0 += 1;
        }
        for ((_, last), stamp) in self.clocks.iter_mut().zip(&stamps) {
            *last = stamp.unwrap_or(*last);
        }
        let mut stamps = stamps.into_iter().flatten();
        let row = self.timeline.len();
        if let Some(time) = stamps.next() {
            self.together &= stamps.all(|other| (other - time).abs() < 1e-9);
            if self.timeline.last().is_some_and(|(_, last)| time <= last) {
                self.timeline.repeats(line.number);
            }
            self.timeline.push(row as u64, time);
        }
        for (track, place) in self.tracks.iter_mut().zip(places) {
            track.seen.extend(place.map(|place| (row, place)));
        }
        Ok(())
    }

    fn value(
        &mut self,
        line: &TextLine<'_>,
        column: usize,
        what: &str,
    ) -> Result<Option<f64>, TrackError> {
        let cell = self.cells.at(line, column);
        self.decimals.cell(&cell, (line, self.file), what)
    }
}
