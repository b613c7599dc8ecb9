//! SLEAP's analysis CSV: `track,frame_idx,instance.score`, then `node.x,node.y,node.score` of each node; one row for each animal
//! in each frame. Pixels, y down. Nodes that SLEAP did not find are blank; a least score counts only if the user states one.

use std::collections::HashMap;
use std::path::Path;

use super::cells::{Cell, Cells, split};
use super::grid::{Body, decimals, may_be_cut, row_length};
use super::lines::{Delimiter, Lines, TextLine};
use super::number::Decimals;
use super::rows::{TakesRows, read_rows};
use super::timeline::Timeline;
use super::{
    Draft, PointKind, Reading, TrackError, TrackFormat, TrackPoint, TrackProblem, TrackWarning,
    Unit,
};

/// Columns of one node.
struct Node {
    name: String,
    place: [usize; 2],
    score: Option<usize>,
}

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    delimiter: Delimiter,
) -> Result<Draft, TrackError> {
    let file = reading.file;
    let empty = || TrackError::Empty {
        file: file.to_owned(),
    };
    let header = lines
        .head()
        .find(|line| !line.is_blank())
        .ok_or_else(empty)?;
    let cells = split(&header, delimiter, file)?;
    let find = |name: &str| cells.iter().position(|cell| cell.is(name));
    let frame = find("frame_idx").ok_or_else(|| header.error(file, 0, TrackProblem::NoTime))?;
    let mut nodes = Vec::new();
    for (column, cell) in cells.iter().enumerate() {
        let Some(name) = cell.raw.strip_suffix(".x") else {
            continue;
        };
        let Some(y) = find(&format!("{name}.y")) else {
            let point = name.to_owned();
            let problem = TrackProblem::MissingAxis { point, axis: 'y' };
            return Err(header.error(file, cell.at, problem));
        };
        nodes.push(Node {
            name: name.to_owned(),
            place: [column, y],
            score: find(&format!("{name}.score")),
        });
    }
    if nodes.is_empty() {
        return Err(header.error(file, 0, TrackProblem::NoPoints));
    }
    let rate_hz = reading.options.need_rate(&header, file)?;
    let (unit, metres, _) = reading.options.unit(Unit::Pixel);
    let mut instances = Instances {
        reading: *reading,
        delimiter,
        decimals: Decimals::of(delimiter),
        width: cells.len(),
        frame,
        track: find("track"),
        nodes,
        rate_hz,
        metres,
        cells: Cells::default(),
        extent: None,
        timeline: Timeline::new(reading.keeps_places),
        animals: HashMap::new(),
        points: Vec::new(),
        in_frame: 0,
        skipped: (0, 0),
        unlikely: 0,
        half_blank: None,
        last_decimals: 0,
    };
    let header_line = header.number;
    let cut = read_rows(lines, file, header_line, &mut instances)?;
    let mut warnings: Vec<TrackWarning> = cut.into_iter().collect();
    if let (jumps @ 1.., frames) = instances.skipped {
        warnings.push(TrackWarning::FrameJumps { jumps, frames });
    }
    if let Some((count, first_line)) = instances.half_blank {
        warnings.push(TrackWarning::HalfBlank { count, first_line });
    }
    if instances.unlikely > 0 {
        warnings.push(TrackWarning::Unlikely {
            count: instances.unlikely,
            threshold: reading.options.likelihood.unwrap_or(0.0),
        });
    }
    let rows = instances.timeline.len();
    for point in &mut instances.points {
        point.finish(rows);
    }
    Ok(Draft {
        format: TrackFormat::Sleap,
        rate_hz: Some(rate_hz),
        unit,
        image: true,
        body: Body {
            timeline: instances.timeline,
            points: instances.points,
            warnings: Vec::new(),
            rate_hz: None,
        },
        warnings,
    })
}

/// One animal after another, frame after frame.
struct Instances<'r> {
    reading: Reading<'r>,
    delimiter: Delimiter,
    decimals: Decimals,
    width: usize,
    frame: usize,
    track: Option<usize>,
    nodes: Vec<Node>,
    rate_hz: f64,
    metres: f64,
    cells: Cells,
    extent: Option<usize>,
    timeline: Timeline,
    /// The first point of each track, and the row that it was last in.
    animals: HashMap<String, (usize, usize)>,
    points: Vec<TrackPoint>,
    /// Animals without a track in this frame.
    in_frame: usize,
    /// Jumps, and frames that they leave out.
    skipped: (usize, u64),
    unlikely: usize,
    /// Number of positions without an axis, and the first line with one.
    half_blank: Option<(usize, usize)>,
    last_decimals: usize,
}

impl TakesRows for Instances<'_> {
    fn take_line(&mut self, line: &TextLine<'_>) -> Result<(), TrackError> {
        let file = self.reading.file;
        self.cells.split(line, self.delimiter, file)?;
        row_length(line, &self.cells, self.width, &mut self.extent, file)?;
        let cell = self.cells.at(line, self.frame);
        let frame: u64 = cell.raw.parse().map_err(|_| {
            let text = cell.text().into_owned();
            line.error(file, cell.at, TrackProblem::NotAFrameNumber { text })
        })?;
        let previous = self.timeline.last().map(|last| last.0);
        if let Some(previous) = previous.filter(|previous| frame < *previous) {
            return Err(line.error(file, cell.at, TrackProblem::FrameOrder { previous, frame }));
        }
        let mut places = Vec::with_capacity(self.nodes.len());
        for index in 0..self.nodes.len() {
            places.push(self.place(line, index)?);
        }
        let decimals = decimals(self.cells.last(line).map_or("", |cell| cell.raw));
        let shorter = previous.is_none() || decimals < self.last_decimals;
        may_be_cut(line, shorter, file)?;
        self.last_decimals = decimals;
        if previous != Some(frame) {
            let left_out = previous.map_or(0, |previous| frame - previous - 1);
            self.skipped.0 += usize::from(left_out > 0);
            self.skipped.1 += left_out;
            self.in_frame = 0;
            self.timeline.push(frame, frame as f64 / self.rate_hz);
        }
        let row = self.timeline.len() - 1;
        let Some(first) = self.animal(line, row) else {
            let previous = frame;
            return Err(line.error(file, 0, TrackProblem::FrameOrder { previous, frame }));
        };
        for (point, place) in self.points.iter_mut().skip(first).zip(places) {
            if let Some(place) = place {
                point.push(row, place.map(|value| value * self.metres));
            }
        }
        Ok(())
    }

    fn has_rows(&self) -> bool {
        self.timeline.len() > 0
    }
}

impl Instances<'_> {
    fn place(&mut self, line: &TextLine<'_>, node: usize) -> Result<Option<[f64; 3]>, TrackError> {
        let Some(Node { place, score, .. }) = self.nodes.get(node) else {
            return Ok(None);
        };
        let ([x, y], score) = (*place, *score);
        let (x, y) = (self.value(line, x)?, self.value(line, y)?);
        let score = score.map(|column| self.value(line, column)).transpose()?;
        let (Some(x), Some(y)) = (x, y) else {
            if x.is_some() || y.is_some() {
                self.half_blank.get_or_insert((0, line.number)).0 += 1;
            }
            return Ok(None);
        };
        let least = self.reading.options.likelihood.unwrap_or(0.0);
        if score.flatten().is_some_and(|score| score < least) {
            self.unlikely += 1;
            return Ok(None);
        }
        Ok(Some([x, y, 0.0]))
    }

    fn value(&mut self, line: &TextLine<'_>, column: usize) -> Result<Option<f64>, TrackError> {
        let cell = self.cells.at(line, column);
        self.decimals.cell(&cell, (line, self.reading.file), "node")
    }

    /// The first point of the row's animal; `None` if the animal was in this row before.
    fn animal(&mut self, line: &TextLine<'_>, row: usize) -> Option<usize> {
        let cell = self.track.map(|column| self.cells.at(line, column));
        let mut name = cell.map_or_else(String::new, |cell| cell.text().into_owned());
        if name.is_empty() {
            self.in_frame += 1;
            if self.in_frame > 1 {
                name = format!("instance {}", self.in_frame);
            }
        }
        if let Some((first, last_row)) = self.animals.get_mut(&name) {
            let new = std::mem::replace(last_row, row) != row;
            return new.then_some(*first);
        }
        let first = self.points.len();
        for node in &self.nodes {
            let called = if name.is_empty() {
                node.name.clone()
            } else {
                format!("{name}:{}", node.name)
            };
            let mut point = TrackPoint::new(called, PointKind::Marker, String::new(), Vec::new());
            point.keep_places(self.reading.keeps_places);
            self.points.push(point);
        }
        self.animals.insert(name, (first, row));
        Some(first)
    }
}

/// Returns `true` if these are the titles of such a table.
pub(super) fn is_header(line: &TextLine<'_>, delimiter: Delimiter, file: &Path) -> bool {
    let cells = split(line, delimiter, file).unwrap_or_default();
    let node = |cell: &Cell<'_>| cell.raw.strip_suffix(".x").is_some();
    cells.iter().any(|cell| cell.is("frame_idx")) && cells.iter().any(node)
}
