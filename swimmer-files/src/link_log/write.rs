//! Writes a link log as it grows: whatever happens to the program or the disk, what was written stays and can be read.
//!
//! Frames go to the file in chunks of two seconds of the log's own time, each at once; so a log that is cut off ends with a
//! whole chunk, or with a piece of one, which the reader passes over.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::container::Container;
use super::{LinkFrame, LinkLogError};
use crate::FileError;
use crate::atomic::{Destination, destination, folder_of};

/// Writes a link log, which grows under its own name. Dropped before [`LinkLogWriter::finish`], it ends all the same; without a
/// single frame it leaves no file.
///
/// ```
/// use std::time::Duration;
/// use swimmer_files::{LinkLogWriter, read_link_log};
///
/// # let path = std::env::temp_dir().join(format!("link-log-{}.mcap", std::process::id()));
/// LinkLogWriter::create(&path)?.finish()?;
/// assert!(read_link_log(&path)?.frames.is_empty());
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), swimmer_files::LinkLogError>(())
/// ```
pub struct LinkLogWriter {
    /// Before the first frame.
    file: Option<File>,
    container: Option<Container<BufWriter<Growing>>>,
    path: PathBuf,
    /// `true` if the file existed before.
    replaces: bool,
}

/// A file that takes nothing more once it refused something: what the container's writer has still to say must not follow a piece
/// that is missing.
struct Growing {
    file: File,
    broken: bool,
}

impl Write for Growing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.broken {
            return Err(io::Error::other("it ended earlier"));
        }
        let written = self.file.write(bytes);
        self.broken = match &written {
            Ok(count) => *count == 0 && !bytes.is_empty(),
            Err(error) => error.kind() != io::ErrorKind::Interrupted,
        };
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Growing {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

impl LinkLogWriter {
    /// Starts a log. An existing file is replaced with the first frame.
    ///
    /// # Errors
    /// The file cannot be made in its folder.
    pub fn create(path: &Path) -> Result<Self, LinkLogError> {
        let write_error = |source| FileError::Write {
            path: path.to_path_buf(),
            source,
        };
        let place = match destination(path).map_err(write_error)? {
            Destination::File(place) => place,
            Destination::Stream => {
                return Err(write_error(io::Error::other("it is no file; name one")).into());
            }
        };
        folder_of(&place).map_err(write_error)?;
        let replaces = place.exists();
        let file = File::options()
            .write(true)
            .create(true)
            .truncate(false)
            .open(&place)
            .map_err(write_error)?;
        Ok(Self {
            file: Some(file),
            container: None,
            path: place,
            replaces,
        })
    }

    /// Writes the head, in place of what was there.
    fn begin(&mut self, file: File) -> mcap::McapResult<()> {
        file.set_len(0)?;
        let growing = Growing {
            file,
            broken: false,
        };
        self.container = Some(Container::begin(BufWriter::new(growing))?);
        Ok(())
    }

    fn begun(&mut self) -> Result<(), LinkLogError> {
        match self.file.take() {
            Some(file) => self
                .begin(file)
                .map_err(|error| LinkLogError::container(&self.path, &error)),
            None => Ok(()),
        }
    }

    /// Adds a frame as it crossed the wire, sound or not.
    ///
    /// # Errors
    /// A write error; the frames before are kept, and no further ones are accepted.
    pub fn write(&mut self, frame: &LinkFrame) -> Result<(), LinkLogError> {
        self.begun()?;
        self.container
            .as_mut()
            .map_or(Ok(()), |container| container.write(frame))
            .map_err(|error| LinkLogError::container(&self.path, &error))
    }

    /// Ends the log.
    ///
    /// # Errors
    /// A write error; the frames before are kept.
    pub fn finish(mut self) -> Result<(), LinkLogError> {
        self.begun()?;
        let Some(container) = self.container.take() else {
            return Ok(());
        };
        let written = container
            .finish()
            .map_err(|error| LinkLogError::container(&self.path, &error))?;
        let write_error = |source| FileError::Write {
            path: self.path.clone(),
            source,
        };
        let growing = written
            .into_inner()
            .map_err(|error| write_error(error.into_error()))?;
        Ok(growing.file.sync_all().map_err(write_error)?)
    }
}

impl Drop for LinkLogWriter {
    fn drop(&mut self) {
        if self.file.is_some() && !self.replaces {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}
