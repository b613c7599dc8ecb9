//! One kind of error for every chore: what was being done, why it failed, what to do next.

use std::fmt::Display;

/// A chore that failed.
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

/// What every chore returns.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;
