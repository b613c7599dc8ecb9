//! Kinovea's text of trajectories: `#Kinovea Trajectory data export`, then one section a track, `t x y` in each line, the
//! track's name in a comment above it (older versions: none, and times as `h:mm:ss:cc`). Its CSV is a plain table.

use super::cells::Cells;
use super::grid::{decimals, may_be_cut};
use super::lines::{Delimiter, Lines, TextLine};
use super::merged::{TimedPose, merged};
use super::number::{Decimals, Number};
use super::rows::{TakesRows, read_rows};
use super::timeline::Timeline;
use super::{Draft, Reading, TrackError, TrackFormat, TrackProblem, Unit};

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(lines: &mut Lines<'_>, reading: &Reading<'_>) -> Result<Draft, TrackError> {
    let (unit, metres, _) = reading.options.unit(Unit::Unknown);
    let mut sections = Sections {
        reading: *reading,
        cells: Cells::default(),
        decimals: Decimals::Open,
        timeline: Timeline::new(reading.keeps_places),
        tracks: Vec::new(),
        name: None,
        open: false,
        rows: 0,
        last_decimals: 0,
    };
    let cut = read_rows(lines, reading.file, 0, &mut sections)?;
    Ok(Draft {
        format: TrackFormat::Kinovea,
        rate_hz: None,
        unit,
        image: false,
        body: merged(sections.timeline, sections.tracks, metres),
        warnings: cut.into_iter().collect(),
    })
}

struct Sections<'r> {
    reading: Reading<'r>,
    cells: Cells,
    decimals: Decimals,
    timeline: Timeline,
    tracks: Vec<(String, Vec<TimedPose>)>,
    /// The comment that names the next section.
    name: Option<String>,
    /// `true` within a section.
    open: bool,
    rows: usize,
    last_decimals: usize,
}

impl TakesRows for Sections<'_> {
    fn take_line(&mut self, line: &TextLine<'_>) -> Result<(), TrackError> {
        if let Some(comment) = line.text.trim_start().strip_prefix('#') {
            self.name = Some(comment.trim().to_owned());
            self.open = false;
            return Ok(());
        }
        self.row(line)
    }

    fn has_rows(&self) -> bool {
        self.rows > 0
    }

    fn blank(&mut self) {
        self.open = false;
    }
}

impl Sections<'_> {
    fn row(&mut self, line: &TextLine<'_>) -> Result<(), TrackError> {
        let file = self.reading.file;
        self.cells.split(line, Delimiter::Spaces, file)?;
        if self.cells.len() != 3 {
            let problem = TrackProblem::RowLength {
                cells: self.cells.len(),
                expected: 3,
            };
            return Err(line.error(file, line.text.len(), problem));
        }
        let stamp = self.cells.at(line, 0).raw;
        let time = if let Some(time) = time_code(stamp) {
            self.timeline.written("0.00", 1.0);
            time
        } else {
            self.timeline.written(stamp, 1.0);
            self.number(line, 0, "time")?
        };
        let place = [self.number(line, 1, "x")?, self.number(line, 2, "y")?, 0.0];
        let decimals = decimals(self.cells.at(line, 2).raw);
        let shorter = self.rows == 0 || decimals < self.last_decimals;
        may_be_cut(line, shorter, file)?;
        self.last_decimals = decimals;
        if !self.open {
            let number = self.tracks.len() + 1;
            let name = self.name.take().filter(|name| !name.starts_with("T X Y"));
            let name = name.unwrap_or_else(|| format!("track {number}"));
            self.tracks.push((name, Vec::new()));
            self.open = true;
        }
        if let Some((_, seen)) = self.tracks.last_mut() {
            if let Some(previous) = seen
                .last()
                .map(|last| last.time_s)
                .filter(|last| time <= *last)
            {
                let problem = TrackProblem::TimeOrder { previous, time };
                return Err(line.error(file, 0, problem));
            }
            seen.push(TimedPose {
                time_s: time,
                place,
                turn: None,
            });
        }
        self.rows += 1;
        Ok(())
    }

    fn number(
        &mut self,
        line: &TextLine<'_>,
        column: usize,
        what: &str,
    ) -> Result<f64, TrackError> {
        let cell = self.cells.at(line, column);
        if let Number::Finite(value) = self.decimals.number(cell.raw) {
            return Ok(value);
        }
        let problem = TrackProblem::NotANumber {
            text: cell.text().into_owned(),
            cell: what.to_owned(),
        };
        Err(line.error(self.reading.file, cell.at, problem))
    }
}

/// `h:mm:ss:cc`, hundredths of a second last.
fn time_code(text: &str) -> Option<f64> {
    let mut parts = text.split(':').map(str::parse::<u32>);
    let mut next = || parts.next()?.ok().map(f64::from);
    let (hours, minutes, seconds, hundredths) = (next()?, next()?, next()?, next()?);
    Some(hours * 3600.0 + minutes * 60.0 + seconds + hundredths / 100.0)
}
