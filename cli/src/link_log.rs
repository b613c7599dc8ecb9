//! Frames seen on a port, as the link log keeps them: each with the host's clock and, once a ping has come back, the robot's.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use host_link::port::TracedFrame;
use host_link::session::{ClockFit, ClockSamples};
use link_protocol::{Decoder, Direction, Message};
use swimmer_files::{LinkFrame, LinkLogError, LinkLogWriter};

use crate::failure::{Failure, Outcome};
use crate::interrupt::locked;
use crate::new_file::may_be_written;
use crate::output::aside;

/// Callback of a traced port for its frames.
pub(crate) type Sink = Box<dyn FnMut(TracedFrame<'_>) + Send>;

/// Writes a link log while others talk, frame by frame under its own name. Dropped before [`Recorder::finish`], it ends all the
/// same, unless nothing crossed the link: what led to a failure is what a log is for.
pub(crate) struct Recorder(Arc<Mutex<Recording>>);

struct Recording {
    path: PathBuf,
    /// `true` to print its path at the end.
    announced: bool,
    writer: Option<LinkLogWriter>,
    frames: u64,
    failed: Option<LinkLogError>,
    samples: ClockSamples,
    clock: Option<ClockFit>,
}

impl Recorder {
    /// Starts a log.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the file exists, [`Failure::Tried`] where it cannot be made.
    pub(crate) fn create(path: &Path) -> Outcome<Self> {
        may_be_written(path)?;
        Ok(Self(Arc::new(Mutex::new(Recording {
            path: path.to_path_buf(),
            announced: false,
            writer: Some(LinkLogWriter::create(path)?),
            frames: 0,
            failed: None,
            samples: ClockSamples::default(),
            clock: None,
        }))))
    }

    /// The same, which says where it is at its end: for a log that outlasts the command.
    pub(crate) fn announced(self) -> Self {
        locked(&self.0).announced = true;
        self
    }

    /// Callback that records the frames of a port. `epoch` is the time of day at the origin of the port's clock, since 1970; zero
    /// for a port in virtual time.
    pub(crate) fn sink(&self, epoch: Duration) -> Sink {
        let recording = Arc::clone(&self.0);
        Box::new(move |frame| locked(&recording).add(&frame, epoch))
    }

    /// Ends the log and says where it is; returns the number of frames.
    ///
    /// # Errors
    /// The disk refused a frame or the end.
    pub(crate) fn finish(self) -> Outcome<u64> {
        let mut recording = locked(&self.0);
        let finished = recording.finish();
        finished.map_err(Failure::from)?;
        if recording.announced {
            recording.tell();
        }
        Ok(recording.frames)
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        let mut recording = locked(&self.0);
        if recording.frames == 0 {
            // Never finished, it leaves no file.
            recording.writer = None;
        }
        if recording.writer.is_some() {
            match recording.finish() {
                Ok(()) if recording.announced => {
                    recording.tell();
                }
                Ok(()) => {}
                Err(error) => aside(&Failure::from(error).to_string()),
            }
        }
    }
}

impl Recording {
    fn add(&mut self, frame: &TracedFrame<'_>, epoch: Duration) {
        let Some(writer) = &mut self.writer else {
            return;
        };
        let reported_us = match (frame.direction, message(frame.bytes)) {
            (Direction::ToHost, Some(Message::Pong(pong))) => {
                self.samples.push(&pong, frame.at);
                self.clock = self.samples.fit();
                Some(pong.sent_us)
            }
            (Direction::ToHost, Some(Message::Telemetry(telemetry))) => Some(telemetry.robot_us),
            _ => None,
        };
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        // saturates; a robot is up for less than 2^53 µs
        let estimated = self
            .clock
            .map(|clock| (clock.robot_time(frame.at).max(0.0) * 1e6) as u64);
        let frame = LinkFrame {
            direction: frame.direction,
            host_time_ns: u64::try_from((epoch + frame.at).as_nanos()).unwrap_or(u64::MAX),
            robot_time_us: reported_us.or(estimated),
            bytes: frame.bytes.to_vec(),
        };
        if self.failed.is_none() {
            match writer.write(&frame) {
                Ok(()) => self.frames += 1,
                Err(error) => {
                    aside(&format!("warning: the link log ends here: {error}"));
                    self.failed = Some(error);
                }
            }
        }
    }

    fn tell(&self) {
        let (frames, path) = (self.frames, self.path.display());
        aside(&format!("The link log is in {path}: {frames} frames."));
    }

    fn finish(&mut self) -> Result<(), LinkLogError> {
        let writer = self.writer.take();
        match (self.failed.take(), writer) {
            (Some(error), _) => Err(error),
            (None, Some(writer)) => writer.finish(),
            (None, None) => Ok(()),
        }
    }
}

/// The message of a frame, if the frame is valid.
fn message(bytes: &[u8]) -> Option<Message> {
    let mut decoder = Decoder::new();
    bytes
        .iter()
        .find_map(|&byte| decoder.push(byte))
        .and_then(|received| received.message.ok())
}

impl From<LinkLogError> for Failure {
    fn from(error: LinkLogError) -> Self {
        match error {
            LinkLogError::File(error) => error.into(),
            other => Self::tried(&other),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_without_frames_leaves_nothing_unless_finished() {
        let folder = tempfile::tempdir().unwrap();
        let left = || std::fs::read_dir(folder.path()).unwrap().count();
        let path = folder.path().join("z.mcap");
        drop(Recorder::create(&path).unwrap().announced());
        assert_eq!(left(), 0);
        let recorder = Recorder::create(&path).unwrap();
        recorder.sink(Duration::ZERO)(TracedFrame {
            direction: Direction::ToRobot,
            at: Duration::ZERO,
            bytes: &[1, 2, 3],
        });
        drop(recorder);
        assert!(path.exists() && left() == 1);
        assert!(Recorder::create(&path).is_err());
    }
}
