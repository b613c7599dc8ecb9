//! What can go wrong with a sweep.

use std::path::PathBuf;

use swimmer_files::FileError;

/// Why a sweep could not be planned, run, merged or mapped.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A file of it could not be read or written, or what stands in it cannot be meant.
    #[error(transparent)]
    File(#[from] FileError),
    /// The folder holds another plan.
    #[error(
        "{} holds the plan {there}, not {ours}: a plan never changes, so name another folder", folder.display()
    )]
    OtherPlan {
        /// The folder.
        folder: PathBuf,
        /// The hash of the plan that is there.
        there: String,
        /// The hash of the one to be written.
        ours: String,
    },
    /// The folder is not empty, and what is in it is no sweep.
    #[error("the folder {} is not empty and holds no plan; name another one with -o, or empty it", folder.display())]
    Taken {
        /// The folder.
        folder: PathBuf,
    },
    /// The plan's text is not what its hash says.
    #[error(
        "{} was changed after it was made: its text no longer has the hash in its first line; plan again, into a new folder",
        path.display()
    )]
    Changed {
        /// The plan.
        path: PathBuf,
    },
    /// The plan was made by another version, whose answers may differ.
    #[error("{} was made by version {theirs}, this is {ours}: run it with that version, or plan again", path.display())]
    OtherVersion {
        /// The plan.
        path: PathBuf,
        /// Its version.
        theirs: String,
        /// Ours.
        ours: String,
    },
    /// Blocks are missing or broken.
    #[error(
        "{missing} of {blocks} blocks are not there or not whole (the first is block {first}): run the rest with `swimmer sweep run`, \
         which passes over what is finished"
    )]
    Unfinished {
        /// How many.
        missing: u64,
        /// Of so many.
        blocks: u64,
        /// The lowest.
        first: u64,
    },
    /// A table could not be written.
    #[error("cannot write the table {}: {problem}", path.display())]
    Table {
        /// The table.
        path: PathBuf,
        /// What the writer said.
        problem: String,
    },
    /// No map can be drawn of this plan.
    #[error("no map can be drawn: {0}")]
    NoMap(String),
}

impl SweepError {
    /// Whether what was asked for makes no sense, rather than that it did not work.
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
