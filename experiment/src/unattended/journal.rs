//! Journal: the events of an experiment, one JSON line each, appended and never changed.
//!
//! A trial is finished if its `finished` line is whole. A line that was cut off by a crash does not count; the next run removes it.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::{Plan, Trial};

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
        for (index, record) in self.records.iter().enumerate() {
            let other = match &record.entry {
                Entry::Opened { plan, .. } => *plan != hash,
                Entry::Started { trial, .. }
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
