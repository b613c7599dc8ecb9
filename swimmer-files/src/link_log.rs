//! The link log: every frame that crossed the serial link, both ways, in an MCAP file.
//!
//! MCAP is read by Foxglove, by the `mcap` Python package and by many others. Two topics, `/link/to_robot` and
//! `/link/from_robot`; each message is JSON after the JSON schema `swimmer.LinkFrame` that the file carries: host time, robot
//! time if it is known, the decoded header and message if the frame is valid, and the raw bytes in hexadecimal, so that nothing
//! depends on this program's decoder. A third topic, `/robot/telemetry`, repeats the telemetry frames in SI units for plots; a
//! fourth, `/robot/scene`, shows the swimmer in Foxglove's 3D panel (`foxglove.SceneUpdate`). Both are written for people and
//! never read back.
//!
//! Foxglove reads no schema with alternatives, so every field has one type and what is not known is left out.

mod container;
mod frame;
mod plays;
mod read;
mod records;
mod scene;
mod write;

use std::path::{Path, PathBuf};

pub use frame::LinkFrame;
pub use plays::{Play, plays};
pub use read::{LinkLog, parse_link_log, read_link_log};
pub use write::LinkLogWriter;

use crate::FileError;
use container::Container;

/// A whole link log as the bytes of its file, for who has frames and no disk.
///
/// # Errors
/// [`LinkLogError::Container`] where the container's writer refuses a frame.
///
/// ```
/// let empty = swimmer_files::link_log_bytes(&[])?;
/// assert!(empty.starts_with(b"\x89MCAP"));
/// # Ok::<(), swimmer_files::LinkLogError>(())
/// ```
pub fn link_log_bytes(frames: &[LinkFrame]) -> Result<Vec<u8>, LinkLogError> {
    let written = || {
        let mut container = Container::begin(std::io::Cursor::new(Vec::new()))?;
        frames.iter().try_for_each(|frame| container.write(frame))?;
        container.finish()
    };
    let place = Path::new("in memory");
    let bytes = written().map_err(|error| LinkLogError::container(place, &error))?;
    Ok(bytes.into_inner())
}

/// Error of writing or reading a link log.
#[derive(Debug, thiserror::Error)]
pub enum LinkLogError {
    /// The file itself.
    #[error(transparent)]
    File(#[from] FileError),
    /// Nothing that a link log begins with.
    #[error(
        "{} is no link log: it {what}; a link log is the MCAP file of `swimmer robot log` or of --log",
        path.display()
    )]
    NoLinkLog {
        /// The file.
        path: PathBuf,
        /// Description of the file's contents.
        what: &'static str,
    },
    /// The MCAP container.
    #[error("the link log {}: {problem}", path.display())]
    Container {
        /// The log.
        path: PathBuf,
        /// Message of the container's reader or writer, in one line.
        problem: String,
    },
    /// A message in it is not a link frame.
    #[error("the link log {}, message {index}: {problem}", path.display())]
    Message {
        /// The log.
        path: PathBuf,
        /// Counted from 0 in the order of the file.
        index: usize,
        /// Reason why it is refused.
        problem: String,
    },
}

impl LinkLogError {
    fn container(path: &Path, error: &mcap::McapError) -> Self {
        Self::Container {
            path: path.to_path_buf(),
            problem: error.to_string(),
        }
    }
}
