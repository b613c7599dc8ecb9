//! `swimmer experiment status`: progress by the journal.

use std::fmt;

use experiment::adaptive::CampaignAdvice;
use serde::Serialize;

use super::ExperimentPaths;
use super::adaptive::{Campaign, in_words};
use super::folder::Folder;
use crate::failure::Outcome;
use crate::output::Output;

/// Report how many trials of an experiment are finished, and why it stands still
#[derive(Debug, clap::Args)]
pub(crate) struct Status {
    #[command(flatten)]
    paths: ExperimentPaths,
}

/// Progress of an experiment.
#[derive(Debug, Serialize)]
pub(crate) struct StatusOutput {
    folder: String,
    runs: usize,
    done: usize,
    given_up: usize,
    failed_attempts: usize,
    /// Next trial with its gait; `null` if none is left.
    next: Option<Next>,
    /// Reason for which the last run ended early; `null` if it did not.
    interruption: Option<String>,
    /// Fit so far and next gait of an adaptive campaign.
    #[serde(skip_serializing_if = "Option::is_none")]
    adaptive: Option<CampaignAdvice>,
}

#[derive(Debug, Serialize)]
struct Next {
    trial: u32,
    gait: String,
}

impl Status {
    pub(super) fn run(self, output: Output) -> Outcome {
        output.print(&status(&self.paths)?);
        Ok(())
    }
}

/// Progress of an experiment by its journal.
///
/// # Errors
/// A folder or a journal that cannot be read.
pub(crate) fn status(paths: &ExperimentPaths) -> Outcome<StatusOutput> {
    let folder = Folder::of(paths)?;
    let journal = folder.journal()?;
    let failures = folder.plan.trials.iter();
    Ok(StatusOutput {
        folder: folder.path.display().to_string(),
        runs: folder.plan.trials.len(),
        done: journal.finished().len(),
        given_up: journal.given_up().len(),
        failed_attempts: failures
            .map(|trial| journal.failures(trial.number) as usize)
            .sum(),
        next: journal.remaining(&folder.plan).first().map(|trial| Next {
            trial: trial.number,
            gait: trial.gait.clone(),
        }),
        interruption: journal.interruption().map(str::to_owned),
        adaptive: Campaign::of(&folder)?
            .map(|campaign| campaign.advice(&folder, &journal))
            .transpose()?,
    })
}

impl fmt::Display for StatusOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {} trials are finished", self.done, self.runs)?;
        if self.given_up > 0 {
            write!(f, ", {} are given up", self.given_up)?;
        }
        if self.failed_attempts > 0 {
            write!(f, ", {} attempts failed", self.failed_attempts)?;
        }
        match &self.next {
            None if self.adaptive.is_some() => f.write_str(".")?,
            Some(next) => write!(f, ".\nNext: trial {}, {}.", next.trial, next.gait)?,
            None => write!(
                f,
                ".\nNone is left; `swimmer experiment report` compares them."
            )?,
        }
        if let Some(advice) = &self.adaptive {
            write!(f, "\n{}", in_words(advice))?;
        }
        if let Some(reason) = &self.interruption {
            write!(f, "\nThe last run ended early: {reason}.")?;
        }
        Ok(())
    }
}
