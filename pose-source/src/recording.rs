//! Frames of a recording: every format that `calibrate` reads, and MCAP files that [`Recorder`](crate::Recorder) wrote.

use std::fs::{self, File};
use std::path::Path;

use calibrate::{PointKind, TrackFile, TrackFormat, TrackOptions, Unit, read_tracks_with};
use swimmer_files::Axes;

use crate::recorder::TOPIC;
use crate::{Frame, JsonLines, Mapping, Marker, SourceError};

/// A recording as a sequence of frames.
#[derive(Debug)]
pub struct RecordedFrames {
    description: String,
    held: Held,
}

#[derive(Debug)]
enum Held {
    Tracks {
        file: Box<TrackFile>,
        mapping: Mapping,
        /// Kinds of points that are listed: measured ones if there are any.
        measured: bool,
        row: usize,
    },
    Frames(std::vec::IntoIter<Frame>),
}

/// Reads a recording.
///
/// # Errors
/// [`SourceError`]: no tracking file, a broken one, or one whose unit is unknown.
pub fn recording_frames(
    path: &Path,
    options: &TrackOptions,
) -> Result<RecordedFrames, SourceError> {
    let failed = |cause| SourceError::Read {
        path: path.to_path_buf(),
        cause,
    };
    let mut begin = [0; mcap::MAGIC.len()];
    let mut file = File::open(path).map_err(failed)?;
    let is_mcap = std::io::Read::read_exact(&mut file, &mut begin).is_ok() && begin == *mcap::MAGIC;
    if is_mcap {
        return mcap_frames(path, &fs::read(path).map_err(failed)?);
    }
    let file = File::open(path).map_err(failed)?;
    let file = read_tracks_with(file, path, options).map_err(Box::new)?;
    if matches!(file.unit, Unit::Pixel | Unit::Unknown) {
        return Err(SourceError::Unit {
            path: path.to_path_buf(),
            unit: match file.unit {
                Unit::Pixel => "pixels".to_owned(),
                _ => "an unknown unit".to_owned(),
            },
        });
    }
    let mapping = Mapping {
        axes: file.axes.unwrap_or_else(|| flattest(&file)),
        // `calibrate` has converted lengths already.
        metres_per_unit: 1.0,
    };
    Ok(RecordedFrames {
        description: format!("{}, {} frames", file.format, file.frames()),
        held: Held::Tracks {
            measured: file.points.iter().any(|point| point.kind.is_measured()),
            file: Box::new(file),
            mapping,
            row: 0,
        },
    })
}

/// Axes of the tank's plane: across the axis along which points move least. Motive's default, Y up, holds unless another axis is
/// clearly flatter; a file of two dimensions has no height.
fn flattest(file: &TrackFile) -> Axes {
    /// Times that the variance along another axis must be less.
    const CLEARLY: f64 = 4.0;
    let mut variance = [0.0; 3];
    let measured = file.points.iter().filter(|p| p.kind.is_measured());
    for point in measured {
        let places: Vec<_> = (0..file.frames())
            .filter_map(|row| point.position(row))
            .collect();
        for (axis, sum) in variance.iter_mut().enumerate() {
            let values = || places.iter().map(|place| place[axis]);
            let mean = values().sum::<f64>() / places.len().max(1) as f64;
            *sum += values().map(|value| (value - mean).powi(2)).sum::<f64>();
        }
    }
    let [x, y, z] = variance;
    let least = x.min(y).min(z);
    let from_motive = matches!(
        file.format,
        TrackFormat::Motive(_) | TrackFormat::MotiveWithoutHeader | TrackFormat::TrackingTools
    );
    let usual = if from_motive { 1 } else { 2 };
    let up = if variance.get(usual).is_some_and(|v| *v <= CLEARLY * least) {
        usual
    } else {
        (0..3)
            .min_by(|a, b| {
                let of = |axis: &usize| variance.get(*axis).copied().unwrap_or(f64::MAX);
                of(a).total_cmp(&of(b))
            })
            .unwrap_or(2)
    };
    Axes {
        x: ((up + 1) % 3, false),
        y: ((up + 2) % 3, false),
    }
}

fn mcap_frames(path: &Path, bytes: &[u8]) -> Result<RecordedFrames, SourceError> {
    let wrong = |reason: String| SourceError::Mcap {
        path: path.to_path_buf(),
        reason,
    };
    let messages =
        mcap::MessageStream::new_with_options(bytes, mcap::read::Options::IgnoreEndMagic.into())
            .map_err(|error| wrong(error.to_string()))?;
    let mut frames = Vec::new();
    let mut lines = JsonLines::new(Mapping::Z_UP);
    for message in messages {
        // A file that was cut off ends with its last whole chunk.
        let Ok(message) = message else {
            break;
        };
        if message.channel.topic == TOPIC {
            let received_s = message.log_time as f64 * 1e-9;
            lines.receive(&message.data, received_s, |frame| frames.push(frame));
            lines.finish(received_s, |frame| frames.push(frame));
        }
    }
    if let Some(malformed) = lines.last_malformed() {
        return Err(wrong(format!(
            "frame {} is malformed: {}",
            malformed.line, malformed.reason
        )));
    }
    if frames.is_empty() {
        return Err(wrong(format!(
            "no frames of cameras (topic {TOPIC}); was it written by `swimmer track`?"
        )));
    }
    Ok(RecordedFrames {
        description: format!("mcap, {} frames", frames.len()),
        held: Held::Frames(frames.into_iter()),
    })
}

impl RecordedFrames {
    /// Format and length, in words.
    pub fn description(&self) -> &str {
        &self.description
    }
}

impl Iterator for RecordedFrames {
    type Item = Frame;

    fn next(&mut self) -> Option<Frame> {
        match &mut self.held {
            Held::Frames(frames) => frames.next(),
            Held::Tracks {
                file,
                mapping,
                measured,
                row,
            } => {
                let stamp_s = *file.times.get(*row)?;
                let points = file.points.iter().filter(|point| {
                    if *measured {
                        point.kind.is_measured()
                    } else {
                        point.kind != PointKind::Other
                    }
                });
                let markers = points.filter_map(|point| {
                    let [x_m, y_m, z_m] = mapping.position(point.position(*row)?.into());
                    Some(Marker {
                        name: (point.kind != PointKind::Unlabeled).then(|| point.name.clone()),
                        id: point.id.parse().ok(),
                        x_m,
                        y_m,
                        z_m,
                    })
                });
                let frame = Frame {
                    stamp_s,
                    received_s: stamp_s,
                    latency_s: None,
                    markers: markers.collect(),
                    bodies: Vec::new(),
                };
                *row += 1;
                Some(frame)
            }
        }
    }
}
