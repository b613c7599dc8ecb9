//! Writes frames to a file while they come.
//!
//! A CSV file has the record lines of Motive 1.1: any number of points per frame, whole after every line, read by `calibrate`. An MCAP
//! file has one JSON message per frame, on the topic `/cameras/frame`, in the format of JSON lines.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};

use crate::{Frame, RecordError, json_lines};

/// Topic of frames in an MCAP file.
pub(crate) const TOPIC: &str = "/cameras/frame";
const SCHEMA_NAME: &str = "swimmer.CameraFrame";
const SCHEMA: &str = include_str!("frame.schema.json");
/// Number of frames between flushes to the disk.
const FLUSH_EVERY: u64 = 50;
/// Numbers of unlabeled points without a number begin here.
const FIRST_UNLABELED: i64 = 1 << 32;

/// A recording in the making. Dropped before [`finish`](Self::finish), it ends with the last frames that were written.
pub struct Recorder {
    path: PathBuf,
    format: Format,
    frames: u64,
}

enum Format {
    Csv(Box<Csv>),
    Mcap {
        writer: Box<Writer<BufWriter<File>>>,
        channel: u16,
    },
}

/// A CSV file. Its head defines bodies, so it is written after the first frames.
struct Csv {
    writer: csv::Writer<BufWriter<File>>,
    /// The first frames; `None` once the head is written.
    held: Option<Vec<Frame>>,
    frames: u64,
    /// Numbers of named points.
    numbers: BTreeMap<String, i64>,
}

impl Recorder {
    /// Starts a file at `path`, in place of what is there, in the format of its extension: `.csv` or `.mcap`; `None` for any other.
    ///
    /// # Errors
    /// [`RecordError`]: nothing can be written there.
    pub fn create(path: &Path) -> Result<Option<Self>, RecordError> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let file = || {
            File::create(path)
                .map(BufWriter::new)
                .map_err(|cause| failed(path, &cause))
        };
        let format = match extension.to_str() {
            Some("csv") => Format::csv(file()?),
            Some("mcap") => Format::mcap(file()?).map_err(|cause| failed(path, &cause))?,
            _ => return Ok(None),
        };
        Ok(Some(Self {
            path: path.to_path_buf(),
            format,
            frames: 0,
        }))
    }

    /// Frames that were written.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`RecordError`]; what was written before stays.
    pub fn write(&mut self, frame: &Frame) -> Result<(), RecordError> {
        let number = self.frames;
        let flush = (number + 1).is_multiple_of(FLUSH_EVERY);
        let written = match &mut self.format {
            Format::Csv(csv) => csv.push(frame, flush).map_err(|error| error.to_string()),
            Format::Mcap { writer, channel } => {
                let header = MessageHeader {
                    channel_id: *channel,
                    sequence: u32::try_from(number).unwrap_or(u32::MAX),
                    log_time: nanoseconds(frame.received_s),
                    publish_time: nanoseconds(frame.stamp_s),
                };
                writer
                    .write_to_known_channel(&header, json_lines::line_of(frame).as_bytes())
                    .and_then(|()| if flush { writer.flush() } else { Ok(()) })
                    .map_err(|error| error.to_string())
            }
        };
        written.map_err(|cause| failed(&self.path, &cause))?;
        self.frames += 1;
        Ok(())
    }

    /// Ends the file; returns how many frames it has.
    ///
    /// # Errors
    /// [`RecordError`]; what was written before stays.
    pub fn finish(mut self) -> Result<u64, RecordError> {
        let finished = match &mut self.format {
            Format::Csv(csv) => csv.finish().map_err(|error| error.to_string()),
            Format::Mcap { writer, .. } => writer
                .finish()
                .map(|_| ())
                .map_err(|error| error.to_string()),
        };
        finished.map_err(|cause| failed(&self.path, &cause))?;
        Ok(self.frames)
    }
}

fn failed(path: &Path, cause: &impl ToString) -> RecordError {
    RecordError {
        path: path.to_path_buf(),
        cause: cause.to_string(),
    }
}

impl Format {
    fn csv(file: BufWriter<File>) -> Self {
        Self::Csv(Box::new(Csv {
            writer: csv::WriterBuilder::new().flexible(true).from_writer(file),
            held: Some(Vec::new()),
            frames: 0,
            numbers: BTreeMap::new(),
        }))
    }

    fn mcap(file: BufWriter<File>) -> mcap::McapResult<Self> {
        let mut writer = WriteOptions::new()
            .compression(None)
            // A chunk is written when it is whole, so that a file that is cut off can be read.
            .disable_seeking(true)
            .profile("")
            .library(concat!("pose-source ", env!("CARGO_PKG_VERSION")))
            .create(file)?;
        let schema = writer.add_schema(SCHEMA_NAME, "jsonschema", SCHEMA.as_bytes())?;
        let channel = writer.add_channel(schema, TOPIC, "json", &BTreeMap::new())?;
        Ok(Self::Mcap {
            writer: Box::new(writer),
            channel,
        })
    }
}

impl Csv {
    fn push(&mut self, frame: &Frame, flush: bool) -> csv::Result<()> {
        match &mut self.held {
            Some(held) => held.push(frame.clone()),
            None => self.record(frame)?,
        }
        if flush {
            self.begin()?;
            self.writer.flush()?;
        }
        Ok(())
    }

    /// Writes the head, with the bodies of the first frames, and these frames.
    fn begin(&mut self) -> csv::Result<()> {
        let Some(held) = self.held.take() else {
            return Ok(());
        };
        self.writer
            .write_record(["comment", "swimmer track: metres, Z up"])?;
        self.writer.write_record(["righthanded"])?;
        self.writer.write_record(["info", "version", "1.1"])?;
        let bodies = held.iter().flat_map(|frame| &frame.bodies);
        let names: BTreeMap<i64, Option<&String>> =
            bodies.map(|body| (body.id, body.name.as_ref())).collect();
        for (id, name) in names {
            let name = name.map_or_else(|| format!("body {id}"), ToString::to_string);
            self.writer
                .write_record(["rigidbody", &name, &id.to_string(), "0"])?;
        }
        held.iter().try_for_each(|frame| self.record(frame))
    }

    fn finish(&mut self) -> csv::Result<()> {
        self.begin()?;
        self.writer.flush()?;
        Ok(self.writer.get_ref().get_ref().sync_all()?)
    }

    /// A frame: index, time, bodies with position, quaternion and Euler angles, markers with position, number and name.
    fn record(&mut self, frame: &Frame) -> csv::Result<()> {
        let mut fields = vec![
            "frame".to_owned(),
            self.frames.to_string(),
            format!("{:.6}", frame.stamp_s),
            frame.bodies.len().to_string(),
        ];
        for body in &frame.bodies {
            fields.push(body.id.to_string());
            fields.extend(body.position.map(|value| format!("{value:.6}")));
            fields.extend(body.quaternion.map(|value| format!("{value:.8}")));
            let heading = format!("{:.6}", body.heading_rad().to_degrees());
            // Yaw, pitch and roll, of which a body in the tank has only the first.
            fields.extend([heading, String::from("0"), String::from("0")]);
        }
        fields.push(frame.markers.len().to_string());
        let mut unlabeled = FIRST_UNLABELED;
        for marker in &frame.markers {
            fields.extend(marker.position().map(|value| format!("{value:.6}")));
            let (number, name) = if let Some(name) = &marker.name {
                (self.number_of(name), name.clone())
            } else {
                let own = marker.id.map(|id| FIRST_UNLABELED.saturating_add(id));
                let number = own.unwrap_or(unlabeled);
                unlabeled += 1;
                (number, format!("Marker-{}", number - FIRST_UNLABELED))
            };
            fields.extend([number.to_string(), name]);
        }
        self.frames += 1;
        self.writer.write_record(fields)
    }

    fn number_of(&mut self, name: &str) -> i64 {
        if let Some(number) = self.numbers.get(name) {
            return *number;
        }
        let number = i64::try_from(self.numbers.len()).map_or(i64::MAX, |count| count + 1);
        self.numbers.insert(name.to_owned(), number);
        number
    }
}

impl Drop for Csv {
    /// Writes the buffered frames, so that an error elsewhere does not lose them.
    fn drop(&mut self) {
        let _ = self.begin();
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}
