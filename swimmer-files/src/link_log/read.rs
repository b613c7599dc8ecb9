//! Reads a link log record by record, also one that was cut off.

use std::path::Path;

use link_protocol::Direction;
use mcap::MAGIC;

use super::frame::direction_of;
use super::records::{CHANNEL, CHUNK, FOOTER, MESSAGE, Records, channel, message, of_chunk};
use super::{LinkFrame, LinkLogError};
use crate::FileError;

/// Contents of a link log.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkLog {
    /// In the order in which they were written.
    pub frames: Vec<LinkFrame>,
    /// `true` if the log has its end record. Without it the writer was killed, or the disk was full; all complete frames are
    /// read.
    pub ended: bool,
}

/// Reads a link log, also one that was cut off.
///
/// # Errors
/// The file cannot be read, is no MCAP file, or holds a message that is not a link frame.
pub fn read_link_log(path: &Path) -> Result<LinkLog, LinkLogError> {
    let bytes = std::fs::read(path).map_err(|source| FileError::Read {
        path: path.to_path_buf(),
        source,
    })?;
    parse_link_log(&bytes, path)
}

/// The same of a log's bytes; `path` is for messages.
///
/// # Errors
/// As [`read_link_log`].
///
/// ```
/// use swimmer_files::{link_log_bytes, parse_link_log};
///
/// let bytes = link_log_bytes(&[])?;
/// assert!(parse_link_log(&bytes, "link.mcap".as_ref())?.ended);
/// assert!(!parse_link_log(&bytes[..20], "link.mcap".as_ref())?.ended);
/// # Ok::<(), swimmer_files::LinkLogError>(())
/// ```
pub fn parse_link_log(bytes: &[u8], path: &Path) -> Result<LinkLog, LinkLogError> {
    let Some(records) = bytes.strip_prefix(MAGIC) else {
        return Err(LinkLogError::NoLinkLog {
            path: path.to_path_buf(),
            what: if bytes.is_empty() {
                "is empty"
            } else {
                "is another kind of file"
            },
        });
    };
    let mut reading = Reading {
        path,
        topics: Vec::new(),
        frames: Vec::new(),
    };
    let mut records = Records(records);
    let ended = loop {
        match records.next() {
            Some((FOOTER, _)) => break records.0.starts_with(MAGIC),
            Some((CHUNK, chunk)) => {
                let chunk = of_chunk(chunk).map_err(|problem| reading.damaged(problem))?;
                for (opcode, record) in Records(&chunk) {
                    reading.take(opcode, record)?;
                }
            }
            Some((opcode, record)) => reading.take(opcode, record)?,
            None => break false,
        }
    };
    Ok(LinkLog {
        frames: reading.frames,
        ended,
    })
}

/// Reader state with the frames read so far.
struct Reading<'a> {
    path: &'a Path,
    /// Channels that hold frames; another program's topics in the same file are passed over.
    topics: Vec<(u16, Direction)>,
    frames: Vec<LinkFrame>,
}

impl Reading<'_> {
    fn take(&mut self, opcode: u8, record: &[u8]) -> Result<(), LinkLogError> {
        let damaged = |what: &str| format!("{what} is damaged");
        match opcode {
            CHANNEL => {
                let (number, topic) =
                    channel(record).ok_or_else(|| self.damaged(damaged("a channel")))?;
                if let Some(direction) = direction_of(topic) {
                    self.topics.push((number, direction));
                }
            }
            MESSAGE => {
                let (number, json) =
                    message(record).ok_or_else(|| self.damaged(damaged("a message")))?;
                let Some((_, direction)) = self.topics.iter().find(|(known, _)| *known == number)
                else {
                    return Ok(());
                };
                let frame = LinkFrame::from_json(*direction, json);
                self.frames
                    .push(frame.map_err(|problem| LinkLogError::Message {
                        path: self.path.to_path_buf(),
                        index: self.frames.len(),
                        problem,
                    })?);
            }
            _ => {}
        }
        Ok(())
    }

    fn damaged(&self, problem: String) -> LinkLogError {
        LinkLogError::Container {
            path: self.path.to_path_buf(),
            problem,
        }
    }
}
