//! Progress of all shards, and computation time per design.

use std::fs;
use std::path::Path;

use serde::Serialize;

use crate::run::COSTS;
use crate::{Plan, SweepError, part};

/// Progress of a sweep. The JSON document of `swimmer sweep status`.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepStatusOutput")
)]
pub struct Status {
    /// Hash of the plan.
    pub plan: String,
    /// Number of designs of the plan.
    pub tasks: u64,
    /// Number of designs in finished blocks.
    pub done: u64,
    /// Number of those without a gait.
    pub failed: u64,
    /// Number of those whose certificate does not pass.
    pub uncertified: u64,
    /// Number of those found from a neighbour's gait.
    pub warm: u64,
    /// Number of blocks of the plan.
    pub blocks: u64,
    /// Number of finished blocks.
    pub blocks_done: u64,
    /// Number of incomplete blocks and of blocks of another plan; a run replaces them.
    pub blocks_broken: u64,
    /// Size of all parts in bytes.
    pub bytes: u64,
    /// Mean core seconds of a search; `None` before the first was timed.
    pub cold_s: Option<f64>,
    /// Mean core seconds of a step from a neighbour's gait.
    pub warm_s: Option<f64>,
    /// Mean core seconds of a design, searches and steps together.
    pub design_s: Option<f64>,
    /// Remaining core seconds at that mean.
    pub left_s: Option<f64>,
}

/// Reads every part and the computation times.
///
/// # Errors
/// Currently none; a part that cannot be read counts as missing.
pub fn status(plan: &Plan, folder: &Path) -> Result<Status, SweepError> {
    let mut status = Status {
        plan: plan.hash(),
        tasks: plan.tasks(),
        blocks: plan.blocks(),
        ..Status::default()
    };
    for block in 0..plan.blocks() {
        let Ok(there) = fs::metadata(part::path(folder, block)) else {
            continue;
        };
        status.bytes += there.len();
        let Some(rows) = part::read(plan, folder, block) else {
            status.blocks_broken += 1;
            continue;
        };
        status.blocks_done += 1;
        for row in rows {
            status.done += 1;
            status.failed += u64::from(row.certified.is_none());
            status.uncertified += u64::from(row.certified == Some(false));
            status.warm += u64::from(row.warm);
        }
    }
    let [tasks, cold, warm, cold_s, warm_s] = costs(folder);
    let mean = |sum: f64, count: f64| (count > 0.0).then(|| sum / count);
    status.cold_s = mean(cold_s, cold);
    status.warm_s = mean(warm_s, warm);
    status.design_s = mean(cold_s + warm_s, tasks);
    status.left_s = status
        .design_s
        .map(|one| one * (status.tasks - status.done) as f64);
    Ok(status)
}

/// Sums of tasks, searches, steps, and the seconds of both. An incomplete line is skipped.
fn costs(folder: &Path) -> [f64; 5] {
    let mut sums = [0.0; 5];
    let files = fs::read_dir(folder.join(COSTS)).into_iter().flatten();
    for text in files
        .flatten()
        .filter_map(|file| fs::read_to_string(file.path()).ok())
    {
        for line in text
            .split_inclusive('\n')
            .filter_map(|line| line.strip_suffix('\n'))
        {
            let numbers: Vec<f64> = line
                .split(',')
                .filter_map(|word| word.parse().ok())
                .collect();
            if let [_, sums_of_part @ ..] = numbers.as_slice()
                && sums_of_part.len() == sums.len()
            {
                sums.iter_mut()
                    .zip(sums_of_part)
                    .for_each(|(sum, one)| *sum += one);
            }
        }
    }
    sums
}
