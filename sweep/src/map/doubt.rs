//! Doubtful designs, found by comparison with their neighbours: the optimum never worsens with a wider bound, and it is continuous
//! in the parameters. A listed design deserves inspection but need not be wrong, since a branch of gaits may end.

use std::ops::Range;
use std::path::Path;

use serde::Serialize;

use crate::{Axis, Design, Plan, SweepError, part};

/// Reason to doubt a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepDoubtKind")
)]
#[serde(rename_all = "lowercase")]
pub enum DoubtKind {
    /// A neighbour with tighter bounds is better.
    Beaten,
    /// The design has no gait, but both neighbours along an axis have one.
    Lost,
    /// The objective jumps between two neighbours: by at least one percent, and ten times as much as on either side of them.
    Jump,
}

/// Doubtful design.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepDoubt")
)]
pub struct Doubt {
    /// Reason.
    pub kind: DoubtKind,
    /// Key of the task.
    pub key: u64,
    /// Key of the neighbour with which it was compared.
    pub neighbour: u64,
    /// Relative difference by which the neighbour is better; `None` for a lost gait.
    pub share: Option<f64>,
}

/// Largest number of designs that are held in memory.
const MOST: u64 = 20_000_000;
/// Relative difference below which two designs are equally good.
const BETTER: f64 = 1e-6;
/// Least jump relative to the larger value, and ratio of the adjacent steps to it.
const JUMP: f64 = 1e-2;
const STEEPER: f64 = 10.0;

/// Compares all neighbours of a finished grid and returns the doubtful designs by key.
///
/// # Errors
/// [`SweepError::NoMap`] if the plan is not a grid or too large for memory.
pub fn doubts(plan: &Plan, folder: &Path) -> Result<Vec<Doubt>, SweepError> {
    if plan.design() != Design::Grid || plan.tasks() > MOST {
        return Err(SweepError::NoMap(
            "neighbours are compared in grids of at most 20 million designs".to_owned(),
        ));
    }
    let mut values: Vec<Option<f64>> = Vec::new();
    for block in 0..plan.blocks() {
        let rows = part::read(plan, folder, block).ok_or(SweepError::Unfinished {
            missing: 1,
            blocks: plan.blocks(),
            first: block,
        })?;
        values.extend(rows.iter().map(|row| row.objective));
    }
    let value = |key: u64| {
        let key = usize::try_from(key).ok()?;
        values.get(key).copied().flatten()
    };
    Ok(among(plan, 0..values.len() as u64, &value))
}

/// Compares the neighbours among some tasks of a grid, by key; tasks outside of them have no value.
pub(crate) fn among(
    plan: &Plan,
    keys: Range<u64>,
    value: &dyn Fn(u64) -> Option<f64>,
) -> Vec<Doubt> {
    let mut found = Vec::new();
    let mut stride = 1_u64;
    for axis in plan.axes().iter().rev() {
        if axis.name.compares() {
            along(axis, stride, &keys, value, &mut found);
        }
        stride *= axis.count();
    }
    found.sort_by_key(|doubt| (doubt.key, doubt.neighbour));
    found
}

fn along(
    axis: &Axis,
    stride: u64,
    keys: &Range<u64>,
    value: &dyn Fn(u64) -> Option<f64>,
    found: &mut Vec<Doubt>,
) {
    for key in keys.clone() {
        let index = key / stride % axis.count();
        let at = |step: i64| {
            let there = index.checked_add_signed(step)?;
            let key = key.wrapping_add_signed(step * stride.cast_signed());
            (there < axis.count() && keys.contains(&key)).then_some(key)
        };
        let Some(next) = at(1) else {
            continue;
        };
        let Some(here) = value(key) else {
            if at(-1).and_then(value).is_some() && value(next).is_some() {
                found.push(Doubt {
                    kind: DoubtKind::Lost,
                    key,
                    neighbour: next,
                    share: None,
                });
            }
            continue;
        };
        let Some(there) = value(next) else {
            continue;
        };
        let larger = here.max(there);
        let grows = axis.value(index + 1) > axis.value(index);
        let (tight, wide) = if grows == (axis.name.widens() > 0) {
            ((key, here), (next, there))
        } else {
            ((next, there), (key, here))
        };
        if axis.name.widens() != 0 && tight.1 > wide.1 * (1.0 + BETTER) {
            found.push(Doubt {
                kind: DoubtKind::Beaten,
                key: wide.0,
                neighbour: tight.0,
                share: Some(1.0 - wide.1 / tight.1),
            });
            continue;
        }
        let beside = [
            at(-1).and_then(value).map(|before| here - before),
            at(2).and_then(value).map(|after| after - there),
        ];
        let steps = beside.into_iter().flatten().map(f64::abs);
        let steepest = steps.reduce(f64::max);
        let step = (there - here).abs();
        if step > JUMP * larger && steepest.is_some_and(|steepest| step > STEEPER * steepest) {
            let (worse, better) = if here < there {
                (key, next)
            } else {
                (next, key)
            };
            found.push(Doubt {
                kind: DoubtKind::Jump,
                key: worse,
                neighbour: better,
                share: Some(step / larger),
            });
        }
    }
}
