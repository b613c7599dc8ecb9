//! Outputs of a run, a status and a merge as text.

use operations::sweep::{MergeOutput, RunOutput};
use sweep::Status;

use super::shown;
use crate::quantity::Rows;

/// A finished run.
pub(super) fn run_text(output: &RunOutput) -> Rows {
    let ran = &output.ran;
    let mut rows = Rows::default();
    rows.row("shard", &output.shard)
        .row("designs", format!("{} of {}", ran.tasks, output.tasks))
        .row("without a gait", ran.failed.to_string())
        .row(
            "blocks",
            format!("{}, {} finished before", ran.blocks, ran.skipped),
        )
        .row("took", format!("{:.1} s", output.seconds));
    rows
}

/// Progress of all shards.
pub(super) fn status_text(status: &Status) -> Rows {
    let mut rows = Rows::default();
    rows.row("designs", format!("{} of {}", status.done, status.tasks))
        .row(
            "blocks",
            format!(
                "{} of {}, {} broken",
                status.blocks_done, status.blocks, status.blocks_broken
            ),
        )
        .row("without a gait", status.failed.to_string())
        .row("not certified", status.uncertified.to_string())
        .row("from a neighbour", status.warm.to_string())
        .row("on the disk", format!("{} bytes", status.bytes));
    let milliseconds = |seconds: f64| format!("{:.2} ms", 1e3 * seconds);
    if let Some(design) = status.design_s {
        rows.row("a design costs", milliseconds(design));
    }
    if let (Some(cold), Some(warm)) = (status.cold_s, status.warm_s) {
        rows.row("a search", milliseconds(cold))
            .row("a step from a neighbour", milliseconds(warm));
    }
    if let Some(left) = status.left_s {
        rows.row("left", format!("{:.2} core hours", left / 3600.0));
    }
    rows
}

/// A table.
pub(super) fn merge_text(output: &MergeOutput) -> Rows {
    let mut rows = Rows::default();
    rows.row("designs", output.merged.tasks.to_string())
        .row("certified", output.merged.certified.to_string())
        .row("without a gait", output.merged.failed.to_string())
        .row(
            "table",
            format!("{}, {} bytes", shown(&output.table), output.bytes),
        );
    if let Some(hash) = &output.sha256 {
        rows.row("sha256", hash);
    }
    rows
}
