//! The one error type of all operations.

use std::error::Error as StdError;

use forecast::ForecastError;
use swimmer_files::FileError;

/// Cause of a failure, from which exit codes and exception types derive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// The request, or a file that it names, cannot be used.
    BadInput,
    /// The request was valid, but computing or writing failed.
    Failed,
}

/// Failure of an operation. The message says what was being done, to what, and what to do next.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    /// Cause.
    pub kind: ErrorKind,
    /// Sentence for the user, with all causes.
    pub message: String,
    /// Details for experts.
    pub details: Option<String>,
}

impl Error {
    /// Input that cannot be used, with every cause that the error names.
    pub fn bad_input(error: &dyn StdError) -> Self {
        Self {
            kind: ErrorKind::BadInput,
            message: with_causes(error),
            details: None,
        }
    }

    /// A failed computation, with every cause that the error names.
    pub fn failed(error: &dyn StdError) -> Self {
        Self {
            kind: ErrorKind::Failed,
            message: with_causes(error),
            details: None,
        }
    }

    /// Input that cannot be used, in a sentence.
    pub fn refused(message: impl Into<String>) -> Self {
        Self {
            kind: ErrorKind::BadInput,
            message: message.into(),
            details: None,
        }
    }

    /// A computation without a result, in a sentence.
    pub fn unsuccessful(message: impl Into<String>) -> Self {
        Self {
            kind: ErrorKind::Failed,
            message: message.into(),
            details: None,
        }
    }

    /// Adds details for experts.
    pub(crate) fn with_details(self, details: Option<String>) -> Self {
        Self { details, ..self }
    }
}

/// The error and its causes in one line, without causes that their parent already quotes.
fn with_causes(error: &dyn StdError) -> String {
    let mut text = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        let cause_text = cause.to_string();
        if !text.contains(&cause_text) {
            text.push_str(": ");
            text.push_str(&cause_text);
        }
        next = cause.source();
    }
    text
}

impl From<Error> for String {
    /// The sentence for the user.
    fn from(error: Error) -> Self {
        error.message
    }
}

impl From<FileError> for Error {
    /// A file that cannot be read or is invalid is bad input; one that cannot be written is a failure.
    fn from(error: FileError) -> Self {
        match error {
            FileError::Write { .. } => Self::failed(&error),
            _ => Self::bad_input(&error),
        }
    }
}

impl From<ForecastError> for Error {
    /// A gait that no robot can play is bad input.
    fn from(error: ForecastError) -> Self {
        Self::bad_input(&error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, thiserror::Error)]
    #[error("cannot read track.csv")]
    struct Outer {
        source: std::io::Error,
    }

    #[derive(Debug, thiserror::Error)]
    #[error("cannot read track.csv: {source}")]
    struct Quoting {
        source: std::io::Error,
    }

    #[test]
    fn causes_are_named_once() {
        let cause = || std::io::Error::other("disk on fire");
        let expected = "cannot read track.csv: disk on fire";
        assert_eq!(Error::failed(&Outer { source: cause() }).message, expected);
        assert_eq!(
            Error::bad_input(&Quoting { source: cause() }).message,
            expected
        );
    }
}
