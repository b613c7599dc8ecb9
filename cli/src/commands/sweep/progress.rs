//! Outputs of a run, a status and a merge.

use std::fmt;
use std::path::PathBuf;

use serde::Serialize;
use sweep::{Merged, Plan, Ran, Status};
use swimmer_files::{FileError, hash_of};

use super::shown;
use crate::failure::Outcome;
use crate::quantity::Rows;

/// Output of `swimmer sweep run`.
#[derive(Debug, Serialize)]
pub(super) struct RunOutput {
    pub(super) plan: String,
    pub(super) shard: String,
    /// Number of designs of the plan.
    pub(super) tasks: u64,
    #[serde(flatten)]
    pub(super) ran: Ran,
    pub(super) seconds: f64,
}

impl fmt::Display for RunOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        rows.row("shard", &self.shard)
            .row("designs", format!("{} of {}", self.ran.tasks, self.tasks))
            .row("without a gait", self.ran.failed.to_string())
            .row(
                "blocks",
                format!("{}, {} finished before", self.ran.blocks, self.ran.skipped),
            )
            .row("took", format!("{:.1} s", self.seconds));
        write!(f, "{rows}")
    }
}

/// Progress of all shards.
#[derive(Debug, Serialize)]
#[serde(transparent)]
pub(super) struct StatusOutput(pub(super) Status);

impl fmt::Display for StatusOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(status) = self;
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
        write!(f, "{rows}")
    }
}

/// Output of `swimmer sweep merge`.
#[derive(Debug, Serialize)]
pub(super) struct MergeOutput {
    plan: String,
    tasks: u64,
    #[serde(flatten)]
    merged: Merged,
    table: PathBuf,
    bytes: u64,
    sha256: Option<String>,
}

impl MergeOutput {
    pub(super) fn new(plan: &Plan, merged: Merged, table: PathBuf) -> Outcome<Self> {
        let read = |source| FileError::Read {
            path: table.clone(),
            source,
        };
        let bytes = std::fs::metadata(&table).map_err(read)?.len();
        // A table that would not fit into memory is not read again for its hash.
        let sha256 = if bytes <= MOST_HASHED {
            Some(hash_of(&table)?)
        } else {
            None
        };
        Ok(Self {
            plan: plan.hash(),
            tasks: plan.tasks(),
            merged,
            table,
            bytes,
            sha256,
        })
    }
}

const MOST_HASHED: u64 = 1 << 28;

impl fmt::Display for MergeOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        rows.row("designs", self.merged.tasks.to_string())
            .row("certified", self.merged.certified.to_string())
            .row("without a gait", self.merged.failed.to_string())
            .row(
                "table",
                format!("{}, {} bytes", shown(&self.table), self.bytes),
            );
        if let Some(hash) = &self.sha256 {
            rows.row("sha256", hash);
        }
        write!(f, "{rows}")
    }
}
