//! What can go wrong: what was being done, and why it did not work.

/// One sentence for whoever builds the book.
#[derive(Debug, thiserror::Error)]
#[error("{doing}: {why}")]
pub(crate) struct Failure {
    doing: String,
    why: String,
}

/// The result of every step.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    pub(crate) fn new(doing: impl Into<String>, why: impl std::fmt::Display) -> Self {
        Self {
            doing: doing.into(),
            why: why.to_string(),
        }
    }

    /// Several of one kind, each on a line.
    pub(crate) fn all(doing: impl Into<String>, whys: &[String]) -> Outcome {
        if whys.is_empty() {
            return Ok(());
        }
        Err(Self::new(doing, format!("\n  {}", whys.join("\n  "))))
    }
}
