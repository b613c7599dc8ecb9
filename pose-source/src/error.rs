//! Reasons why a source gives no frames, or a recording cannot be written.

use std::io;
use std::path::PathBuf;

use calibrate::TrackError;

use crate::natnet::NatNetError;

/// Error of a source.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// The NatNet server refused, or what it sends cannot be read.
    #[error(transparent)]
    NatNet(#[from] NatNetError),
    /// A socket could not be opened, or failed.
    #[error("{doing}: {cause}; {advice}")]
    Socket {
        /// The operation and its address.
        doing: String,
        /// The system's words.
        cause: io::Error,
        /// Next step for the user.
        advice: &'static str,
    },
    /// A recording is not a tracking file, or is broken.
    #[error(transparent)]
    Track(#[from] Box<TrackError>),
    /// A recording could not be read.
    #[error("reading {}: {cause}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's words.
        cause: io::Error,
    },
    /// A recording has lengths in pixels, or in an unknown unit.
    #[error("{}: the lengths are in {unit}; give the metres per unit with --scale", path.display())]
    Unit {
        /// The file.
        path: PathBuf,
        /// The unit.
        unit: String,
    },
    /// An MCAP file without frames of cameras.
    #[error("{}: {reason}", path.display())]
    Mcap {
        /// The file.
        path: PathBuf,
        /// Reason of the failure.
        reason: String,
    },
    /// The digital twin could not be started.
    #[error("starting the twin's cameras: {0}")]
    Twin(String),
    /// The thread of a source could not be started.
    #[error("starting the thread of a source: {0}")]
    Thread(io::Error),
}

/// Error of writing a recording.
#[derive(Debug, thiserror::Error)]
#[error("writing the recording {}: {cause}; does its folder exist, and is the disk full?", path.display())]
pub struct RecordError {
    /// The file.
    pub path: PathBuf,
    /// The cause.
    pub cause: String,
}
