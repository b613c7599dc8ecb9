//! `swimmer experiment`: gaits × repeats in randomised blocks, unattended, resumable, compared.

mod adaptive;
mod campaign;
mod folder;
mod gaits;
mod pack;
mod plan;
mod report;
mod run;
mod status;

pub(crate) use self::plan::plan;
pub(crate) use self::report::report;
pub(crate) use self::run::play;
pub(crate) use self::status::status;

use std::path::PathBuf;

use clap::Subcommand;

use crate::failure::Outcome;
use crate::output::Output;

/// Run an experiment unattended: gaits × repeats in randomised blocks, tracked, resumable, compared
///
/// A spec (TOML) names swimmer, tank, start pose and gaits. `plan` computes the gaits and fixes the order of the trials, `run` plays
/// them one after the other, each from the start pose, and may be killed and begun again at any time, `report` compares what was
/// measured with the prediction, and each optimum with its neighbours. `pack` makes one archive of everything.
#[derive(Debug, Subcommand)]
pub(crate) enum Experiment {
    Plan(plan::PlanSpec),
    Run(Box<run::RunPlan>),
    Status(status::Status),
    Report(report::ReportPlan),
    Pack(pack::Pack),
}

/// Spec, and the folder of its experiment.
#[derive(Debug, clap::Args)]
pub(crate) struct ExperimentPaths {
    /// The spec of the experiment
    #[arg(value_name = "SPEC.toml")]
    spec: PathBuf,
    /// Folder of the experiment; left out: named as the spec, next to it
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

impl ExperimentPaths {
    /// Spec, and its folder if that is not named as the spec.
    pub(crate) fn new(spec: PathBuf, output: Option<PathBuf>) -> Self {
        Self { spec, output }
    }

    fn folder(&self) -> PathBuf {
        self.output
            .clone()
            .unwrap_or_else(|| self.spec.with_extension(""))
    }
}

impl Experiment {
    /// Runs the subcommand.
    pub(crate) fn run(self, output: Output) -> Outcome {
        match self {
            Self::Plan(plan) => plan.run(output),
            Self::Run(run) => run.run(output),
            Self::Status(status) => status.run(output),
            Self::Report(report) => report.run(output),
            Self::Pack(pack) => pack.run(output),
        }
    }
}
