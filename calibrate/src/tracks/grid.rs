//! Rows of a clock and positions under a header that has been read: what most formats are below their first lines, and the
//! hot loop of reading.

mod nearby;
mod notes;

use std::path::Path;

use super::cells::{Cell, Cells};
use super::lines::{Delimiter, Lines, TextLine};
use super::number::{Decimals, Number};
use super::rotation::Rotation;
use super::rows::{TakesRows, read_rows};
use super::stamp::{self, Stamp};
use super::timeline::Timeline;
use super::{Reading, TrackError, TrackPoint, TrackProblem, TrackWarning};
use nearby::Nearby;
pub(super) use notes::ColumnClock;
use notes::Notes;

/// Largest angle that passes for radians if nothing says the unit.
pub(super) const LARGEST_ANGLE: f64 = 2.0 * std::f64::consts::PI + 1e-3;

/// Source of a row's time.
#[derive(Debug, Clone, Copy)]
pub(super) enum Clock {
    /// Frame number over rate: the time column is rounded, and is only compared with it.
    Numbered {
        frame: usize,
        /// The frame number at time zero.
        first: u64,
        rate_hz: f64,
        time: Option<usize>,
    },
    /// Stamps of a time column, with the seconds in its unit.
    Stamped {
        time: usize,
        seconds: f64,
        frame: Option<usize>,
    },
    /// One row after another.
    Counted { rate_hz: f64 },
}

/// Columns of one point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns {
    /// x, y and perhaps z.
    pub(super) axes: [Option<usize>; 3],
    /// Column of the tracker's likelihood.
    pub(super) likelihood: Option<usize>,
    /// The body's orientation.
    pub(super) rotation: Option<Rotation>,
}

impl Columns {
    pub(super) fn of(axes: [usize; 3]) -> Self {
        Self {
            axes: axes.map(Some),
            likelihood: None,
            rotation: None,
        }
    }
}

/// Layout of the rows below a header.
#[allow(clippy::struct_excessive_bools)] // independent properties of formats
pub(super) struct Grid {
    pub(super) delimiter: Delimiter,
    /// Cells in a row; blank ones may follow.
    pub(super) width: usize,
    /// The header's last line, which the rows follow; 0 where there is no header.
    pub(super) header_line: usize,
    pub(super) clock: Clock,
    /// Metres per unit; 1 if it is unknown.
    pub(super) metres: f64,
    pub(super) points: Vec<TrackPoint>,
    /// For each point.
    pub(super) columns: Vec<Columns>,
    /// The least likelihood that counts.
    pub(super) likelihood: f64,
    /// `true` if a point at the very origin is a missing one (QTM).
    pub(super) origin_is_missing: bool,
    /// `true` if lines that begin with # or % are comments.
    pub(super) comments: bool,
    /// `true` if a blank line ends the section (Vicon).
    pub(super) section: bool,
    /// `true` if no unit of angles is stated, so that one beyond a whole turn is not taken for radians.
    pub(super) short_angles: bool,
}

impl Grid {
    /// Rows that follow this line, with nothing particular about them; one row after another until a clock is put in.
    pub(super) fn under(
        header_line: usize,
        delimiter: Delimiter,
        width: usize,
        points: Vec<TrackPoint>,
    ) -> Self {
        Self {
            delimiter,
            width,
            header_line,
            clock: Clock::Counted { rate_hz: 1.0 },
            metres: 1.0,
            points,
            columns: Vec::new(),
            likelihood: 0.0,
            origin_is_missing: false,
            comments: false,
            section: false,
            short_angles: false,
        }
    }
}

/// The rows, read.
pub(super) struct Body {
    pub(super) timeline: Timeline,
    pub(super) points: Vec<TrackPoint>,
    pub(super) warnings: Vec<TrackWarning>,
    /// The rate by the time column, if the header's is wrong.
    pub(super) rate_hz: Option<f64>,
}

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    mut grid: Grid,
) -> Result<Body, TrackError> {
    let file = reading.file;
    let used = reading.options.used.as_ref();
    for point in &mut grid.points {
        let needed = used.is_none_or(|used| used.may_need(point));
        point.keep_places(reading.keeps_places && needed);
    }
    let nearby = Nearby::new(used, &grid.points, grid.metres);
    let rate_is_given = reading.options.rate().is_some();
    let mut reader = Reader {
        decimals: Decimals::of(grid.delimiter),
        file,
        places: vec![None; grid.points.len()],
        turns: vec![None; grid.points.len()],
        cells: Cells::default(),
        notes: Notes::default(),
        body: Body {
            timeline: Timeline::new(reading.keeps_places),
            points: Vec::new(),
            warnings: Vec::new(),
            rate_hz: None,
        },
        stamps_from: None,
        rate_is_given,
        last_decimals: 0,
        extent: None,
        first_day: None,
        nearby: nearby.filter(|_| reading.keeps_places),
        grid,
    };
    let header_line = reader.grid.header_line;
    let cut = read_rows(lines, file, header_line, &mut reader)?;
    reader.body.warnings.extend(cut);
    Ok(reader.finish())
}

struct Reader<'f> {
    grid: Grid,
    file: &'f Path,
    decimals: Decimals,
    cells: Cells,
    places: Vec<Option<[f64; 3]>>,
    turns: Vec<Option<[f64; 4]>>,
    notes: Notes,
    body: Body,
    /// Failure of the frame numbers: a stamp and the time assigned to it. From there on stamps count.
    stamps_from: Option<(f64, f64)>,
    /// `true` if the rate is the user's, from which the time column may differ.
    rate_is_given: bool,
    last_decimals: usize,
    extent: Option<usize>,
    /// The day of the first stamp that is a date.
    first_day: Option<i64>,
    /// Places to keep; `None` keeps all.
    nearby: Option<Nearby>,
}

impl TakesRows for Reader<'_> {
    fn take_line(&mut self, line: &TextLine<'_>) -> Result<(), TrackError> {
        if self.grid.comments && line.text.trim_start().starts_with(['#', '%']) {
            return Ok(());
        }
        self.row(line)
    }

    fn has_rows(&self) -> bool {
        self.body.timeline.len() > 0
    }

    fn ends_at_blank(&self) -> bool {
        self.grid.section
    }
}

impl Reader<'_> {
    /// A row, taken whole or not at all.
    fn row(&mut self, line: &TextLine<'_>) -> Result<(), TrackError> {
        self.cells.split(line, self.grid.delimiter, self.file)?;
        row_length(
            line,
            &self.cells,
            self.grid.width,
            &mut self.extent,
            self.file,
        )?;
        let (frame, time) = self.clock(line)?;
        let mut places = std::mem::take(&mut self.places);
        let mut turns = std::mem::take(&mut self.turns);
        for (index, (place, turn)) in places.iter_mut().zip(&mut turns).enumerate() {
            *place = self.place(line, index)?;
            if place.is_some() {
                *turn = self.turn(line, index)?;
            }
        }
        let decimals = decimals(self.cells.last(line).map_or("", |cell| cell.raw));
        let first = self.body.timeline.len() == 0;
        may_be_cut(line, first || decimals < self.last_decimals, self.file)?;
        self.last_decimals = decimals;
        let row = self.body.timeline.len();
        if let (Some((previous, _)), Clock::Numbered { .. }) =
            (self.body.timeline.last(), self.grid.clock)
        {
            self.notes.jumped(frame.saturating_sub(previous + 1));
        }
        self.body.timeline.push(frame, time);
        let keeps = self.nearby.as_mut().map(|nearby| nearby.keep(&places));
        let cells = places.iter().zip(&turns).enumerate();
        for (point, (index, (place, turn))) in self.grid.points.iter_mut().zip(cells) {
            let Some(place) = place else { continue };
            let place = place.map(|value| value * self.grid.metres);
            let kept = keeps.is_none_or(|keeps| keeps.get(index).copied().unwrap_or(true));
            if kept {
                point.push_pose(row, place, *turn);
            } else {
                point.count(row);
            }
        }
        (self.places, self.turns) = (places, turns);
        Ok(())
    }

    fn clock(&mut self, line: &TextLine<'_>) -> Result<(u64, f64), TrackError> {
        let row = self.body.timeline.len() as u64;
        let (frame, time) = match self.grid.clock {
            Clock::Counted { rate_hz } => return Ok((row, row as f64 / rate_hz)),
            Clock::Numbered {
                frame,
                first,
                rate_hz,
                time,
            } => {
                let number = self.frame(line, frame)?;
                let stamp = time.and_then(|time| self.cells.text(line, time));
                let stamp = match stamp.map(|text| self.decimals.number(text)) {
                    Some(Number::Finite(stamp)) => Some(stamp),
                    _ => None,
                };
                let before = self.notes.last_stamp();
                self.grows(line, number, stamp.zip(before))?;
                if let Some(stamp) = stamp {
                    self.notes.time(number, stamp);
                }
                match (self.stamps_from, stamp) {
                    (Some((from, at)), Some(stamp)) => (number, at + stamp - from),
                    _ => (number, (number as f64 - first as f64) / rate_hz),
                }
            }
            Clock::Stamped {
                time,
                seconds,
                frame,
            } => {
                let cell = self.cells.at(line, time);
                let stamp = match self.decimals.number(cell.raw) {
                    Number::Finite(stamp) => {
                        self.body.timeline.written(cell.raw, seconds);
                        stamp * seconds
                    }
                    _ => self.shown(line, &cell)?,
                };
                let number = frame.map_or(Ok(row), |column| self.frame(line, column))?;
                (number, stamp)
            }
        };
        if let Some((_, previous)) = self.body.timeline.last()
            && time <= previous
        {
            // Rounded stamps may be equal; whether these are, all of them together say.
            if time >= previous && self.body.timeline.may_repeat() {
                self.body.timeline.repeats(line.number);
                return Ok((frame, time));
            }
            let problem = TrackProblem::TimeOrder { previous, time };
            return Err(line.error(self.file, 0, problem));
        }
        Ok((frame, time))
    }

    /// A time as a clock shows it, in seconds from midnight of the first row's day.
    fn shown(&mut self, line: &TextLine<'_>, cell: &Cell<'_>) -> Result<f64, TrackError> {
        let Some(stamp) = Stamp::parse(cell.raw) else {
            let problem = TrackProblem::NotANumber {
                text: cell.text().into_owned(),
                cell: "time".to_owned(),
            };
            return Err(line.error(self.file, cell.at, problem));
        };
        let day = *self.first_day.get_or_insert(stamp.day.unwrap_or(0));
        self.body.timeline.written(stamp::digits(cell.raw), 1.0);
        Ok(stamp.since(day))
    }

    /// That a frame number grows, or that at least its stamp does, after the one of the row before.
    fn grows(
        &mut self,
        line: &TextLine<'_>,
        frame: u64,
        stamps: Option<(f64, f64)>,
    ) -> Result<(), TrackError> {
        let Some((previous, time)) = self.body.timeline.last() else {
            return Ok(());
        };
        if frame > previous {
            return Ok(());
        }
        match stamps {
            Some((stamp, before)) if stamp > before => {
                self.stamps_from.get_or_insert((before, time));
                self.body.timeline.renumbered(line.number);
                Ok(())
            }
            _ => Err(line.error(self.file, 0, TrackProblem::FrameOrder { previous, frame })),
        }
    }

    fn frame(&self, line: &TextLine<'_>, column: usize) -> Result<u64, TrackError> {
        let cell = self.cells.at(line, column);
        cell.raw.parse().map_err(|_| {
            let text = cell.text().into_owned();
            line.error(self.file, cell.at, TrackProblem::NotAFrameNumber { text })
        })
    }

    fn place(&mut self, line: &TextLine<'_>, index: usize) -> Result<Option<[f64; 3]>, TrackError> {
        let Some(columns) = self.grid.columns.get(index).copied() else {
            return Ok(None);
        };
        let mut place = [0.0; 3];
        let (mut blank, mut asked) = (0, 0);
        for (axis, value) in place.iter_mut().enumerate() {
            let Some(column) = columns.axes.get(axis).copied().flatten() else {
                continue;
            };
            asked += 1;
            match self
                .decimals
                .number(self.cells.text(line, column).unwrap_or(""))
            {
                Number::Finite(finite) => *value = finite,
                Number::Missing => blank += 1,
                Number::Wrong => return Err(self.not_a_number(line, column, index, axis)),
            }
        }
        if blank > 0 || asked == 0 {
            if 0 < blank && blank < asked {
                self.notes.half_blank(line.number);
            }
            return Ok(None);
        }
        if let Some(column) = columns.likelihood {
            match self
                .decimals
                .number(self.cells.text(line, column).unwrap_or(""))
            {
                Number::Finite(value) if value >= self.grid.likelihood => {}
                Number::Wrong => return Err(self.not_a_number(line, column, index, 3)),
                _ => {
                    self.notes.unlikely += 1;
                    return Ok(None);
                }
            }
        }
        let at_origin = place.iter().all(|value| *value == 0.0);
        Ok((!(self.grid.origin_is_missing && at_origin)).then_some(place))
    }

    /// The point's orientation, if its columns say one.
    fn turn(&mut self, line: &TextLine<'_>, index: usize) -> Result<Option<[f64; 4]>, TrackError> {
        let columns = self.grid.columns.get(index);
        let Some(rotation) = columns.and_then(|columns| columns.rotation) else {
            return Ok(None);
        };
        rotation.read(|column| {
            let text = self.cells.text(line, column).unwrap_or("");
            let value = match self.decimals.number(text) {
                Number::Finite(value) => value,
                Number::Missing => return Ok(None),
                Number::Wrong => return Err(self.not_a_number(line, column, index, 4)),
            };
            if self.grid.short_angles
                && let Rotation::Yaw(_, radians) = rotation
                && (value * radians).abs() > LARGEST_ANGLE
            {
                let cell = self.cells.at(line, column);
                let text = cell.text().into_owned();
                return Err(line.error(self.file, cell.at, TrackProblem::AngleUnit { text }));
            }
            Ok(Some(value))
        })
    }

    fn not_a_number(
        &self,
        line: &TextLine<'_>,
        column: usize,
        index: usize,
        axis: usize,
    ) -> TrackError {
        let cell = self.cells.at(line, column);
        let point = self.grid.points.get(index);
        let named = point.and_then(|point| point.columns.get(axis)).cloned();
        let name = named.unwrap_or_else(|| {
            let what = [
                "Position X",
                "Position Y",
                "Position Z",
                "likelihood",
                "rotation",
            ];
            let point = point.map_or("", |point| &point.name);
            format!("{point}, {}", what.get(axis).unwrap_or(&""))
        });
        let problem = TrackProblem::NotANumber {
            text: cell.text().into_owned(),
            cell: name,
        };
        line.error(self.file, cell.at, problem)
    }

    fn finish(mut self) -> Body {
        let rows = self.body.timeline.len();
        for point in &mut self.grid.points {
            point.finish(rows);
        }
        let rate_hz = match self.grid.clock {
            Clock::Numbered { rate_hz, .. } if !self.rate_is_given => Some(rate_hz),
            _ => None,
        };
        let column = self
            .notes
            .tell(rate_hz, self.grid.likelihood, &mut self.body.warnings);
        // Where frame numbers failed, the column is the clock already.
        if let Some(clock) = column.filter(|_| self.stamps_from.is_none()) {
            self.body.timeline.follow(&clock);
            self.body.rate_hz = Some(clock.rate_hz);
        }
        Body {
            points: self.grid.points,
            ..self.body
        }
    }
}

/// Checks that a row has as many cells as the header and as the rows before it, blank ones included: a missing or extra cell
/// shifts all that follow.
pub(super) fn row_length(
    line: &TextLine<'_>,
    cells: &Cells,
    width: usize,
    extent: &mut Option<usize>,
    file: &Path,
) -> Result<(), TrackError> {
    let expected = if cells.len() < width || cells.any_from(line, width) {
        width
    } else {
        *extent.get_or_insert(cells.len())
    };
    if cells.len() == expected && cells.len() >= width {
        return Ok(());
    }
    let problem = TrackProblem::RowLength {
        cells: cells.len(),
        expected,
    };
    Err(line.error(file, line.text.len(), problem))
}

/// An error where the file ends in this row without a line's end, and it is shorter than it ought to be: its last number may
/// have lost digits.
pub(super) fn may_be_cut(
    line: &TextLine<'_>,
    shorter: bool,
    file: &Path,
) -> Result<(), TrackError> {
    if line.ended || !shorter {
        return Ok(());
    }
    Err(line.error(file, line.text.len(), TrackProblem::MayBeCut))
}

/// Number of characters after the decimal sign, with the exponent: programs write all numbers of a column alike.
pub(super) fn decimals(text: &str) -> usize {
    text.rsplit_once(['.', ','])
        .map_or(0, |(_, digits)| digits.len())
}
