//! `swimmer sweep submit`: a sweep put to the scheduler that is there.

use std::path::PathBuf;
use std::process::Command;

use clap::Subcommand;
use operations::sweep::SubmitOutput;
use sweep::{Plan, Slurm, time_limit};
use swimmer_files::{FileError, write_atomically};

use super::shown;
use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;
use crate::output::Output;
use crate::quantity::Rows;

/// Put a sweep to a cluster's scheduler
#[derive(Debug, Subcommand)]
pub(crate) enum Submit {
    Slurm(SlurmJob),
}

/// Write the script of a Slurm job array, one shard a task, and submit it with --submit
///
/// Its time limit follows the cost of the designs so far, so run a few blocks first (`swimmer sweep run`, stopped after a while),
/// or give --time. A task whose node is lost is requeued and skips finished blocks.
#[derive(Debug, clap::Args)]
pub(crate) struct SlurmJob {
    /// The folder of the plan, on a disk that every node sees
    folder: PathBuf,
    /// Shards, each a task of the job array
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    shards: u64,
    /// Cores of each
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1024))]
    cores: u64,
    /// Time limit of each, in minutes; by default from the cost of the designs so far
    #[arg(long, value_name = "MINUTES", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    time: Option<u64>,
    /// One more option of sbatch, as --option=--partition=short; may be given several times
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    option: Vec<String>,
    /// The script to write; by default DIR/slurm.sh
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Hand the script to sbatch
    #[arg(long)]
    submit: bool,
}

impl Submit {
    pub(super) fn run(self, output: Output) -> Outcome {
        let Self::Slurm(job) = self;
        job.run(output)
    }
}

impl SlurmJob {
    fn run(self, output: Output) -> Outcome {
        let plan = Plan::load(&self.folder)?;
        let absolute = |path: &PathBuf| {
            std::path::absolute(path).map_err(|source| FileError::Read {
                path: path.clone(),
                source,
            })
        };
        let folder = absolute(&self.folder)?;
        let given = self.output.is_some();
        let script = self.output.unwrap_or_else(|| self.folder.join("slurm.sh"));
        if given {
            may_be_written(&script)?;
        }
        if let Some(line) = self.option.iter().find(|option| option.contains('\n')) {
            return Err(Failure::BadInput(format!(
                "an option of sbatch is one line, and {line:?} is more"
            )));
        }
        let status = sweep::status(&plan, &folder)?;
        let minutes = self
            .time
            .or_else(|| time_limit(&status, self.shards, self.cores));
        let minutes = minutes.ok_or_else(|| {
            Failure::BadInput(format!(
                "nothing was timed yet, so the time limit is not known: say --time MINUTES, or run a few blocks first with \
                 `swimmer sweep run {}` and stop it",
                shown(&self.folder)
            ))
        })?;
        let program = std::env::current_exe().map_err(|source| FileError::Read {
            path: PathBuf::from("swimmer"),
            source,
        })?;
        let text = Slurm {
            shards: self.shards,
            cores: self.cores,
            minutes,
            program: &program,
            folder: &folder,
            options: &self.option,
        }
        .script(&plan);
        write_atomically(&script, text.as_bytes())?;
        let job = if self.submit {
            Some(submitted(&script)?)
        } else {
            None
        };
        let submitted = SubmitOutput {
            tasks: status.tasks,
            done: status.done,
            failed: status.failed,
            shards: self.shards,
            cores: self.cores,
            minutes,
            script,
            job,
        };
        output.rendered(&submitted, &rows(&submitted));
        Ok(())
    }
}

/// The job's number, which `sbatch` prints.
fn submitted(script: &PathBuf) -> Outcome<String> {
    let ran = Command::new("sbatch")
        .arg("--parsable")
        .arg(script)
        .output();
    let ran = ran.map_err(|error| {
        Failure::Tried(format!(
            "cannot run sbatch: {error}; submit {} where Slurm is installed",
            script.display()
        ))
    })?;
    if !ran.status.success() {
        return Err(Failure::Tried(format!(
            "sbatch refused {}: {}",
            script.display(),
            String::from_utf8_lossy(&ran.stderr).trim()
        )));
    }
    let said = String::from_utf8_lossy(&ran.stdout);
    Ok(said.trim().split(';').next().unwrap_or_default().to_owned())
}

/// Output as text.
fn rows(output: &SubmitOutput) -> Rows {
    let mut rows = Rows::default();
    rows.row("script", shown(&output.script))
        .row(
            "array",
            format!(
                "{} tasks of {} cores, {} min each",
                output.shards, output.cores, output.minutes
            ),
        )
        .row(
            "designs",
            format!("{} of {} done", output.done, output.tasks),
        );
    match &output.job {
        Some(job) => rows.row("submitted as", job),
        None => rows.row("next", format!("sbatch {}", shown(&output.script))),
    };
    rows
}
