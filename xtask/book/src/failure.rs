//! Error of the book builder: the failed step and its reason.

/// Failed step and its reason.
#[derive(Debug, thiserror::Error)]
#[error("{doing}: {why}")]
pub(crate) struct Failure {
    doing: String,
    why: String,
}

/// Result of a step.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    pub(crate) fn new(doing: impl Into<String>, why: impl std::fmt::Display) -> Self {
        Self {
            doing: doing.into(),
            why: why.to_string(),
        }
    }

    /// Combines failures of one kind, one per line.
    pub(crate) fn all(doing: impl Into<String>, whys: &[String]) -> Outcome {
        if whys.is_empty() {
            return Ok(());
        }
        Err(Self::new(doing, format!("\n  {}", whys.join("\n  "))))
    }
}
