//! Errors of sweeps.

use std::path::PathBuf;

use swimmer_files::FileError;

/// Failure to plan, run, merge or map a sweep.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A file of the sweep could not be read or written, or its content is invalid.
    #[error(transparent)]
    File(#[from] FileError),
    /// The folder holds another plan.
    #[error(
        "{} holds the plan {there}, not {ours}: a plan never changes, so name another folder", folder.display()
    )]
    OtherPlan {
        /// The folder.
        folder: PathBuf,
        /// Hash of the existing plan.
        there: String,
        /// Hash of the plan to be written.
        ours: String,
    },
    /// The folder is not empty and does not contain a sweep.
    #[error("the folder {} is not empty and holds no plan; name another one with -o, or empty it", folder.display())]
    Taken {
        /// The folder.
        folder: PathBuf,
    },
    /// The text of the plan does not match its hash.
    #[error(
        "{} was changed after it was made: its text no longer has the hash in its first line; plan again, into a new folder",
        path.display()
    )]
    Changed {
        /// The plan.
        path: PathBuf,
    },
    /// The plan was written by another version, whose results may differ.
    #[error("{} was made by version {theirs}, this is {ours}: run it with that version, or plan again", path.display())]
    OtherVersion {
        /// The plan.
        path: PathBuf,
        /// Version that wrote the plan.
        theirs: String,
        /// Version of this program.
        ours: String,
    },
    /// Blocks are missing or damaged.
    #[error(
        "{missing} of {blocks} blocks are not there or not whole (the first is block {first}): run the rest with `swimmer sweep run`, \
         which passes over what is finished"
    )]
    Unfinished {
        /// Number of missing blocks.
        missing: u64,
        /// Number of blocks of the plan.
        blocks: u64,
        /// Lowest missing block.
        first: u64,
    },
    /// A table could not be written.
    #[error("cannot write the table {}: {problem}", path.display())]
    Table {
        /// The table.
        path: PathBuf,
        /// Error of the writer.
        problem: String,
    },
    /// The plan cannot be mapped; the text is the reason.
    #[error("no map can be drawn: {0}")]
    NoMap(String),
}

impl SweepError {
    /// Returns `true` if the request is invalid, and `false` if a valid request failed.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::File(error) => !matches!(error, FileError::Write { .. }),
            Self::OtherPlan { .. }
            | Self::Taken { .. }
            | Self::Changed { .. }
            | Self::OtherVersion { .. }
            | Self::NoMap(_) => true,
            Self::Unfinished { .. } | Self::Table { .. } => false,
        }
    }
}
