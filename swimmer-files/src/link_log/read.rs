//! Reads a link log record by record, with a bound on each record's size: a damaged length must not become an allocation.

use std::collections::HashMap;
use std::path::Path;

use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::frame::direction_of;
use super::{LinkFrame, LinkLogError};
use crate::FileError;

/// Larger than any chunk that a writer makes by default, small enough to allocate.
const LARGEST_RECORD: usize = 64 << 20;

/// What a link log holds.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkLog {
    /// In the order in which they were written.
    pub frames: Vec<LinkFrame>,
    /// Whether the log has its end. Without it whoever wrote it was killed, or the disk was full: the frames are those before.
    pub ended: bool,
}

/// Reads a link log, also one that was cut off.
///
/// # Errors
/// When the file cannot be read, is no MCAP file, or holds a message that is not a link frame.
pub fn read_link_log(path: &Path) -> Result<LinkLog, LinkLogError> {
    let bytes = std::fs::read(path).map_err(|source| FileError::Read {
        path: path.to_path_buf(),
        source,
    })?;
    if !bytes.starts_with(mcap::MAGIC) {
        return Err(LinkLogError::NoLinkLog {
            path: path.to_path_buf(),
            what: if bytes.is_empty() {
                "is empty"
            } else {
                "is another kind of file"
            },
        });
    }
    let container = |error| LinkLogError::container(path, &error);
    let options = LinearReaderOptions::default().with_record_length_limit(LARGEST_RECORD);
    let mut reader = LinearReader::new_with_options(options);
    let mut rest = bytes.as_slice();
    let mut directions = HashMap::new();
    let mut frames = Vec::new();
    let mut ended = true;
    while let Some(event) = reader.next_event() {
        let event = match event {
            // Nothing is wrong but that there is no more.
            Err(_) if !ended => break,
            event => event.map_err(container)?,
        };
        let (opcode, data) = match event {
            LinearReadEvent::ReadRequest(wanted) => {
                ended &= !rest.is_empty() || wanted == 0;
                let (piece, after) = rest.split_at(wanted.min(rest.len()));
                reader.insert(piece.len()).copy_from_slice(piece);
                reader.notify_read(piece.len());
                rest = after;
                continue;
            }
            LinearReadEvent::Record { data, opcode } => (opcode, data),
        };
        match mcap::parse_record(opcode, data).map_err(container)? {
            Record::Channel(channel) => {
                // Another program's topic in the same file is passed over.
                directions.insert(channel.id, direction_of(&channel.topic));
            }
            Record::Message { header, data } => {
                let Some(&Some(direction)) = directions.get(&header.channel_id) else {
                    continue;
                };
                let frame = LinkFrame::from_json(direction, &data).map_err(|problem| {
                    LinkLogError::Message {
                        path: path.to_path_buf(),
                        index: frames.len(),
                        problem,
                    }
                })?;
                frames.push(frame);
            }
            _ => {}
        }
    }
    Ok(LinkLog { frames, ended })
}
