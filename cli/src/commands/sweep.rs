//! `swimmer sweep`: the best gait of many designs, on every core of one machine or of many.

pub(crate) mod map;
mod picture;
mod plan;
mod progress;
mod submit;

use std::path::{Path, PathBuf};

use ::sweep::{Shard, SweepError};
use clap::Subcommand;
use operations::{Error, sweep as operation};

use crate::context::context;
use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;
use crate::output::Output;

/// Find the best gaits of many designs, over morphology, fluid, bounds and rates
///
/// A spec (TOML) names a swimmer, an objective and axes; `plan` makes an immutable plan of it in a folder, `run` solves it,
/// block by block, and may be killed and begun again at any time, `merge` makes one Parquet table. On a cluster each task of
/// a job array runs one shard (`submit slurm` writes the script).
#[derive(Debug, Subcommand)]
pub(crate) enum Sweep {
    Plan(plan::PlanSpec),
    Run(Run),
    Status(Status),
    Merge(Merge),
    Map(map::Map),
    #[command(subcommand)]
    Submit(submit::Submit),
}

/// Solve the designs of a plan that are not solved yet
///
/// Finished blocks are passed over, broken ones made again. The answers depend neither on shards nor on threads. Within a job
/// array of Slurm the shard is the array's task.
#[derive(Debug, clap::Args)]
pub(crate) struct Run {
    /// The folder of the plan
    folder: PathBuf,
    /// Only this share of the blocks, as 2/7: every seventh, from the second on
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Number of threads; by default the number of cores
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Say how far a sweep is, over all shards, and what a design costs
#[derive(Debug, clap::Args)]
pub(crate) struct Status {
    /// The folder of the plan
    folder: PathBuf,
}

/// Put all designs of a finished sweep into one Parquet table, sorted by key
#[derive(Debug, clap::Args)]
pub(crate) struct Merge {
    /// The folder of the plan
    folder: PathBuf,
    /// File of the table
    #[arg(short, long, value_name = "FILE.parquet")]
    output: PathBuf,
}

impl Sweep {
    /// Runs the requested step.
    pub(crate) fn run(self, output: Output) -> Outcome {
        match self {
            Self::Plan(plan) => plan.run(output),
            Self::Run(run) => run.run(output),
            Self::Status(status) => {
                let found = operation::status(&status.folder)?;
                output.rendered(&found, &progress::status_text(&found));
                Ok(())
            }
            Self::Merge(merge) => merge.run(output),
            Self::Map(map) => map.run(output),
            Self::Submit(submit) => submit.run(output),
        }
    }
}

impl Run {
    fn run(self, output: Output) -> Outcome {
        let shard = match self.shard {
            Some(shard) => shard,
            None => of_environment()?.unwrap_or(Shard::WHOLE),
        };
        let mut context = context();
        context.threads = self.threads.map_or(context.threads, usize::from);
        let ran = operation::run(&self.folder, shard, &context)?;
        output.rendered(&ran, &progress::run_text(&ran));
        Ok(())
    }
}

impl Merge {
    fn run(self, output: Output) -> Outcome {
        may_be_written(&self.output)?;
        let merged = operation::merge(&self.folder, &self.output)?;
        output.rendered(&merged, &progress::merge_text(&merged));
        Ok(())
    }
}

/// Shard that Slurm's job array gives this process. Returns `None` outside of a job array.
///
/// # Errors
/// The tasks of the job array are not numbered as shards.
pub(crate) fn of_environment() -> Outcome<Option<Shard>> {
    let number = |name: &str| {
        let Some(text) = std::env::var_os(name) else {
            return Ok(None);
        };
        let parsed = text.to_str().and_then(|text| text.parse::<u64>().ok());
        parsed.map(Some).ok_or_else(|| {
            Failure::BadInput(format!(
                "{name} is {}, which is no number: say the shard yourself, as --shard 1/4",
                text.to_string_lossy()
            ))
        })
    };
    let Some(task) = number("SLURM_ARRAY_TASK_ID")? else {
        return Ok(None);
    };
    let count = number("SLURM_ARRAY_TASK_COUNT")?;
    let first = number("SLURM_ARRAY_TASK_MIN")?.unwrap_or(1);
    let of = count.and_then(|count| Shard::new(task.checked_sub(first)? + 1, count));
    of.map(Some).ok_or_else(|| {
        Failure::BadInput(format!(
            "task {task} of this job array is no shard: number its tasks without gaps, as --array=1-8, or say --shard I/N"
        ))
    })
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        Error::from(error).into()
    }
}

/// A path as people type it.
fn shown(path: &Path) -> String {
    path.display().to_string()
}
