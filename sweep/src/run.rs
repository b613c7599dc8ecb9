//! Execution of blocks over shards and threads.

use std::fs::{self, OpenOptions};
use std::io::Write as _;
use std::path::Path;
use std::str::FromStr;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::warm::{self, Cost};
use crate::{Plan, SweepError, part};

/// Share of a sweep: every `of`-th block, from block `number` − 1 on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: u64,
    of: u64,
}

impl Shard {
    /// Shard of all blocks.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Shard `number` (from 1) of `of`. Returns `None` if `number` is out of range.
    pub fn new(number: u64, of: u64) -> Option<Self> {
        (number >= 1 && number <= of).then_some(Self { number, of })
    }

    /// Number of the plan's blocks in this shard.
    pub fn blocks(self, plan: &Plan) -> u64 {
        let blocks = plan.blocks();
        blocks / self.of + u64::from(self.number <= blocks % self.of)
    }

    fn block(self, index: u64) -> u64 {
        self.number - 1 + index * self.of
    }
}

impl FromStr for Shard {
    type Err = String;

    /// Reads the number of the shard and the number of shards, as `2/7`.
    fn from_str(text: &str) -> Result<Self, String> {
        text.split_once('/')
            .and_then(|(number, of)| Self::new(number.parse().ok()?, of.parse().ok()?))
            .ok_or_else(|| {
                "write the shard and the number of shards, as 2/7 (from 1/7 to 7/7)".to_owned()
            })
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// Options of the execution of a shard.
#[derive(Clone, Copy)]
pub struct Running<'a> {
    /// Shard to run.
    pub shard: Shard,
    /// Number of threads, each with its own block. Results do not depend on it.
    pub threads: usize,
    /// Clock \[s\] for the computation time per design.
    pub seconds: &'a (dyn Fn() -> f64 + Sync),
    /// Callback with the progress after each block. It may unwind to end the run; finished blocks stay.
    pub watch: &'a (dyn Fn(Ran) + Sync),
}

impl std::fmt::Debug for Running<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Running")
            .field("shard", &self.shard)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

/// Progress of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepRunCounts")
)]
pub struct Ran {
    /// Number of tasks in finished blocks.
    #[serde(rename = "done")]
    pub tasks: u64,
    /// Number of those without a gait.
    pub failed: u64,
    /// Number of blocks of the shard.
    pub blocks: u64,
    /// Number of finished blocks, earlier runs included.
    #[serde(skip)]
    pub done: u64,
    /// Number of blocks finished by earlier runs.
    #[serde(rename = "blocks_skipped")]
    pub skipped: u64,
}

/// Runs every block of a shard that is missing or incomplete.
///
/// # Errors
/// The error of the first part that cannot be written. Finished parts remain.
pub fn run(plan: &Plan, folder: &Path, running: &Running<'_>) -> Result<Ran, SweepError> {
    let shard = running.shard;
    let blocks = shard.blocks(plan);
    let next = AtomicU64::new(0);
    let stop = AtomicBool::new(false);
    let state = Mutex::new((
        Ran {
            blocks,
            ..Ran::default()
        },
        None,
    ));
    let worker = || {
        while !stop.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= blocks {
                return;
            }
            let outcome = finished(plan, folder, running, shard.block(index));
            let mut state = state
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner);
            match outcome {
                Ok(one) => {
                    let ran = &mut state.0;
                    ran.done += 1;
                    ran.skipped += one.skipped;
                    ran.tasks += one.tasks;
                    ran.failed += one.failed;
                    (running.watch)(*ran);
                }
                Err(error) => {
                    stop.store(true, Ordering::Relaxed);
                    state.1.get_or_insert(error);
                }
            }
        }
    };
    std::thread::scope(|scope| {
        let others: Vec<_> = (1..running.threads.clamp(1, 1024))
            .map(|_| scope.spawn(worker))
            .collect();
        worker();
        for other in others {
            // A callback may end the run by unwinding, and its caller recognises that by the payload.
            if let Err(panic) = other.join() {
                std::panic::resume_unwind(panic);
            }
        }
    });
    match state
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
    {
        (_, Some(error)) => Err(error),
        (ran, None) => Ok(ran),
    }
}

fn finished(
    plan: &Plan,
    folder: &Path,
    running: &Running<'_>,
    block: u64,
) -> Result<Ran, SweepError> {
    let there = part::read(plan, folder, block);
    let skipped = u64::from(there.is_some());
    let rows = if let Some(rows) = there {
        rows
    } else {
        let (rows, cost) = warm::block(plan, block, running.seconds);
        part::write(plan, folder, block, &rows)?;
        note(folder, running.shard, block, rows.len(), &cost);
        rows
    };
    Ok(Ran {
        skipped,
        tasks: rows.len() as u64,
        failed: rows.iter().filter(|row| row.certified.is_none()).count() as u64,
        ..Ran::default()
    })
}

/// Folder of the computation times, which are kept apart from the results.
pub(crate) const COSTS: &str = "costs";

/// Appends a line for a block: `block,tasks,cold,warm,cold_s,warm_s`. It only serves planning, so a failure is ignored.
fn note(folder: &Path, shard: Shard, block: u64, tasks: usize, cost: &Cost) {
    let Cost {
        cold,
        warm,
        cold_s,
        warm_s,
    } = cost;
    let line = format!("{block},{tasks},{cold},{warm},{cold_s:.6},{warm_s:.6}\n");
    let costs = folder.join(COSTS);
    let name = format!("{}-of-{}.csv", shard.number, shard.of);
    let _ = fs::create_dir_all(&costs)
        .and_then(|()| {
            OpenOptions::new()
                .create(true)
                .append(true)
                .open(costs.join(name))
        })
        .and_then(|mut file| file.write_all(line.as_bytes()));
}
