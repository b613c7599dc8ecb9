//! Data of a map of a finished grid: quantities over two axes, lines at which the arcs of the gait change, and the Pareto set of
//! speed and efficiency.

mod doubt;

use std::path::Path;

use serde::Serialize;

use crate::row::Row;
use crate::{Design, Field, Plan, SweepError, part};
pub(crate) use doubt::among;
pub use doubt::{Doubt, DoubtKind, doubts};

/// Two-dimensional slice of a grid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Slice {
    /// Indices of the horizontal and the vertical axis.
    pub axes: [usize; 2],
    /// Index of the value on every axis; those of the two mapped axes are ignored.
    pub at: Vec<u64>,
}

impl Slice {
    /// Slice of the first two axes at the first value of each other axis. Returns `None` if the plan is not a grid with at least
    /// two axes.
    pub fn first(plan: &Plan) -> Option<Self> {
        let axes = plan.axes().iter().enumerate();
        let mut drawn = axes.filter(|(_, axis)| axis.name.compares());
        let ((across, _), (up, _)) = drawn.next().zip(drawn.next())?;
        (plan.design() == Design::Grid).then(|| Self {
            axes: [across, up],
            at: vec![0; plan.axes().len()],
        })
    }
}

/// An axis of a map.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepMapAxis")
)]
pub struct MapAxis {
    /// Name of the field.
    pub name: &'static str,
    /// Name in words.
    pub words: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Values in the order of the plan.
    pub values: Vec<f64>,
}

/// Mapped quantity: one row per value of the second axis, one number per value of the first.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepMapQuantity")
)]
pub struct Quantity {
    /// Its name.
    pub name: &'static str,
    /// Name in words.
    pub words: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// `None` if the design has no gait.
    pub values: Vec<Vec<Option<f64>>>,
}

/// Design on the Pareto front of speed and efficiency.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepPareto")
)]
pub struct Pareto {
    /// Key of the task.
    pub key: u64,
    /// |d|/(L T) \[1/s\].
    pub speed: f64,
    /// ξ.
    pub efficiency: f64,
    /// Values of the plan's axes, in the order of [`Map::plan_axes`].
    pub design: Vec<f64>,
}

/// Axis of the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepPlanAxis")
)]
pub struct PlanAxis {
    /// Name in the spec.
    pub name: &'static str,
    /// Name in words.
    pub words: &'static str,
    /// Unit; empty for a number.
    pub unit: &'static str,
}

/// Map. The JSON file of `swimmer sweep map --export`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepMap")
)]
pub struct Map {
    /// `swimmer-sweep-map 1`.
    pub format: &'static str,
    /// Hash of the plan.
    pub plan: String,
    /// Objective of the gaits.
    pub objective: &'static str,
    /// Horizontal and vertical axis.
    pub axes: [MapAxis; 2],
    /// Quantities that at least one design of the slice has.
    pub quantities: Vec<Quantity>,
    /// Arcs of each gait, or `None`.
    pub structure: Vec<Vec<Option<String>>>,
    /// `optimal`, `uncertified` or `none`.
    pub status: Vec<Vec<&'static str>>,
    /// Polylines (values of both axes) between designs whose gaits have different arcs, or of which one has no gait.
    pub folds: Vec<Vec<[f64; 2]>>,
    /// Pareto front of the whole plan, slowest first; empty without servo rates.
    pub pareto: Vec<Pareto>,
    /// Axes of the whole plan, without that of the objective.
    pub plan_axes: Vec<PlanAxis>,
    /// Number of designs of the whole plan without a gait.
    #[serde(skip)]
    pub designs_without_gait: u64,
}

/// Definition of a mapped quantity.
struct Column {
    name: &'static str,
    words: &'static str,
    unit: &'static str,
    value: fn(&Row) -> Option<f64>,
}

const COLUMNS: [Column; 7] = [
    Column {
        name: "displacement_over_length",
        words: "displacement |X|/L",
        unit: "",
        value: |row| row.displacement_over_length,
    },
    Column {
        name: "efficiency",
        words: "Lighthill efficiency ξ",
        unit: "",
        value: |row| row.efficiency,
    },
    Column {
        name: "speed_over_length_per_s",
        words: "speed |d|/(L T)",
        unit: "1/s",
        value: |row| row.speed_over_length_per_s,
    },
    Column {
        name: "amplitude_rad",
        words: "largest joint angle of the gait",
        unit: "rad",
        value: |row| row.amplitude_rad,
    },
    Column {
        name: "rotation_rad",
        words: "rotation of a cycle",
        unit: "rad",
        value: |row| row.rotation_rad,
    },
    Column {
        name: "lateral_over_length",
        words: "sideways displacement Y/L",
        unit: "",
        value: |row| row.lateral_over_length,
    },
    Column {
        name: "period_s",
        words: "shortest period",
        unit: "s",
        value: |row| row.period_s,
    },
];

/// Returns the map of a slice of a finished grid.
///
/// # Errors
/// [`SweepError::NoMap`] if the slice does not match the plan, [`SweepError::Unfinished`] if a part is missing.
pub fn map(plan: &Plan, folder: &Path, slice: &Slice) -> Result<Map, SweepError> {
    let [across, up] = slice.axes;
    let axes = plan.axes();
    let refused = |problem: &str| Err(SweepError::NoMap(problem.to_owned()));
    if plan.design() != Design::Grid {
        return refused("its designs are no grid; read the merged table instead");
    }
    let (Some(x), Some(y)) = (axes.get(across), axes.get(up)) else {
        return refused("a map needs two axes");
    };
    if !(x.name.compares() && y.name.compares()) {
        return refused(
            "gaits that are best at different things are drawn one after the other: take --at objective=speed",
        );
    }
    if across == up || slice.at.len() != axes.len() {
        return refused("its two axes must be two of the plan's");
    }
    if x.count().saturating_mul(y.count()) > MOST_CELLS {
        return refused("it would have more than 4 million cells; read the merged table instead");
    }
    let mut cells: Vec<Vec<Option<Row>>> = vec![vec![None; whole(x.count())]; whole(y.count())];
    let mut front: Vec<Pareto> = Vec::new();
    let (mut lost, mut first, mut without) = (0, None, 0);
    for block in 0..plan.blocks() {
        let Some(rows) = part::read(plan, folder, block) else {
            lost += 1;
            first.get_or_insert(block);
            continue;
        };
        for row in rows {
            without += u64::from(row.certified.is_none());
            front.extend(pareto(&row));
            if front.len() > 2 * FRONT {
                keep_front(&mut front);
            }
            let indices = plan.indices(row.key);
            let here = indices.iter().zip(&slice.at).enumerate();
            if here
                .filter(|(axis, _)| ![across, up].contains(axis))
                .all(|(_, (index, at))| index == at)
            {
                let cell = indices
                    .get(up)
                    .and_then(|row| cells.get_mut(whole(*row)))
                    .zip(indices.get(across))
                    .and_then(|(row, column)| row.get_mut(whole(*column)));
                if let Some(cell) = cell {
                    *cell = Some(row);
                }
            }
        }
    }
    if let Some(first) = first {
        return Err(SweepError::Unfinished {
            missing: lost,
            blocks: plan.blocks(),
            first,
        });
    }
    keep_front(&mut front);
    name_designs(plan, &mut front);
    let cells: Vec<Vec<Row>> = cells
        .into_iter()
        .map(|row| row.into_iter().flatten().collect())
        .collect();
    let axes = [x, y].map(|axis| MapAxis {
        name: axis.name.name(),
        words: axis.name.words(),
        unit: axis.name.unit(),
        values: (0..axis.count()).map(|index| axis.value(index)).collect(),
    });
    Ok(Map {
        format: "swimmer-sweep-map 1",
        plan: plan.hash(),
        objective: objective(plan, slice),
        quantities: COLUMNS
            .into_iter()
            .map(|column| Quantity {
                name: column.name,
                words: column.words,
                unit: column.unit,
                values: each(&cells, column.value),
            })
            .filter(|quantity| quantity.values.iter().flatten().any(Option::is_some))
            .collect(),
        structure: each(&cells, |row| row.arcs.clone()),
        status: each(&cells, Row::status),
        folds: folds(&axes, &cells),
        axes,
        pareto: front,
        plan_axes: plan_axes(plan),
        designs_without_gait: without,
    })
}

/// Sets the axes' values of each design.
fn name_designs(plan: &Plan, front: &mut [Pareto]) {
    for one in front {
        one.design = plan
            .indices(one.key)
            .into_iter()
            .zip(plan.axes())
            .filter(|(_, axis)| axis.name != Field::Objective)
            .map(|(index, axis)| axis.value(index))
            .collect();
    }
}

/// Axes of the plan without that of the objective.
fn plan_axes(plan: &Plan) -> Vec<PlanAxis> {
    plan.axes()
        .iter()
        .filter(|axis| axis.name != Field::Objective)
        .map(|axis| PlanAxis {
            name: axis.name.name(),
            words: axis.name.words(),
            unit: axis.name.unit(),
        })
        .collect()
}

/// Objective of the gaits of a slice.
fn objective(plan: &Plan, slice: &Slice) -> &'static str {
    let aims = plan.objectives();
    let axis = plan
        .axes()
        .iter()
        .position(|axis| axis.name == Field::Objective);
    let index = axis
        .and_then(|axis| slice.at.get(axis).copied())
        .unwrap_or(0);
    aims.get(whole(index)).map_or("", |aim| aim.word())
}

const MOST_CELLS: u64 = 1 << 22;
/// Number of designs after which the Pareto front is reduced.
const FRONT: usize = 1 << 14;

fn whole(index: u64) -> usize {
    usize::try_from(index).unwrap_or(usize::MAX)
}

fn each<T>(cells: &[Vec<Row>], of: impl Fn(&Row) -> T) -> Vec<Vec<T>> {
    cells
        .iter()
        .map(|row| row.iter().map(&of).collect())
        .collect()
}

fn pareto(row: &Row) -> Option<Pareto> {
    (row.certified == Some(true)).then_some(Pareto {
        key: row.key,
        speed: row.speed_over_length_per_s?,
        efficiency: row.efficiency?,
        design: Vec::new(),
    })
}

/// Reduces the designs to their Pareto front, slowest first.
fn keep_front(front: &mut Vec<Pareto>) {
    front.sort_by(|a, b| {
        b.speed
            .total_cmp(&a.speed)
            .then(b.efficiency.total_cmp(&a.efficiency))
            .then(a.key.cmp(&b.key))
    });
    let mut best = f64::NEG_INFINITY;
    front.retain(|one| {
        let keep = one.efficiency > best;
        best = best.max(one.efficiency);
        keep
    });
    front.reverse();
}

/// Borders between cells with different arcs; collinear segments are joined.
fn folds(axes: &[MapAxis; 2], cells: &[Vec<Row>]) -> Vec<Vec<[f64; 2]>> {
    let [x, y] = axes;
    let (columns, rows) = (x.values.len(), y.values.len());
    let [xs, ys] = [borders(&x.values), borders(&y.values)];
    let arcs = |row: usize, column: usize| {
        cells
            .get(row)
            .and_then(|cells| cells.get(column))
            .and_then(|cell| cell.arcs.as_deref())
    };
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut line =
        |differ: &dyn Fn(usize) -> bool, count: usize, at: &dyn Fn(usize) -> [f64; 2]| {
            let mut from = None;
            for index in 0..=count {
                match (from, index < count && differ(index)) {
                    (None, true) => from = Some(index),
                    (Some(began), false) => {
                        lines.push(vec![at(began), at(index)]);
                        from = None;
                    }
                    _ => {}
                }
            }
        };
    for (column, &border) in xs.iter().enumerate().take(columns).skip(1) {
        line(
            &|row| arcs(row, column) != arcs(row, column - 1),
            rows,
            &|row| [border, ys[row]],
        );
    }
    for (row, &border) in ys.iter().enumerate().take(rows).skip(1) {
        line(
            &|column| arcs(row, column) != arcs(row - 1, column),
            columns,
            &|column| [xs[column], border],
        );
    }
    lines
}

/// Cell borders of an axis: midpoints of its values, extrapolated at both ends.
pub(crate) fn borders(values: &[f64]) -> Vec<f64> {
    let halfway = |a: f64, b: f64| 0.5 * (a + b);
    let mut ends: Vec<f64> = values
        .windows(2)
        .map(|pair| match pair {
            [a, b] => halfway(*a, *b),
            _ => f64::NAN,
        })
        .collect();
    let first = match values {
        [a, b, ..] => a - halfway(-*a, *b),
        [a] => a - 0.5,
        [] => 0.0,
    };
    let last = match values {
        [.., a, b] => b + halfway(-*a, *b),
        [a] => a + 0.5,
        [] => 0.0,
    };
    ends.insert(0, first);
    ends.push(last);
    ends
}

impl MapAxis {
    /// Cell borders, one more than the number of values.
    pub fn borders(&self) -> Vec<f64> {
        borders(&self.values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_end_halfway() {
        let ends = borders(&[1.0, 2.0, 4.0]);
        let expected = [0.5, 1.5, 3.0, 5.0];
        assert!(
            ends.iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-12),
            "{ends:?}"
        );
    }

    #[test]
    fn the_front_keeps_what_nothing_beats() {
        let one = |key, speed, efficiency| Pareto {
            key,
            speed,
            efficiency,
            design: Vec::new(),
        };
        let mut front = vec![
            one(0, 1.0, 0.5),
            one(1, 2.0, 0.4),
            one(2, 1.5, 0.3),
            one(3, 1.0, 0.5),
            one(4, 0.5, 0.6),
        ];
        keep_front(&mut front);
        let keys: Vec<_> = front.iter().map(|one| one.key).collect();
        assert_eq!(keys, [4, 0, 1]);
    }
}
