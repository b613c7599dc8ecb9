//! The header of a plain table: which column is the time, which are points, and in what unit.

use std::path::Path;

use crate::tracks::cells::{Cell, split};
use crate::tracks::detect::TableLayout;
use crate::tracks::grid::{Clock, Columns};
use crate::tracks::lines::Line;
use crate::tracks::{PointKind, TrackError, TrackOptions, TrackPoint, TrackProblem, Unit};

pub(super) struct Header {
    pub(super) width: usize,
    /// Whether the columns are called as Kinovea calls them (`Time`, `ball/0/X`).
    pub(super) kinovea: bool,
    pub(super) clock: Clock,
    /// The unit that the columns' names say; `None` where they say none.
    pub(super) unit: Option<Unit>,
    pub(super) points: Vec<TrackPoint>,
    /// For each point.
    pub(super) columns: Vec<Columns>,
}

/// A column's name, taken apart.
struct Name<'a> {
    whole: String,
    /// Without unit, as typed.
    bare: &'a str,
    unit: Option<&'a str>,
}

impl Header {
    pub(super) fn read(
        line: Line<'_>,
        file: &Path,
        layout: &TableLayout,
        options: &TrackOptions,
    ) -> Result<Self, TrackError> {
        let text = line.text.trim_start_matches([' ', '#', '%']);
        let shift = line.text.len() - text.len();
        let trimmed = Line { text, ..line };
        let mut cells = split(&trimmed, layout.delimiter, file)?;
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
        let clock = clock(&names, options).map_err(|problem| error(0, problem))?;
        let mut groups = pairs(&names, options, &error)?;
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
        let unit = unit(&names, &groups, &error)?;
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
        let kinovea = names.first().is_some_and(|name| name.whole == "Time")
            && names
                .iter()
                .skip(1)
                .all(|name| name.whole.ends_with("/X") || name.whole.ends_with("/Y"));
        Ok(Self {
            width: cells.len(),
            kinovea,
            clock,
            unit,
            points: groups.iter().map(point).collect(),
            columns: groups
                .into_iter()
                .map(|(_, columns)| places(&columns))
                .collect(),
        })
    }
}

/// The points that the user named by their columns.
fn pairs(
    names: &[Name<'_>],
    options: &TrackOptions,
    error: &impl Fn(usize, TrackProblem) -> TrackError,
) -> Result<Vec<(String, Vec<usize>)>, TrackError> {
    let find = |wanted: &String| {
        let found = names.iter().position(|name| name.whole == *wanted);
        found.ok_or_else(|| {
            let columns: Vec<&str> = names.iter().map(|name| name.whole.as_str()).collect();
            let problem = TrackProblem::NoColumn {
                name: wanted.clone(),
                columns: columns.join(", "),
            };
            error(0, problem)
        })
    };
    let pair = |pair: &[String; 2]| {
        let columns = pair.iter().map(find).collect::<Result<Vec<_>, _>>()?;
        Ok((pair.join(","), columns))
    };
    options.pairs.iter().map(pair).collect()
}

fn places(columns: &[usize]) -> Columns {
    Columns {
        axes: [0, 1, 2].map(|axis| columns.get(axis).copied()),
        likelihood: None,
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

fn clock(names: &[Name<'_>], options: &TrackOptions) -> Result<Clock, TrackProblem> {
    let find = |words: &[&str]| {
        names.iter().position(|name| {
            words
                .iter()
                .any(|word| name.bare.eq_ignore_ascii_case(word))
        })
    };
    let frame = find(&["frame", "frame#", "frames"]);
    if let Some(time) = find(&["t", "time", "seconds", "timestamp", "time_stamp"]) {
        let milliseconds = names.get(time).is_some_and(|name| name.unit == Some("ms"));
        return Ok(Clock::Stamped {
            time,
            seconds: if milliseconds { 1e-3 } else { 1.0 },
            frame,
        });
    }
    let frame = frame.ok_or(TrackProblem::NoTime)?;
    Ok(Clock::Numbered {
        frame,
        first: 0,
        rate_hz: options.rate().ok_or(TrackProblem::NoRate)?,
        time: None,
    })
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
    let separators = [' ', '_', '.', '-', ':', '/'];
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

/// One unit for all columns with positions, where their names say one.
fn unit(
    names: &[Name<'_>],
    groups: &[(String, Vec<usize>)],
    error: &impl Fn(usize, TrackProblem) -> TrackError,
) -> Result<Option<Unit>, TrackError> {
    let mut unit: Option<Option<Unit>> = None;
    for index in groups
        .iter()
        .flat_map(|(_, columns)| columns.iter().copied())
    {
        let Some(name) = names.get(index) else {
            continue;
        };
        let named = match name.unit {
            None => None,
            Some(text) => Some(Unit::from_name(text).ok_or_else(|| {
                let text = text.to_owned();
                error(index, TrackProblem::UnknownUnit { text })
            })?),
        };
        if *unit.get_or_insert(named) != named {
            let text = format!("{} beside another unit", name.unit.unwrap_or("none"));
            return Err(error(index, TrackProblem::UnknownUnit { text }));
        }
    }
    Ok(unit.flatten())
}
