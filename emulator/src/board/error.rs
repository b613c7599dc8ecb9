//! Errors of the emulated board.

use std::path::PathBuf;

/// Failure to start or to run the emulated board.
#[derive(Debug, thiserror::Error)]
pub enum EmulatorError {
    /// A required file is missing.
    #[error("the emulated board cannot start: {what} is not at {path}; {advice}")]
    Missing {
        /// Description of the file.
        what: &'static str,
        /// Expected path.
        path: PathBuf,
        /// Command that creates the file.
        advice: &'static str,
    },
    /// Node could not be started.
    #[error("the emulated board cannot start: running `node`: {0}; install Node.js 18 or newer")]
    Node(#[source] std::io::Error),
    /// The process ended unexpectedly.
    #[error("the emulated board ended while it was asked to `{command}`: {why}")]
    Gone {
        /// Command that was running.
        command: String,
        /// Known reason.
        why: String,
    },
    /// The emulator reported an error.
    #[error("the emulated board failed while it was asked to `{command}`:\n{why}")]
    Failed {
        /// Command that was running.
        command: String,
        /// Error text of the emulator.
        why: String,
    },
}
