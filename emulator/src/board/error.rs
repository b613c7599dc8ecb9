//! Why an emulated board cannot start or go on.

use std::path::PathBuf;

/// Why the emulated board does not do what it was told.
#[derive(Debug, thiserror::Error)]
pub enum EmulatorError {
    /// Something that a start needs is not there.
    #[error("the emulated board cannot start: {what} is not at {path}; {advice}")]
    Missing {
        /// What.
        what: &'static str,
        /// Where it was looked for.
        path: PathBuf,
        /// What to do.
        advice: &'static str,
    },
    /// Node could not be started.
    #[error("the emulated board cannot start: running `node`: {0}; install Node.js 18 or newer")]
    Node(#[source] std::io::Error),
    /// The process went away.
    #[error("the emulated board ended while it was asked to `{command}`: {why}")]
    Gone {
        /// What it was asked.
        command: String,
        /// What is known.
        why: String,
    },
    /// The emulation itself failed.
    #[error("the emulated board failed while it was asked to `{command}`:\n{why}")]
    Failed {
        /// What it was asked.
        command: String,
        /// Its own words.
        why: String,
    },
}
