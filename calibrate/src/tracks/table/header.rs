//! The header of a plain table: which column is the time, which are points, and in what unit.

use std::path::Path;

use super::rotations::{self, RotationColumns};
use crate::tracks::cells::{Cell, cell_at, split};
use crate::tracks::detect::TableLayout;
use crate::tracks::grid::{Clock, Columns};
use crate::tracks::lines::TextLine;
use crate::tracks::number::{Number, number};
use crate::tracks::{PointKind, TrackError, TrackOptions, TrackPoint, TrackProblem, Unit};

pub(super) struct Header {
    pub(super) width: usize,
    /// The column of an id in tables of one row a point.
    pub(super) id: Option<usize>,
    /// `true` if an angle has no stated unit.
    pub(super) short_angles: bool,
    /// `true` if the columns have Kinovea's names (`Time`, `ball/0/X`).
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
    /// Reads the names; `first_row` is the first line of data, if there is any.
    pub(super) fn read(
        line: TextLine<'_>,
        first_row: Option<TextLine<'_>>,
        (file, layout): (&Path, &TableLayout),
        options: &TrackOptions,
    ) -> Result<Self, TrackError> {
        let text = line.text.trim_start_matches([' ', '#', '%']);
        let shift = line.text.len() - text.len();
        let trimmed = TextLine { text, ..line };
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
        let row = first_row.and_then(|row| split(&row, layout.delimiter, file).ok());
        let clock = clock(&names, row.as_deref(), options).map_err(|problem| error(0, problem))?;
        let bare: Vec<(&str, Option<&str>)> =
            names.iter().map(|name| (name.bare, name.unit)).collect();
        let turns = rotations::orientations(&bare);
        let of_turns = |column: &usize| {
            let mut turns = turns.iter();
            turns.any(|found| found.rotation.columns().contains(column))
        };
        let groups = groups(&names, options, of_turns, &error)?;
        let turn_of = |stem: &str| {
            let stem = if stem == "x,y" { "" } else { stem };
            let own = turns.iter().find(|found| found.is_of(stem));
            own.or_else(|| {
                turns
                    .first()
                    .filter(|_| groups.len() == 1 && turns.len() == 1)
            })
        };
        let turns_of: Vec<Option<&RotationColumns>> =
            groups.iter().map(|(stem, _)| turn_of(stem)).collect();
        let short_angles = turns_of.iter().flatten().any(|found| found.without_unit);
        let unit = unit(&names, &groups, &error)?;
        let whole = |column: &usize| {
            names
                .get(*column)
                .map_or_else(String::new, |name| name.whole.clone())
        };
        // A lone point with an orientation is a body.
        let alone = groups.len() == 1 && turns_of.iter().any(Option::is_some);
        let kind = if alone {
            PointKind::RigidBody
        } else {
            PointKind::Marker
        };
        let point = |((name, columns), turn): (&(String, Vec<usize>), Option<&RotationColumns>)| {
            let name = rotations::point_name(name);
            let columns = columns.iter().map(whole).collect();
            let point = TrackPoint::new(name, kind, String::new(), columns);
            if turn.is_some() {
                point.oriented()
            } else {
                point
            }
        };
        let kinovea = names.first().is_some_and(|name| name.whole == "Time")
            && names
                .iter()
                .skip(1)
                .all(|name| name.whole.ends_with("/X") || name.whole.ends_with("/Y"));
        Ok(Self {
            width: cells.len(),
            id: id(&names).filter(|_| groups.len() == 1),
            short_angles,
            kinovea,
            clock,
            unit,
            points: groups
                .iter()
                .zip(turns_of.iter().copied())
                .map(point)
                .collect(),
            columns: groups
                .iter()
                .zip(turns_of.iter().copied())
                .map(|((_, columns), turn)| Columns {
                    rotation: turn.map(|found| found.rotation),
                    ..places(columns)
                })
                .collect(),
        })
    }
}

/// Position columns by the name of their point.
///
/// # Errors
/// A point without an axis, or a table without points.
fn groups(
    names: &[Name<'_>],
    options: &TrackOptions,
    of_turns: impl Fn(&usize) -> bool + Copy,
    error: &impl Fn(usize, TrackProblem) -> TrackError,
) -> Result<Vec<(String, Vec<usize>)>, TrackError> {
    let mut groups = pairs(names, options, error)?;
    for (name, axes) in stems(names, of_turns, error)? {
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
        groups = loose(names, of_turns);
    }
    if groups.is_empty() {
        return Err(error(0, TrackProblem::NoPoints));
    }
    // TrackMate's spots have many columns more.
    if id(names).is_some() && groups.iter().any(|(stem, _)| stem == "POSITION") {
        groups.retain(|(stem, _)| stem == "POSITION");
    }
    Ok(groups)
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
        rotation: None,
    }
}

/// The column of an id: that of a track before that of a single spot.
fn id(names: &[Name<'_>]) -> Option<usize> {
    let words = [
        "track_id",
        "trackid",
        "particle",
        "marker_id",
        "markerid",
        "aruco_id",
        "tag_id",
        "object_id",
        "id",
    ];
    words.iter().find_map(|word| {
        let is = |name: &Name<'_>| name.whole.eq_ignore_ascii_case(word);
        names.iter().position(is)
    })
}

/// Pairs of columns that are the same but for a last x and y without anything before it: `fx`, `fy`.
fn loose(names: &[Name<'_>], taken: impl Fn(&usize) -> bool) -> Vec<(String, Vec<usize>)> {
    let free = || {
        names
            .iter()
            .enumerate()
            .filter(|(column, _)| !taken(column))
    };
    let named = |stem: &str, letter: char| {
        let whole = format!("{stem}{letter}");
        let mut free = free();
        free.find(|(_, name)| name.bare.eq_ignore_ascii_case(&whole))
    };
    let pair = |(column, name): (usize, &Name<'_>)| {
        let stem = name
            .bare
            .strip_suffix(['x', 'X'])
            .filter(|stem| !stem.is_empty())?;
        let (y, _) = named(stem, 'y')?;
        let z = named(stem, 'z').map(|(z, _)| z);
        Some((stem.to_owned(), [column, y].into_iter().chain(z).collect()))
    };
    free().filter_map(pair).collect()
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
            "m" | "mm"
                | "cm"
                | "px"
                | "pixel"
                | "pixels"
                | "s"
                | "ms"
                | "us"
                | "ns"
                | "seconds"
                | "deg"
                | "rad"
                | "degrees"
                | "radians"
        )
        .then_some((bare, unit))
    });
    // An index is no unit: `C7[0]`.
    let cut = cut.filter(|(_, unit)| !unit.bytes().all(|b| b.is_ascii_digit()));
    let (bare, unit) = cut.map_or((raw, None), |(bare, unit)| (bare.trim_end(), Some(unit)));
    Name {
        whole: cell.text().into_owned(),
        bare,
        unit,
    }
}

/// Names of a column of times; a message's own stamp comes before the time at which it was received.
const TIMES: [&str; 11] = [
    "field.header.stamp",
    "t",
    "time",
    "seconds",
    "timestamp",
    "time_stamp",
    "datetime",
    "date_time",
    "date",
    "position_t",
    "stamp",
];
/// Stamps since 1970 by their size: nanoseconds, microseconds, milliseconds.
const SINCE_1970: [(f64, f64); 3] = [(1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3)];

/// Source of the rows' times; `row` has the cells of the first row.
fn clock(
    names: &[Name<'_>],
    row: Option<&[Cell<'_>]>,
    options: &TrackOptions,
) -> Result<Clock, TrackProblem> {
    let value = |column: usize| match number(cell_at(row.unwrap_or(&[]), column).raw, true) {
        Number::Finite(value) => Some(value),
        _ => None,
    };
    let find = |words: &[&str]| {
        names.iter().position(|name| {
            words
                .iter()
                .any(|word| name.bare.eq_ignore_ascii_case(word))
        })
    };
    // A column without a name is an index: of frames if it holds whole numbers, else of times.
    let unnamed = names
        .first()
        .filter(|name| name.whole.is_empty())
        .map(|_| 0);
    let whole = |column: &usize| value(*column).is_some_and(|value| value.fract() == 0.0);
    let frame = find(&["frame", "frame#", "frames", "frame_idx", "frame_id"])
        .or_else(|| unnamed.filter(whole));
    let time = TIMES.iter().filter_map(|word| find(&[word]));
    // A stamp that was not set is 0.
    let time = time.into_iter().find(|column| {
        let stamp = names
            .get(*column)
            .and_then(|name| name.bare.rsplit_once('.'))
            .is_some_and(|(_, last)| last == "stamp");
        !stamp || value(*column).is_some_and(|value| value > 0.0)
    });
    if let Some(time) = time.or_else(|| unnamed.filter(|column| !whole(column))) {
        let large = value(time).unwrap_or(0.0);
        let since_1970 = SINCE_1970.iter().find(|(least, _)| large >= *least);
        let seconds = match names.get(time).and_then(|name| name.unit) {
            Some("ms") => 1e-3,
            Some("us" | "µs") => 1e-6,
            Some("ns") => 1e-9,
            _ => since_1970.map_or(1.0, |(_, seconds)| *seconds),
        };
        return Ok(Clock::Stamped {
            time,
            seconds,
            // Stamps are the clock; a column without a name counts rows, whatever rows.
            frame: frame.filter(|frame| Some(*frame) != unnamed),
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
    taken: impl Fn(&usize) -> bool,
    error: &impl Fn(usize, TrackProblem) -> TrackError,
) -> Result<Stems, TrackError> {
    let mut found: Stems = Vec::new();
    for (index, name) in names.iter().enumerate() {
        let Some((axis, stem)) = axis_and_stem(name.bare).filter(|_| !taken(&index)) else {
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
    // kineticstoolkit: `C7[0]`, `C7[1]`, `C7[2]`, and a 1 that is no coordinate.
    if let Some((stem, index)) = bare
        .strip_suffix(']')
        .and_then(|rest| rest.rsplit_once('['))
        && let Some(axis) = ["0", "1", "2"].iter().position(|axis| *axis == index)
    {
        return Some((axis, stem));
    }
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
            let text = format!("{} next to another unit", name.unit.unwrap_or("none"));
            return Err(error(index, TrackProblem::UnknownUnit { text }));
        }
    }
    Ok(unit.flatten())
}
