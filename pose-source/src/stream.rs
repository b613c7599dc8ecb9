//! A source in a thread of its own: bounded queue, order of stamps, stop flag.

use std::collections::VecDeque;
use std::io::{self, Read};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use calibrate::TrackOptions;
use swimmer_files::SwimmerFile;
use twin::TwinConfig;

use crate::twin_cameras::watch_twin;
use crate::{Frame, JsonLines, Mapping, SourceError, SourceName, natnet, recording_frames};

/// Frames that wait for the reader: a second at 240 Hz.
const QUEUE: usize = 256;
/// A source that waits looks at the stop flag so often.
const TURN: Duration = Duration::from_millis(50);
/// A stamp that goes back by more is a clock that was set, not a datagram that was overtaken \[s\].
const RESTART_S: f64 = 1.0;
/// Bytes read at once.
const CHUNK: usize = 8192;

/// Speed at which a recording or a twin is played.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pace {
    /// The recorded speed.
    #[default]
    Recorded,
    /// The speed of the reader; the time of reception is the stamp.
    Fast,
}

/// Options of a stream.
#[derive(Debug, Clone, Default)]
pub struct Settings {
    /// Axes and unit of any source; rate and likelihood of a recording.
    pub options: TrackOptions,
    /// Pace of a recording or a twin.
    pub pace: Pace,
}

impl Settings {
    /// The mapping of a live source.
    fn mapping(&self, usual: Mapping) -> Mapping {
        Mapping {
            axes: self.options.axes.unwrap_or(usual.axes),
            metres_per_unit: self
                .options
                .metres_per_unit
                .unwrap_or(usual.metres_per_unit),
        }
    }
}

/// Counts of a stream.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tallies {
    /// Lines or datagrams that could not be parsed.
    pub malformed: u64,
    /// The last of them, in words.
    pub last_malformed: Option<String>,
    /// Frames that were dropped because the reader was late.
    pub dropped: u64,
    /// Frames that came after a later one, and were dropped.
    pub out_of_order: u64,
    /// Number of times that the camera clock was set back.
    pub restarts: u64,
    /// The source, in words, once it has replied.
    pub description: Option<String>,
}

/// The result of a read.
#[derive(Debug)]
pub enum Received {
    /// A frame.
    Frame(Frame),
    /// No frame within the time.
    Nothing,
    /// The source has ended. Further reads return the same without the error.
    Ended(Result<(), SourceError>),
}

#[derive(Debug, Default)]
struct State {
    queue: VecDeque<Frame>,
    last_stamp_s: Option<f64>,
    tallies: Tallies,
    ended: bool,
    error: Option<SourceError>,
}

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
    stopped: AtomicBool,
    opened: Instant,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn stop(&self) {
        self.stopped.store(true, Ordering::SeqCst);
        self.changed.notify_all();
    }
}

/// The source's end of a stream.
#[derive(Debug, Clone)]
pub struct Outlet {
    shared: Arc<Shared>,
    /// A full queue makes the source wait; else its oldest frame is dropped.
    waits: bool,
}

impl Outlet {
    /// Time since the source was opened \[s\].
    pub fn now_s(&self) -> f64 {
        self.shared.opened.elapsed().as_secs_f64()
    }

    /// Returns `true` if the reader has gone.
    pub fn is_stopped(&self) -> bool {
        self.shared.stopped.load(Ordering::SeqCst)
    }

    /// Hands a frame over. A frame whose stamp is not later than the last one's is dropped, unless the clock was set back.
    pub fn send(&self, frame: Frame) {
        let mut state = self.shared.lock();
        if let Some(last_s) = state.last_stamp_s.filter(|last| frame.stamp_s <= *last) {
            if last_s - frame.stamp_s <= RESTART_S {
                state.tallies.out_of_order += 1;
                return;
            }
            state.tallies.restarts += 1;
        }
        state.last_stamp_s = Some(frame.stamp_s);
        while state.queue.len() >= QUEUE {
            if !self.waits {
                state.queue.pop_front();
                state.tallies.dropped += 1;
                continue;
            }
            if self.is_stopped() {
                return;
            }
            let waited = self.shared.changed.wait_timeout(state, TURN);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        state.queue.push_back(frame);
        drop(state);
        self.shared.changed.notify_all();
    }

    /// Says in words what the source is.
    pub fn describe(&self, text: String) {
        self.shared.lock().tallies.description = Some(text);
    }

    /// Sets the count of malformed lines or datagrams; `last` is called if it grew.
    pub(crate) fn note_malformed(&self, count: u64, last: impl FnOnce() -> String) {
        let mut state = self.shared.lock();
        if count > state.tallies.malformed {
            state.tallies.malformed = count;
            state.tallies.last_malformed = Some(last());
        }
    }

    /// Waits until `at_s`; returns `false` if the stream is stopped before.
    pub(crate) fn wait_until(&self, at_s: f64) -> bool {
        while !self.is_stopped() {
            let left_s = at_s - self.now_s();
            if left_s <= 0.0 {
                return true;
            }
            thread::sleep(Duration::from_secs_f64(left_s.min(TURN.as_secs_f64())));
        }
        false
    }
}

/// Reads and sends until it is stopped or the source ends.
pub type Reading = Box<dyn FnOnce(&Outlet) -> Result<(), SourceError> + Send>;

/// A source that runs. Dropped, it stops.
#[derive(Debug)]
pub struct Stream {
    shared: Arc<Shared>,
    /// `None` for standard input, whose read nothing can end.
    thread: Option<JoinHandle<()>>,
}

impl Stream {
    /// Opens a source. The twin is a robot at rest; [`watch_twin`] and [`Stream::spawn`] make others.
    ///
    /// # Errors
    /// [`SourceError`]: a file that cannot be read, a connection that is refused. Later errors arrive as
    /// [`Received::Ended`].
    pub fn open(name: &SourceName, settings: &Settings) -> Result<Self, SourceError> {
        match name {
            SourceName::NatNet(address) => {
                let (address, mapping) = (address.clone(), settings.mapping(Mapping::Y_UP));
                Self::spawn(
                    false,
                    Box::new(move |outlet| natnet::receive(outlet, &address, mapping)),
                )
            }
            SourceName::Tcp(address) => {
                let stream = connected(address)?;
                let mapping = settings.mapping(Mapping::Z_UP);
                Self::spawn(
                    false,
                    Box::new(move |outlet| {
                        lines(outlet, stream, mapping);
                        Ok(())
                    }),
                )
            }
            SourceName::StandardInput => {
                let mapping = settings.mapping(Mapping::Z_UP);
                // A pipe waits; frames of a script that is faster than the reader are not lost.
                let mut stream = Self::spawn(
                    true,
                    Box::new(move |outlet| {
                        lines(outlet, io::stdin(), mapping);
                        Ok(())
                    }),
                )?;
                stream.thread = None;
                Ok(stream)
            }
            SourceName::File(path) => {
                let recording = recording_frames(path, &settings.options)?;
                let pace = settings.pace;
                Self::spawn(
                    true,
                    Box::new(move |outlet| {
                        outlet.describe(recording.description().to_owned());
                        played(outlet, recording, pace);
                        Ok(())
                    }),
                )
            }
            SourceName::Twin => {
                let file = SwimmerFile::preset("robot")
                    .ok_or_else(|| SourceError::Twin("the preset `robot` is missing".to_owned()))?;
                let pace = settings.pace;
                let config = TwinConfig::new(&file, 1);
                Self::spawn(
                    true,
                    Box::new(move |outlet| watch_twin(outlet, config, pace)),
                )
            }
        }
    }

    /// Runs a source in a thread of its own. `waits`: a full queue makes the source wait; else its oldest frame is dropped.
    ///
    /// # Errors
    /// [`SourceError::Thread`].
    pub fn spawn(waits: bool, reading: Reading) -> Result<Self, SourceError> {
        let shared = Arc::new(Shared {
            state: Mutex::default(),
            changed: Condvar::new(),
            stopped: AtomicBool::new(false),
            opened: Instant::now(),
        });
        let outlet = Outlet {
            shared: Arc::clone(&shared),
            waits,
        };
        let thread = thread::Builder::new()
            .name("cameras".to_owned())
            .spawn(move || {
                let outcome = reading(&outlet);
                let mut state = outlet.shared.lock();
                state.ended = true;
                state.error = outcome.err();
                drop(state);
                outlet.shared.changed.notify_all();
            })
            .map_err(SourceError::Thread)?;
        Ok(Self {
            shared,
            thread: Some(thread),
        })
    }

    /// The next frame, waiting at most so long.
    pub fn next(&self, timeout: Duration) -> Received {
        let deadline = Instant::now() + timeout;
        let mut state = self.shared.lock();
        loop {
            if let Some(frame) = state.queue.pop_front() {
                drop(state);
                self.shared.changed.notify_all();
                return Received::Frame(frame);
            }
            if state.ended {
                return Received::Ended(state.error.take().map_or(Ok(()), Err));
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Received::Nothing;
            }
            let waited = self.shared.changed.wait_timeout(state, left);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Time since the source was opened \[s\]: the clock of [`Frame::received_s`].
    pub fn now_s(&self) -> f64 {
        self.shared.opened.elapsed().as_secs_f64()
    }

    /// Counts so far.
    pub fn tallies(&self) -> Tallies {
        self.shared.lock().tallies.clone()
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        self.shared.stop();
        if let Some(thread) = self.thread.take() {
            // A source that panicked has ended all the same.
            let _ = thread.join();
        }
    }
}

/// Connects within a few seconds, and reads in turns.
fn connected(address: &str) -> Result<TcpStream, SourceError> {
    let failed = |cause| SourceError::Socket {
        doing: format!("connecting to tcp:{address}"),
        cause,
        advice: "start the script that serves JSON lines there first",
    };
    let stream = TcpStream::connect(address).map_err(failed)?;
    stream.set_read_timeout(Some(TURN)).map_err(failed)?;
    Ok(stream)
}

/// JSON lines of any reader, to its end. A read that fails ends it too.
fn lines(outlet: &Outlet, mut reader: impl Read, mapping: Mapping) {
    let mut parser = JsonLines::new(mapping);
    let mut buffer = vec![0; CHUNK];
    while !outlet.is_stopped() {
        let count = match reader.read(&mut buffer) {
            Ok(0) => break,
            Ok(count) => count,
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock
                        | io::ErrorKind::TimedOut
                        | io::ErrorKind::Interrupted
                ) =>
            {
                continue;
            }
            Err(_) => break,
        };
        let bytes = buffer.get(..count).unwrap_or_default();
        parser.receive(bytes, outlet.now_s(), |frame| outlet.send(frame));
        note_lines(outlet, &parser);
    }
    parser.finish(outlet.now_s(), |frame| outlet.send(frame));
    note_lines(outlet, &parser);
}

fn note_lines(outlet: &Outlet, parser: &JsonLines) {
    outlet.note_malformed(parser.malformed(), || {
        parser.last_malformed().map_or_else(String::new, |last| {
            format!("line {}: {}", last.line, last.reason)
        })
    });
}

/// Frames with their stamps' pace.
fn played(outlet: &Outlet, frames: impl Iterator<Item = Frame>, pace: Pace) {
    let mut first_s = None;
    for mut frame in frames {
        match pace {
            Pace::Fast if outlet.is_stopped() => return,
            Pace::Fast => frame.received_s = frame.stamp_s,
            Pace::Recorded => {
                let begun_s = *first_s.get_or_insert(frame.stamp_s - outlet.now_s());
                if !outlet.wait_until(frame.stamp_s - begun_s) {
                    return;
                }
                frame.received_s = outlet.now_s();
            }
        }
        outlet.send(frame);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(stamp_s: f64) -> Frame {
        Frame {
            stamp_s,
            ..Frame::default()
        }
    }

    fn all(stream: &Stream) -> Vec<f64> {
        let mut stamps = Vec::new();
        loop {
            match stream.next(Duration::from_secs(20)) {
                Received::Frame(frame) => stamps.push(frame.stamp_s),
                Received::Ended(outcome) => {
                    outcome.unwrap();
                    return stamps;
                }
                Received::Nothing => panic!("nothing in 20 s"),
            }
        }
    }

    #[test]
    fn stamps_grow_unless_the_clock_was_set() {
        let stamps = [5.0, 5.01, 5.005, 5.01, 5.02, 1.0, 1.01];
        let stream = Stream::spawn(
            true,
            Box::new(move |outlet| {
                for stamp in stamps {
                    outlet.send(frame(stamp));
                }
                Ok(())
            }),
        )
        .unwrap();
        assert_eq!(all(&stream), [5.0, 5.01, 5.02, 1.0, 1.01]);
        let tallies = stream.tallies();
        assert_eq!((tallies.out_of_order, tallies.restarts), (2, 1));
    }

    #[test]
    fn a_live_source_drops_its_oldest_frames_and_a_recording_waits() {
        let count = QUEUE + 44;
        let run = |waits| {
            let (done, ran) = std::sync::mpsc::channel();
            let stream = Stream::spawn(
                waits,
                Box::new(move |outlet| {
                    for number in 0..count {
                        outlet.send(frame(number as f64));
                    }
                    let _ = done.send(());
                    Ok(())
                }),
            )
            .unwrap();
            if !waits {
                ran.recv().unwrap();
            }
            (all(&stream), stream.tallies().dropped)
        };
        let (kept, dropped) = run(false);
        assert_eq!((kept.len(), kept[0], dropped), (QUEUE, 44.0, 44));
        let (kept, dropped) = run(true);
        assert_eq!((kept.len(), dropped), (count, 0));
    }

    /// Dropping a stream ends its thread, also one that waits for its reader.
    #[test]
    fn a_dropped_stream_stops_its_source() {
        let (done, ran) = std::sync::mpsc::channel();
        let stream = Stream::spawn(
            true,
            Box::new(move |outlet| {
                let mut number = 0.0;
                while !outlet.is_stopped() {
                    outlet.send(frame(number));
                    number += 1.0;
                }
                let _ = done.send(());
                Ok(())
            }),
        )
        .unwrap();
        assert!(matches!(
            stream.next(Duration::from_secs(20)),
            Received::Frame(_)
        ));
        drop(stream);
        ran.recv_timeout(Duration::from_secs(20)).unwrap();
    }
}
