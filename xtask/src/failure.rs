//! Error of every chore: the activity, the reason of the failure, the next step for the user.

use std::fmt::Display;

/// Failure of a chore.
#[derive(Debug, thiserror::Error)]
#[error("{doing}: {why}\n  next: {next}")]
pub(crate) struct Failure {
    doing: String,
    why: String,
    next: String,
}

impl Failure {
    /// `doing` reads as an activity ("building the firmware"), `next` as an instruction.
    pub(crate) fn new(
        doing: impl Into<String>,
        why: impl Display,
        next: impl Into<String>,
    ) -> Self {
        Self {
            doing: doing.into(),
            why: why.to_string(),
            next: next.into(),
        }
    }
}

/// Result of a chore.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;
