//! The head of a wide Motive file: keys and values on the first row, then rows that say what each column is.

use std::path::Path;

use crate::tracks::cells::{Cell, split};
use crate::tracks::grid;
use crate::tracks::lines::{Delimiter, TextLine};
use crate::tracks::number;
use crate::tracks::rotation::Rotation;
use crate::tracks::{PointKind, TrackError, TrackPoint, TrackProblem, Unit};

/// Content of the head.
pub(super) struct Header {
    /// `Format Version`, with a point.
    pub(super) version: String,
    /// `Export Frame Rate` \[Hz\].
    pub(super) rate_hz: f64,
    /// `Length Units`.
    pub(super) unit: Unit,
    /// `Total Exported Frames`, which may lie.
    pub(super) frames: Option<u64>,
    /// Number of columns.
    pub(super) width: usize,
    /// The line of the axis letters.
    pub(super) axis_line: usize,
    /// The points, without positions yet.
    pub(super) points: Vec<TrackPoint>,
    /// The columns of each point.
    pub(super) columns: Vec<grid::Columns>,
}

/// Reads up to and with the row that begins with `Frame`.
pub(super) fn read<'a>(
    lines: &mut impl Iterator<Item = TextLine<'a>>,
    file: &Path,
    delimiter: Delimiter,
) -> Result<Header, TrackError> {
    let mut above: Vec<(TextLine<'a>, Vec<Cell<'a>>)> = Vec::new();
    let mut last = None;
    for line in lines {
        last = Some(line);
        if line.is_blank() {
            continue;
        }
        let cells = split(&line, delimiter, file)?;
        if cells.first().is_some_and(|cell| cell.is("Frame")) {
            return assemble(&above, (line, &cells), file, delimiter);
        }
        // No header is this long: what follows are data, or the whole file is something else.
        if above.len() > 40 {
            break;
        }
        above.push((line, cells));
    }
    let line = above.first().map(|(line, _)| *line).or(last);
    Err(line.map_or_else(
        || TrackError::Empty {
            file: file.to_owned(),
        },
        |line| line.error(file, 0, TrackProblem::NoAxisRow),
    ))
}

fn assemble<'a>(
    above: &[(TextLine<'a>, Vec<Cell<'a>>)],
    axis: (TextLine<'a>, &[Cell<'a>]),
    file: &Path,
    delimiter: Delimiter,
) -> Result<Header, TrackError> {
    let (axis_line, axes) = axis;
    let no_row = |row| axis_line.error(file, 0, TrackProblem::NoHeaderRow { row });
    let Some(((first_line, first), rows)) = above.split_first() else {
        return Err(no_row("`Format Version`"));
    };
    let keys = Keys {
        line: first_line,
        cells: first,
        file,
        comma: delimiter.allows_decimal_comma(),
    };
    let time = axes.get(1);
    if !time.is_some_and(|cell| {
        cell.raw
            .get(..4)
            .is_some_and(|word| word.eq_ignore_ascii_case("time"))
    }) {
        return Err(axis_line.error(
            file,
            time.map_or(0, |cell| cell.at),
            TrackProblem::NoTimeColumn {
                text: time
                    .map(|cell| cell.text().into_owned())
                    .unwrap_or_default(),
            },
        ));
    }
    let Some(((_, components), rows)) = rows.split_last() else {
        return Err(no_row("component (Rotation, Position)"));
    };
    let rows = Rows::find(rows);
    let types = rows.types.ok_or_else(|| no_row("`Type`"))?;
    let names = rows.names.ok_or_else(|| no_row("`Name`"))?;
    let (points, columns) = points(
        &Columns {
            types,
            names,
            ids: rows.ids,
            components,
            axes,
            order: keys.rotation_order(),
        },
        &axis_line,
        file,
    )?;
    if points.is_empty() {
        return Err(axis_line.error(file, 0, TrackProblem::NoPoints));
    }
    keys.global_space()?;
    Ok(Header {
        version: keys.version(),
        rate_hz: keys.rate()?,
        unit: keys.unit()?,
        frames: keys
            .find("Total Exported Frames")
            .and_then(|cell| cell.raw.parse().ok()),
        width: width(types, axes),
        axis_line: axis_line.number,
        points,
        columns,
    })
}

/// Columns up to the last that says anything: spreadsheets put delimiters behind it.
fn width(types: &[Cell<'_>], axes: &[Cell<'_>]) -> usize {
    let last = |row: &[Cell<'_>]| {
        row.iter()
            .rposition(|cell| !cell.raw.is_empty())
            .map_or(0, |last| last + 1)
    };
    last(types).max(last(axes))
}

/// The first row: key, value, key, value. Values are found by their keys, because versions insert new keys anywhere.
struct Keys<'r, 'a> {
    line: &'r TextLine<'a>,
    cells: &'r [Cell<'a>],
    file: &'r Path,
    comma: bool,
}

impl<'a> Keys<'_, 'a> {
    fn find(&self, key: &str) -> Option<Cell<'a>> {
        let pairs = self.cells.chunks(2);
        let mut found = pairs.filter(|pair| pair.first().is_some_and(|cell| cell.is(key)));
        found.find_map(|pair| pair.get(1).copied())
    }

    fn need(&self, key: &'static str) -> Result<Cell<'a>, TrackError> {
        self.find(key)
            .ok_or_else(|| self.line.error(self.file, 0, TrackProblem::NoKey { key }))
    }

    fn version(&self) -> String {
        self.find("Format Version")
            .map_or_else(String::new, |cell| cell.raw.replace(',', "."))
    }

    fn rate(&self) -> Result<f64, TrackError> {
        let cell = self.need("Export Frame Rate")?;
        number::rate(&cell, self.line, self.file, self.comma)
    }

    fn unit(&self) -> Result<Unit, TrackError> {
        let cell = self.need("Length Units")?;
        Unit::from_name(cell.raw).ok_or_else(|| {
            self.line.error(
                self.file,
                cell.at,
                TrackProblem::UnknownUnit {
                    text: cell.text().into_owned(),
                },
            )
        })
    }

    /// The order of Euler angles by `Rotation Type`.
    fn rotation_order(&self) -> [usize; 3] {
        let text = self.find("Rotation Type").map_or("", |cell| cell.raw);
        let axes: Vec<usize> = text
            .chars()
            .filter_map(|letter| "XYZ".find(letter.to_ascii_uppercase()))
            .collect();
        match axes.as_slice() {
            [a, b, c] if a != b && b != c && a != c => [*a, *b, *c],
            _ => [0, 1, 2],
        }
    }

    fn global_space(&self) -> Result<(), TrackError> {
        match self.find("Coordinate Space") {
            Some(cell) if !cell.raw.is_empty() && !cell.is("Global") => {
                let text = cell.text().into_owned();
                Err(self
                    .line
                    .error(self.file, cell.at, TrackProblem::CoordinateSpace { text }))
            }
            _ => Ok(()),
        }
    }
}

/// The rows between the first and the components, found by their label in the second cell or, without labels (1.21), by order.
struct Rows<'r, 'a> {
    types: Option<&'r [Cell<'a>]>,
    names: Option<&'r [Cell<'a>]>,
    ids: Option<&'r [Cell<'a>]>,
}

impl<'r, 'a> Rows<'r, 'a> {
    fn find(rows: &'r [(TextLine<'a>, Vec<Cell<'a>>)]) -> Self {
        let labelled = |label: &str| {
            let is = |cells: &&Vec<Cell<'a>>| cells.get(1).is_some_and(|cell| cell.is(label));
            rows.iter()
                .map(|(_, cells)| cells)
                .find(is)
                .map(Vec::as_slice)
        };
        let any = ["Type", "Name", "ID", "Parent"]
            .iter()
            .any(|label| labelled(label).is_some());
        let ordered = |index: usize| {
            let row = rows.get(index).filter(|_| !any);
            row.map(|(_, cells)| cells.as_slice())
        };
        Self {
            types: labelled("Type").or_else(|| ordered(0)),
            names: labelled("Name").or_else(|| ordered(1)),
            ids: labelled("ID").or_else(|| ordered(2)),
        }
    }
}

struct Columns<'r, 'a> {
    types: &'r [Cell<'a>],
    names: &'r [Cell<'a>],
    ids: Option<&'r [Cell<'a>]>,
    components: &'r [Cell<'a>],
    axes: &'r [Cell<'a>],
    /// Order of the axes of Euler angles.
    order: [usize; 3],
}

impl<'a> Columns<'_, 'a> {
    /// Type, name and ID of a column.
    fn key(&self, index: usize) -> Key<'a> {
        let of = |row: &[Cell<'a>]| row.get(index).map_or("", |cell| cell.raw);
        (of(self.types), of(self.names), self.ids.map_or("", of))
    }

    /// Returns `true` if the column has this component.
    fn is(&self, index: usize, component: &str) -> bool {
        let cell = self.components.get(index);
        cell.is_some_and(|cell| cell.is(component))
    }
}

/// Type, name and ID of a column.
type Key<'a> = (&'a str, &'a str, &'a str);

/// A group of columns while it is put together.
struct Group<'a> {
    key: Key<'a>,
    at: usize,
    columns: [Option<usize>; 3],
    /// Columns of its rotation: x, y, z, w.
    rotation: [Option<usize>; 4],
}

impl Group<'_> {
    /// Quaternion or, without a w, Euler angles in degrees.
    fn rotation(&self, order: [usize; 3]) -> Option<Rotation> {
        match self.rotation {
            [Some(x), Some(y), Some(z), Some(w)] => Some(Rotation::Quaternion([x, y, z, w])),
            [Some(x), Some(y), Some(z), None] => {
                Some(Rotation::Euler([x, y, z], order, 1_f64.to_radians()))
            }
            _ => None,
        }
    }
}

/// Groups the position columns by (type, name, ID); a letter that comes again under the same key begins another point.
fn points(
    columns: &Columns<'_, '_>,
    axis_line: &TextLine<'_>,
    file: &Path,
) -> Result<(Vec<TrackPoint>, Vec<grid::Columns>), TrackError> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    let text =
        |row: &[Cell<'_>], index: usize| row.get(index).is_some_and(|cell| !cell.raw.is_empty());
    // Rotations stand before the positions of their bodies.
    let mut rotations: Vec<(Key<'_>, [Option<usize>; 4])> = Vec::new();
    for (index, axis) in columns.axes.iter().enumerate().skip(2) {
        let key = columns.key(index);
        if columns.is(index, "Rotation") {
            let letter = ["X", "Y", "Z", "W"]
                .iter()
                .position(|letter| axis.is(letter));
            let known = rotations.iter().position(|(known, _)| *known == key);
            let known = known.unwrap_or_else(|| {
                rotations.push((key, [None; 4]));
                rotations.len() - 1
            });
            let slot = letter.and_then(|letter| rotations.get_mut(known)?.1.get_mut(letter));
            if let Some(slot) = slot {
                slot.get_or_insert(index);
            }
            continue;
        }
        let letter = ["X", "Y", "Z"].iter().position(|letter| axis.is(letter));
        let position = columns.is(index, "Position");
        let (Some(letter), true, true) = (letter, position, text(columns.types, index)) else {
            continue;
        };
        let open = groups.iter_mut().rev().find(|group| group.key == key);
        if let Some(slot) = open
            .and_then(|group| group.columns.get_mut(letter))
            .filter(|slot| slot.is_none())
        {
            *slot = Some(index);
            continue;
        }
        let mut group = Group {
            key,
            at: axis.at,
            columns: [None; 3],
            rotation: rotations
                .iter()
                .find(|(known, _)| *known == key)
                .map_or([None; 4], |(_, columns)| *columns),
        };
        if let Some(slot) = group.columns.get_mut(letter) {
            *slot = Some(index);
        }
        groups.push(group);
    }
    let mut found = (Vec::new(), Vec::new());
    for group in groups {
        let (kind, name, id) = group.key;
        let axis = |axis| {
            axis_line.error(
                file,
                group.at,
                TrackProblem::MissingAxis {
                    point: name.to_owned(),
                    axis,
                },
            )
        };
        let [x, y, z] = group.columns;
        let (x, y, z) = (
            x.ok_or_else(|| axis('X'))?,
            y.ok_or_else(|| axis('Y'))?,
            z.ok_or_else(|| axis('Z'))?,
        );
        let name = name.replace("\"\"", "\"");
        let kind = kind_of(kind, &name);
        let rotation = group.rotation(columns.order);
        let point = TrackPoint::new(name, kind, id.to_owned(), Vec::new());
        found.0.push(if rotation.is_some() {
            point.oriented()
        } else {
            point
        });
        found.1.push(grid::Columns {
            rotation,
            ..grid::Columns::of([x, y, z])
        });
    }
    Ok(found)
}

fn kind_of(word: &str, name: &str) -> PointKind {
    match word.to_ascii_lowercase().as_str() {
        "marker" => PointKind::of_marker(name),
        "unlabeled marker" => PointKind::Unlabeled,
        "rigid body" => PointKind::RigidBody,
        "rigid body marker" => PointKind::RigidBodyMarker,
        _ => PointKind::Other,
    }
}
