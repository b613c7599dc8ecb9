//! A plain table with named columns (`t,x1,y1,x2,y2`): comma, semicolon, tab or spaces between them.
//!
//! * Time: a column `t`, `time`, `time_s`, `seconds`, `Time (Seconds)`, …; else `frame` together with [`TableOptions::rate_hz`].
//! * Points: columns whose names are the same but for one letter x, y or z at either end (`x1`/`y1` → `1`, `front_x`/`front_y`
//!   → `front`); a bare `x`/`y` is the point `x,y`. Other pairs are named by the caller ([`TableOptions::pairs`]).
//! * Unit: metres, unless a column's name ends in a unit (`x1_mm`, `x1 [cm]`) or the caller gives a scale.
//! * Blank or NaN is missing. Columns that belong to nothing are not read.

use std::path::Path;

use super::detect::TableLayout;
use super::lines::{Cell, Line, lines, split};
use super::number::{Number, number};
use super::{
    PointKind, TrackError, TrackFile, TrackFormat, TrackPoint, TrackProblem, TrackWarning, Unit,
};

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

/// Where the time comes from.
enum Clock {
    Time {
        column: usize,
        seconds: f64,
        frame: Option<usize>,
    },
    Frame {
        column: usize,
        rate_hz: f64,
    },
}

impl Clock {
    fn read(
        &self,
        cells: &[Cell<'_>],
        line: &Line<'_>,
        file: &Path,
        comma: bool,
        row: usize,
    ) -> Result<(u64, f64), TrackError> {
        let cell = |column: usize| {
            cells
                .get(column)
                .copied()
                .unwrap_or(Cell { raw: "", at: 0 })
        };
        let frame = |column| {
            let cell = cell(column);
            let wrong = || {
                line.error(
                    file,
                    cell.at,
                    TrackProblem::NotAFrameNumber {
                        text: cell.text().into_owned(),
                    },
                )
            };
            cell.raw.parse::<u64>().map_err(|_| wrong())
        };
        match self {
            Self::Frame { column, rate_hz } => {
                let frame = frame(*column)?;
                Ok((frame, frame as f64 / rate_hz))
            }
            Self::Time {
                column,
                seconds,
                frame: frame_column,
            } => {
                let cell = cell(*column);
                let Number::Finite(time) = number(cell.raw, comma) else {
                    let (text, name) = (cell.text().into_owned(), "time".to_owned());
                    return Err(line.error(
                        file,
                        cell.at,
                        TrackProblem::NotANumber { text, cell: name },
                    ));
                };
                Ok((frame_column.map_or(Ok(row as u64), frame)?, time * seconds))
            }
        }
    }
}

struct Header {
    width: usize,
    clock: Clock,
    unit: Unit,
    points: Vec<TrackPoint>,
    /// Two or three columns for each point.
    columns: Vec<Vec<usize>>,
}

/// A column's name, taken apart.
struct Name<'a> {
    whole: String,
    /// Without unit, as typed.
    bare: &'a str,
    unit: Option<&'a str>,
}

impl Header {
    fn read(
        line: Line<'_>,
        file: &Path,
        layout: &TableLayout,
        options: &TableOptions,
    ) -> Result<Self, TrackError> {
        let text = line.text.trim_start_matches([' ', '#', '%']);
        let shift = line.text.len() - text.len();
        let trimmed = Line { text, ..line };
        let mut cells = Vec::new();
        split(&trimmed, layout.delimiter, file, &mut cells)?;
        // A delimiter at the end of the header makes no column.
        while cells.last().is_some_and(|cell| cell.raw.is_empty()) {
            cells.pop();
        }
        let names: Vec<Name<'_>> = cells.iter().map(name).collect();
        let error = |column: usize, problem| {
            line.error(
                file,
                cells.get(column).map_or(0, |cell| cell.at + shift),
                problem,
            )
        };
        let clock = clock(&names, options).ok_or_else(|| error(0, TrackProblem::NoTime))?;
        let mut groups = Vec::new();
        for pair in &options.pairs {
            let find = |wanted: &String| {
                let found = names.iter().position(|name| name.whole == *wanted);
                let columns = || {
                    names
                        .iter()
                        .map(|name| name.whole.as_str())
                        .collect::<Vec<_>>()
                        .join(", ")
                };
                found.ok_or_else(|| {
                    error(
                        0,
                        TrackProblem::NoColumn {
                            name: wanted.clone(),
                            columns: columns(),
                        },
                    )
                })
            };
            groups.push((
                pair.join(","),
                pair.iter().map(find).collect::<Result<Vec<_>, _>>()?,
            ));
        }
        for (name, axes) in stems(&names, &error)? {
            match axes {
                [Some(x), Some(y), z] => {
                    let columns: Vec<usize> = [x, y].into_iter().chain(z).collect();
                    if !groups
                        .iter()
                        .any(|(_, taken)| taken.iter().eq(columns.iter().take(2)))
                    {
                        groups.push((name, columns));
                    }
                }
                [Some(x), None, _] => {
                    return Err(error(
                        x,
                        TrackProblem::MissingAxis {
                            point: name,
                            axis: 'y',
                        },
                    ));
                }
                [None, Some(y), _] => {
                    return Err(error(
                        y,
                        TrackProblem::MissingAxis {
                            point: name,
                            axis: 'x',
                        },
                    ));
                }
                // Anything may end in z.
                [None, None, _] => {}
            }
        }
        if groups.is_empty() {
            return Err(error(0, TrackProblem::NoPoints));
        }
        let unit = unit(&names, &groups, options, &error)?;
        let whole = |column: &usize| {
            names
                .get(*column)
                .map_or_else(String::new, |name| name.whole.clone())
        };
        let point = |(name, columns): &(String, Vec<usize>)| {
            TrackPoint::new(
                name.clone(),
                PointKind::Marker,
                String::new(),
                columns.iter().map(whole).collect(),
            )
        };
        Ok(Self {
            width: cells.len(),
            clock,
            unit,
            points: groups.iter().map(point).collect(),
            columns: groups.into_iter().map(|(_, columns)| columns).collect(),
        })
    }
}

fn name<'a>(cell: &Cell<'a>) -> Name<'a> {
    let raw = cell.raw;
    let cut = raw
        .strip_suffix([']', ')'])
        .and_then(|rest| rest.rsplit_once(['[', '(']));
    let cut = cut.or_else(|| {
        let (bare, unit) = raw.rsplit_once('_')?;
        matches!(
            unit,
            "m" | "mm" | "cm" | "px" | "pixel" | "pixels" | "s" | "ms" | "seconds"
        )
        .then_some((bare, unit))
    });
    let (bare, unit) = cut.map_or((raw, None), |(bare, unit)| (bare.trim_end(), Some(unit)));
    Name {
        whole: cell.text().into_owned(),
        bare,
        unit,
    }
}

fn clock(names: &[Name<'_>], options: &TableOptions) -> Option<Clock> {
    let find = |words: &[&str]| {
        names.iter().position(|name| {
            words
                .iter()
                .any(|word| name.bare.eq_ignore_ascii_case(word))
        })
    };
    let frame = find(&["frame", "frame#", "frames"]);
    if let Some(column) = find(&["t", "time", "seconds", "timestamp", "time_stamp"]) {
        let milliseconds = names
            .get(column)
            .is_some_and(|name| name.unit == Some("ms"));
        return Some(Clock::Time {
            column,
            seconds: if milliseconds { 1e-3 } else { 1.0 },
            frame,
        });
    }
    let rate_hz = options
        .rate_hz
        .filter(|rate| *rate > 0.0 && rate.is_finite())?;
    frame.map(|column| Clock::Frame { column, rate_hz })
}

type Stems = Vec<(String, [Option<usize>; 3])>;

/// Columns that share a name but for the axis letter, in the order of the file.
fn stems(
    names: &[Name<'_>],
    error: &impl Fn(usize, TrackProblem) -> TrackError,
) -> Result<Stems, TrackError> {
    let mut found: Stems = Vec::new();
    for (index, name) in names.iter().enumerate() {
        let Some((axis, stem)) = axis_and_stem(name.bare) else {
            continue;
        };
        let known = found.iter().position(|(known, _)| known == stem);
        let entry = known.unwrap_or_else(|| {
            found.push((stem.to_owned(), [None; 3]));
            found.len() - 1
        });
        let slot = found
            .get_mut(entry)
            .and_then(|(_, axes)| axes.get_mut(axis));
        if slot.is_some_and(|slot| slot.replace(index).is_some()) {
            return Err(error(
                index,
                TrackProblem::TwiceTheSameColumn {
                    name: name.whole.clone(),
                },
            ));
        }
    }
    for (stem, _) in found.iter_mut().filter(|(stem, _)| stem.is_empty()) {
        "x,y".clone_into(stem);
    }
    Ok(found)
}

/// `x1` → (0, `1`), `front_y` → (1, `front`), `Back X` → (0, `Back`). A letter inside a word (`box`) is no axis.
fn axis_and_stem(bare: &str) -> Option<(usize, &str)> {
    let axis = |letter: char| "xyz".find(letter.to_ascii_lowercase());
    let separators = [' ', '_', '.', '-', ':'];
    let mut chars = bare.chars();
    if let Some(index) = chars.next().and_then(axis) {
        let rest = chars.as_str();
        if rest.is_empty()
            || rest.starts_with(separators)
            || rest.starts_with(|c: char| c.is_ascii_digit())
        {
            return Some((index, rest.trim_start_matches(separators)));
        }
    }
    let mut chars = bare.chars();
    let index = chars.next_back().and_then(axis)?;
    let rest = chars.as_str();
    let ends = rest.ends_with(separators) || rest.ends_with(|c: char| c.is_ascii_digit());
    ends.then(|| (index, rest.trim_end_matches(separators)))
}

/// One unit for all columns with positions.
fn unit(
    names: &[Name<'_>],
    groups: &[(String, Vec<usize>)],
    options: &TableOptions,
    error: &impl Fn(usize, TrackProblem) -> TrackError,
) -> Result<Unit, TrackError> {
    if let Some(metres) = options
        .metres_per_unit
        .filter(|metres| metres.is_finite() && *metres > 0.0)
    {
        return Ok(Unit::Scaled(metres));
    }
    let mut unit = None;
    for index in groups
        .iter()
        .flat_map(|(_, columns)| columns.iter().copied())
    {
        let Some(name) = names.get(index) else {
            continue;
        };
        let named = match name.unit {
            None => Unit::Metre,
            Some(text) if text.starts_with("px") || text.starts_with("pixel") => {
                let (column, unit) = (name.whole.clone(), text.to_owned());
                return Err(error(index, TrackProblem::ScaleNeeded { column, unit }));
            }
            Some(text) => Unit::from_name(text).ok_or_else(|| {
                error(
                    index,
                    TrackProblem::UnknownUnit {
                        text: text.to_owned(),
                    },
                )
            })?,
        };
        if *unit.get_or_insert(named) != named {
            let text = format!("{named} beside another unit");
            return Err(error(index, TrackProblem::UnknownUnit { text }));
        }
    }
    Ok(unit.unwrap_or(Unit::Metre))
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
        let cell = cells
            .get(*column)
            .copied()
            .unwrap_or(Cell { raw: "", at: 0 });
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
