//! Tables with one row for each point in each frame (`frame,id,x,y`): markers by their number (ArUco), trackpy, the spots of
//! TrackMate. Rows stand in any order, so they are kept and sorted.

use std::collections::HashMap;

use super::header::Header;
use crate::tracks::cells::{Cell, Cells, split};
use crate::tracks::detect::TableLayout;
use crate::tracks::grid::{Clock, Columns, decimals, may_be_cut, row_length};
use crate::tracks::lines::{Lines, TextLine};
use crate::tracks::merged::{TimedPose, merged};
use crate::tracks::number::{Decimals, Number};
use crate::tracks::rows::{TakesRows, read_rows};
use crate::tracks::stamp::Stamp;
use crate::tracks::timeline::Timeline;
use crate::tracks::{Draft, Reading, TrackError, TrackFormat, TrackProblem, TrackWarning, Unit};

/// Lines below TrackMate's header: long names, short names, units.
const TRACKMATE_ROWS: usize = 3;

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    layout: &TableLayout,
    (header, id): (Header, usize),
) -> Result<Draft, TrackError> {
    let head: Vec<TextLine<'_>> = lines
        .head()
        .filter(|line| line.number >= layout.header_line)
        .collect();
    let titles = match head.first() {
        Some(line) => split(line, layout.delimiter, reading.file)?,
        None => Vec::new(),
    };
    let has = |name: &str| titles.iter().any(|cell| cell.is(name));
    let trackmate = has("POSITION_X") && has("TRACK_ID");
    let trackpy = has("particle");
    let mut spots = Spots {
        rows: 0,
        unit: None,
        clock: header.clock,
    };
    if trackmate {
        spots = Spots::read(&head, reading, layout, &header)?;
    } else if trackpy {
        spots.unit = Some(header.unit.unwrap_or(Unit::Pixel));
    }
    let clock = spots.clock;
    let image = trackmate || trackpy || header.unit == Some(Unit::Pixel);
    let own = spots.unit.or(header.unit);
    let (unit, metres, overridden) = reading.options.unit(own.unwrap_or(Unit::Metre));
    let rate_hz = match clock {
        Clock::Numbered { rate_hz, .. } => Some(rate_hz),
        _ => None,
    };
    let mut rows = LongRows {
        reading: *reading,
        layout: *layout,
        width: header.width,
        clock,
        columns: header
            .columns
            .first()
            .copied()
            .unwrap_or(Columns::of([0; 3])),
        short_angles: header.short_angles,
        id,
        decimals: Decimals::of(layout.delimiter),
        cells: Cells::default(),
        timeline: Timeline::new(reading.keeps_places),
        ids: HashMap::new(),
        tracks: Vec::new(),
        rows: 0,
        last_decimals: 0,
        extent: None,
        first_day: None,
        half_blank: None,
    };
    let after = layout.header_line + spots.rows;
    let cut = read_rows(lines, reading.file, after, &mut rows)?;
    let mut warnings: Vec<TrackWarning> = cut.into_iter().collect();
    warnings.extend(overridden.filter(|_| own.is_some()));
    if let Some((count, first_line)) = rows.half_blank {
        warnings.push(TrackWarning::HalfBlank { count, first_line });
    }
    for (_, seen) in &mut rows.tracks {
        seen.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    }
    rows.tracks.sort_by(|a, b| id_order(&a.0, &b.0));
    Ok(Draft {
        format: if trackmate {
            TrackFormat::TrackMate
        } else {
            TrackFormat::LongTable
        },
        rate_hz,
        unit,
        image,
        body: merged(rows.timeline, rows.tracks, metres),
        warnings,
    })
}

/// Lines below a header of TrackMate, with the unit and the clock that they state.
struct Spots {
    rows: usize,
    unit: Option<Unit>,
    clock: Clock,
}

impl Spots {
    /// # Errors
    /// Frame numbers without a rate.
    fn read(
        head: &[TextLine<'_>],
        reading: &Reading<'_>,
        layout: &TableLayout,
        header: &Header,
    ) -> Result<Self, TrackError> {
        let mut clock = header.clock;
        let rows = head.iter().skip(1).take(TRACKMATE_ROWS);
        let rows: Vec<Vec<Cell<'_>>> = rows
            .map_while(|line| split(line, layout.delimiter, reading.file).ok())
            .take_while(|cells| !cells.iter().any(|cell| is_id(cell)))
            .collect();
        // (pixel), (micron), (sec), (frame)
        let unit_of = |column: usize| {
            let cell = rows.last()?.get(column)?;
            Some(cell.raw.trim_matches(['(', ')']).to_lowercase())
        };
        let [x, ..] = header
            .columns
            .first()
            .map_or([None; 3], |columns| columns.axes);
        let text = x.and_then(unit_of).unwrap_or_else(|| "pixel".to_owned());
        let unit = match text.as_str() {
            "micron" | "microns" | "µm" | "um" => Unit::Scaled(1e-6),
            text => Unit::from_name(text).unwrap_or(Unit::Unknown),
        };
        if let Clock::Stamped { time, .. } = clock {
            let seconds = match unit_of(time).as_deref() {
                Some("sec" | "s" | "seconds" | "second") => Some(1.0),
                Some("ms" | "msec" | "millisecond" | "milliseconds") => Some(1e-3),
                Some("min" | "minute" | "minutes") => Some(60.0),
                _ => None,
            };
            clock = match seconds {
                Some(seconds) => Clock::Stamped {
                    time,
                    seconds,
                    frame: None,
                },
                // Frames, whatever they are called.
                None => Clock::Numbered {
                    frame: time,
                    first: 0,
                    rate_hz: reading
                        .options
                        .need_rate(head.first().unwrap_or(&NO_LINE), reading.file)?,
                    time: None,
                },
            };
        }
        Ok(Self {
            rows: rows.len(),
            unit: Some(unit),
            clock,
        })
    }
}

/// Stands for a header that is gone.
const NO_LINE: TextLine<'static> = TextLine {
    number: 1,
    text: "",
    ended: true,
};

/// TrackMate's label of a spot, `ID1234`: with it data begin.
fn is_id(cell: &Cell<'_>) -> bool {
    let digits = cell.raw.strip_prefix("ID").unwrap_or(cell.raw);
    !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())
}

/// Numbers by size, before names.
fn id_order(a: &str, b: &str) -> std::cmp::Ordering {
    let key = |id: &str| (id.parse::<u64>().unwrap_or(u64::MAX), id.to_owned());
    key(a).cmp(&key(b))
}

/// Rows of single points.
struct LongRows<'r> {
    reading: Reading<'r>,
    layout: TableLayout,
    width: usize,
    clock: Clock,
    columns: Columns,
    short_angles: bool,
    id: usize,
    decimals: Decimals,
    cells: Cells,
    timeline: Timeline,
    ids: HashMap<String, usize>,
    tracks: Vec<(String, Vec<TimedPose>)>,
    rows: usize,
    last_decimals: usize,
    extent: Option<usize>,
    first_day: Option<i64>,
    half_blank: Option<(usize, usize)>,
}

impl TakesRows for LongRows<'_> {
    fn take_line(&mut self, line: &TextLine<'_>) -> Result<(), TrackError> {
        if line.text.trim_start().starts_with(['#', '%']) {
            return Ok(());
        }
        let file = self.reading.file;
        self.cells.split(line, self.layout.delimiter, file)?;
        row_length(line, &self.cells, self.width, &mut self.extent, file)?;
        let time_s = self.time(line)?;
        if !time_s.is_finite() {
            let text = "inf".to_owned();
            let cell = "time".to_owned();
            return Err(line.error(file, 0, TrackProblem::NotANumber { text, cell }));
        }
        let mut place = [0.0; 3];
        let (mut blank, mut all) = (0, 0);
        for (value, column) in place.iter_mut().zip(self.columns.axes) {
            let Some(column) = column else { continue };
            all += 1;
            match self.value(line, column, "position")? {
                Some(found) => *value = found,
                None => blank += 1,
            }
        }
        let mut turn = None;
        if let Some(rotation) = self.columns.rotation {
            turn = rotation.read(|column| self.value(line, column, "rotation"))?;
            if self.short_angles
                && let Some(column) = rotation.columns().first()
                && self
                    .value(line, *column, "rotation")?
                    .is_some_and(|angle| angle.abs() > crate::tracks::grid::LARGEST_ANGLE)
            {
                let cell = self.cells.at(line, *column);
                let text = cell.text().into_owned();
                return Err(line.error(file, cell.at, TrackProblem::AngleUnit { text }));
            }
        }
        let decimals = decimals(self.cells.last(line).map_or("", |cell| cell.raw));
        may_be_cut(line, self.rows == 0 || decimals < self.last_decimals, file)?;
        self.last_decimals = decimals;
        self.rows += 1;
        if blank > 0 {
            if blank < all {
                self.half_blank.get_or_insert((0, line.number)).0 += 1;
            }
            return Ok(());
        }
        let id = self.cells.at(line, self.id);
        // A spot that belongs to no track.
        if id.raw.is_empty() || matches!(self.decimals.number(id.raw), Number::Missing) {
            return Ok(());
        }
        // pandas writes whole numbers next to blanks as 3.0.
        let name = id.raw.strip_suffix(".0").unwrap_or(id.raw);
        let known = self.ids.get(name).copied();
        let track = known.unwrap_or_else(|| {
            self.ids.insert(name.to_owned(), self.tracks.len());
            self.tracks.push((name.to_owned(), Vec::new()));
            self.tracks.len() - 1
        });
        if let Some((_, seen)) = self.tracks.get_mut(track) {
            seen.push(TimedPose {
                time_s,
                place,
                turn,
            });
        }
        Ok(())
    }

    fn has_rows(&self) -> bool {
        self.rows > 0
    }
}

impl LongRows<'_> {
    fn time(&mut self, line: &TextLine<'_>) -> Result<f64, TrackError> {
        let (column, seconds) = match self.clock {
            Clock::Numbered { frame, rate_hz, .. } => (frame, 1.0 / rate_hz),
            Clock::Stamped { time, seconds, .. } => (time, seconds),
            Clock::Counted { rate_hz } => return Ok(self.rows as f64 / rate_hz),
        };
        let cell = self.cells.at(line, column);
        if let Number::Finite(stamp) = self.decimals.number(cell.raw) {
            if matches!(self.clock, Clock::Stamped { .. }) {
                self.timeline.written(cell.raw, seconds);
            }
            return Ok(stamp * seconds);
        }
        let Some(stamp) = Stamp::parse(cell.raw) else {
            let problem = TrackProblem::NotANumber {
                text: cell.text().into_owned(),
                cell: "time".to_owned(),
            };
            return Err(line.error(self.reading.file, cell.at, problem));
        };
        let day = *self.first_day.get_or_insert(stamp.day.unwrap_or(0));
        Ok(stamp.since(day))
    }

    fn value(
        &mut self,
        line: &TextLine<'_>,
        column: usize,
        what: &str,
    ) -> Result<Option<f64>, TrackError> {
        let cell = self.cells.at(line, column);
        self.decimals.cell(&cell, (line, self.reading.file), what)
    }
}
