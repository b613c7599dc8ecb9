//! Journal: the events of an experiment, one JSON line each, appended and never changed.
//!
//! A trial is finished if its `finished` line is whole. A line that was cut off by a crash does not count; the next run removes it.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::{Plan, Trial};
use crate::adaptive::MeasuredTrial;

/// Line of the journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Seconds since 1970 at which it was written.
    pub at_unix_s: f64,
    /// Event.
    pub entry: Entry,
}

/// Event of an experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Entry {
    /// A run began or went on.
    Opened {
        /// SHA-256 of the plan.
        plan: String,
        /// Version of the program.
        version: String,
        /// Link log of this run.
        log: Option<String>,
    },
    /// A trial began: the robot is on its way to the start pose.
    Started {
        /// Number of the trial.
        trial: u32,
        /// Attempt, from 1.
        attempt: u32,
    },
    /// A trial is finished; its track is stored.
    Finished {
        /// Number of the trial.
        trial: u32,
        /// Attempt, from 1.
        attempt: u32,
        /// Track file in the folder of the experiment.
        track: String,
        /// Start of the first cycle on the clock of the poses \[s\].
        began_s: f64,
        /// Measured cycles, without those of the run-in.
        cycles: Vec<MeasuredCycle>,
        /// Departure from the prediction, in words.
        departure: Option<String>,
    },
    /// An attempt failed; the trial is repeated.
    Failed {
        /// Number of the trial.
        trial: u32,
        /// Attempt, from 1.
        attempt: u32,
        /// Reason.
        reason: String,
    },
    /// A trial is given up after its last attempt.
    GivenUp {
        /// Number of the trial.
        trial: u32,
    },
    /// An adaptive campaign chose its next trial.
    Chosen {
        /// Number of the trial.
        trial: u32,
        /// Its gait.
        gait: String,
    },
    /// The track of a finished trial of an adaptive campaign was measured.
    Measured {
        /// Number of the trial.
        trial: u32,
        /// Its quantities; `None` if the track cannot be used.
        quantities: Option<TrialQuantities>,
        /// Reason for which it cannot be used.
        problem: Option<String>,
    },
    /// The run ended early; another run goes on.
    Interrupted {
        /// Reason.
        reason: String,
    },
    /// All trials are finished or given up.
    Complete,
}

/// Measured net motion of a cycle in the frame of the middle link at its start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeasuredCycle {
    /// x \[m\].
    pub x_m: f64,
    /// y \[m\].
    pub y_m: f64,
    /// Net turn \[rad\].
    pub turn_rad: f64,
    /// Half width of the 95 % interval of x and y by the noise of the cameras \[m\].
    pub interval_m: f64,
}

/// Quantities of a trial by which χ and r_s are fitted: means over its cycles, with their standard errors by the scatter of the cycles
/// (`None` for a single cycle).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrialQuantities {
    /// X \[m\].
    pub x_m: f64,
    /// Standard error of X \[m\].
    pub x_se_m: Option<f64>,
    /// ΔY \[m\].
    pub delta_y_m: f64,
    /// Standard error of ΔY \[m\].
    pub delta_y_se_m: Option<f64>,
    /// Δθ \[rad\].
    pub delta_theta_rad: f64,
    /// Standard error of Δθ \[rad\].
    pub delta_theta_se_rad: Option<f64>,
}

/// Invalid journal.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum JournalError {
    /// A line before the last one cannot be read.
    #[error(
        "line {line} of the journal cannot be read: {problem}; restore the file from a copy, or plan a new experiment"
    )]
    Damaged {
        /// Line, from 1.
        line: usize,
        /// Problem.
        problem: String,
    },
    /// It belongs to another plan.
    #[error(
        "line {line} of the journal belongs to another plan; run each plan in a folder of its own"
    )]
    OtherPlan {
        /// Line, from 1.
        line: usize,
    },
}

/// Events so far.
///
/// ```
/// use experiment::unattended::{Entry, Journal};
///
/// let mut bytes = Journal::line(1.0, &Entry::Started { trial: 1, attempt: 1 });
/// let whole = bytes.len();
/// bytes.extend(Journal::line(2.0, &Entry::GivenUp { trial: 1 }));
/// bytes.truncate(bytes.len() - 3); // kill -9 while writing
/// let journal = Journal::parse(&bytes).unwrap();
/// assert_eq!((journal.records.len(), journal.valid_bytes), (1, whole));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Journal {
    /// Records in their order.
    pub records: Vec<Record>,
    /// Length of the whole lines \[bytes\]. The rest was cut off by a crash.
    pub valid_bytes: usize,
}

impl Journal {
    /// One line of the file, with its end.
    pub fn line(at_unix_s: f64, entry: &Entry) -> Vec<u8> {
        let record = Record {
            at_unix_s,
            entry: entry.clone(),
        };
        // Numbers and texts always have a JSON form.
        let mut line = serde_json::to_vec(&record).unwrap_or_default();
        line.push(b'\n');
        line
    }

    /// Reads a journal. A last line that is not whole is passed over.
    ///
    /// # Errors
    /// [`JournalError::Damaged`] for any other line.
    pub fn parse(bytes: &[u8]) -> Result<Self, JournalError> {
        let mut journal = Self::default();
        let mut rest = bytes;
        while let Some(length) = rest.iter().position(|byte| *byte == b'\n') {
            let (line, after) = rest.split_at(length + 1);
            match serde_json::from_slice::<Record>(line) {
                Ok(record) => journal.records.push(record),
                // Blocks that a crash left unwritten read as zeros.
                Err(_) if after.is_empty() => break,
                Err(error) => {
                    return Err(JournalError::Damaged {
                        line: journal.records.len() + 1,
                        problem: error.to_string(),
                    });
                }
            }
            journal.valid_bytes += line.len();
            rest = after;
        }
        Ok(journal)
    }

    /// Checks that all runs were of this plan.
    ///
    /// # Errors
    /// [`JournalError::OtherPlan`].
    pub fn check(&self, plan: &Plan) -> Result<(), JournalError> {
        let hash = plan.sha256();
        let plan = plan.with_chosen(self);
        for (index, record) in self.records.iter().enumerate() {
            let other = match &record.entry {
                Entry::Opened { plan, .. } => *plan != hash,
                Entry::Chosen { gait, .. } => {
                    plan.gaits.iter().all(|planned| planned.name != *gait)
                }
                Entry::Measured { trial, .. }
                | Entry::Started { trial, .. }
                | Entry::Finished { trial, .. }
                | Entry::Failed { trial, .. }
                | Entry::GivenUp { trial } => plan.trial(*trial).is_none(),
                Entry::Interrupted { .. } | Entry::Complete => false,
            };
            if other {
                return Err(JournalError::OtherPlan { line: index + 1 });
            }
        }
        Ok(())
    }

    /// Numbers of the finished trials.
    pub fn finished(&self) -> BTreeSet<u32> {
        let finished = self.records.iter().filter_map(|record| match record.entry {
            Entry::Finished { trial, .. } => Some(trial),
            _ => None,
        });
        finished.collect()
    }

    /// Numbers of the trials that were given up.
    pub fn given_up(&self) -> BTreeSet<u32> {
        let given_up = self.records.iter().filter_map(|record| match record.entry {
            Entry::GivenUp { trial } => Some(trial),
            _ => None,
        });
        given_up.collect()
    }

    /// Attempts that failed since the last finished trial of the present run.
    pub fn failures_in_a_row(&self) -> u32 {
        let is_reset = |entry: &Entry| {
            matches!(
                entry,
                Entry::Opened { .. } | Entry::Finished { .. } | Entry::Interrupted { .. }
            )
        };
        let latest = self.records.iter().rev().map(|record| &record.entry);
        let failed = latest
            .take_while(|entry| !is_reset(entry))
            .filter(|entry| matches!(entry, Entry::Failed { .. }));
        failed.fold(0, |failures, _| failures + 1)
    }

    /// Trials that an adaptive campaign has chosen, with their gaits.
    pub fn chosen(&self) -> impl Iterator<Item = (u32, &str)> {
        self.records
            .iter()
            .filter_map(|record| match &record.entry {
                Entry::Chosen { trial, gait } => Some((*trial, gait.as_str())),
                _ => None,
            })
    }

    /// Trials of an adaptive campaign whose tracks were measured; `None` for a track that cannot be used.
    pub fn quantities(&self) -> BTreeMap<u32, Option<TrialQuantities>> {
        let measured = self
            .records
            .iter()
            .filter_map(|record| match &record.entry {
                Entry::Measured {
                    trial, quantities, ..
                } => Some((*trial, *quantities)),
                _ => None,
            });
        measured.collect()
    }

    /// Measured trials of an adaptive campaign; the index of a gait is that in the plan.
    pub fn measured_trials(&self, plan: &Plan) -> Vec<MeasuredTrial> {
        let plan = plan.with_chosen(self);
        let quantities = self.quantities();
        let measured = plan.trials.iter().filter_map(|trial| {
            let candidate = plan.gaits.iter().position(|gait| gait.name == trial.gait)?;
            let of = quantities.get(&trial.number)?;
            let nan = [f64::NAN; 3];
            let (values, standard_errors) = of.map_or((nan, nan), |of| {
                let errors = [of.x_se_m, of.delta_y_se_m, of.delta_theta_se_rad];
                (
                    [of.x_m, of.delta_y_m, of.delta_theta_rad],
                    errors.map(|error| error.unwrap_or(f64::NAN)),
                )
            });
            Some(MeasuredTrial {
                candidate,
                values,
                standard_errors,
            })
        });
        measured.collect()
    }

    /// Track file of a finished trial, in the folder of the experiment.
    pub fn track(&self, number: u32) -> Option<&str> {
        self.records.iter().find_map(|record| match &record.entry {
            Entry::Finished { trial, track, .. } if *trial == number => Some(track.as_str()),
            _ => None,
        })
    }

    /// Trials of a plan that are neither finished nor given up, in their order.
    pub fn remaining<'a>(&self, plan: &'a Plan) -> Vec<&'a Trial> {
        let (finished, given_up) = (self.finished(), self.given_up());
        let is_left =
            |trial: &&Trial| !finished.contains(&trial.number) && !given_up.contains(&trial.number);
        plan.trials.iter().filter(is_left).collect()
    }

    /// Attempts of each trial that began.
    pub fn attempts(&self) -> BTreeMap<u32, u32> {
        let mut attempts = BTreeMap::new();
        for record in &self.records {
            if let Entry::Started { trial, attempt } = record.entry {
                let last = attempts.entry(trial).or_insert(0);
                *last = attempt.max(*last);
            }
        }
        attempts
    }

    /// Failed attempts of a trial. One that a crash or an interruption cut off is not a failure.
    pub fn failures(&self, trial: u32) -> u32 {
        let failed = self.records.iter().filter(
            |record| matches!(record.entry, Entry::Failed { trial: number, .. } if number == trial),
        );
        u32::try_from(failed.count()).unwrap_or(u32::MAX)
    }

    /// Measured cycles of each finished trial.
    pub fn measured(&self) -> BTreeMap<u32, &[MeasuredCycle]> {
        let measured = self
            .records
            .iter()
            .filter_map(|record| match &record.entry {
                Entry::Finished { trial, cycles, .. } => Some((*trial, cycles.as_slice())),
                _ => None,
            });
        measured.collect()
    }

    /// Reason for which the last run ended early; `None` if it is under way, was killed or is complete.
    pub fn interruption(&self) -> Option<&str> {
        match &self.records.last()?.entry {
            Entry::Interrupted { reason } => Some(reason),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An adaptive campaign runs its trials one by one: failures of one trial count for the next, but not for another run.
    #[test]
    fn failures_in_a_row_are_counted_over_the_trials_of_a_run() {
        let failed = |trial| Entry::Failed {
            trial,
            attempt: 1,
            reason: String::new(),
        };
        let opened = Entry::Opened {
            plan: String::new(),
            version: String::new(),
            log: None,
        };
        let finished = Entry::Finished {
            trial: 2,
            attempt: 1,
            track: String::new(),
            began_s: 0.0,
            cycles: Vec::new(),
            departure: None,
        };
        let interrupted = Entry::Interrupted {
            reason: String::new(),
        };
        let mut journal = Journal::default();
        for (entry, expected) in [
            (failed(1), 1),
            (Entry::GivenUp { trial: 1 }, 1),
            (failed(2), 2),
            (finished, 0),
            (failed(3), 1),
            (interrupted, 0),
            (failed(3), 1),
            (opened, 0),
        ] {
            let (at_unix_s, text) = (0.0, format!("{entry:?}"));
            journal.records.push(Record { at_unix_s, entry });
            assert_eq!(journal.failures_in_a_row(), expected, "{text}");
        }
    }

    #[test]
    fn a_damaged_line_in_the_middle_is_refused() {
        let mut bytes = Journal::line(0.0, &Entry::Complete);
        bytes.extend(b"{\"entry\":\"what\"}\n");
        let torn = Journal::parse(&bytes).unwrap();
        assert_eq!(torn.records.len(), 1, "the last line may be torn");
        bytes.extend(Journal::line(0.0, &Entry::Complete));
        let error = Journal::parse(&bytes).unwrap_err();
        assert!(
            matches!(error, JournalError::Damaged { line: 2, .. }),
            "{error}"
        );
    }
}
