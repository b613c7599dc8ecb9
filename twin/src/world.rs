//! World outside the robot's board: servos, tank and cameras, from event to event. Twin and emulated board both use it; their
//! inputs are the pulses and the start of each cycle.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_model::{InvalidSwimmer, Pose};

use crate::camera::{Camera, CameraConfig, Frame, MotiveFile, TrackError};
use crate::config::TwinConfig;
use crate::servos::Servos;
use crate::tank::Tank;

const FRAME_US: u64 = 1_000_000 / Camera::RATE_HZ as u64;
/// Frames that wait to be taken: ten seconds.
const MOST_FRAMES: usize = 10 * Camera::RATE_HZ as usize;

/// Start of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleStart {
    /// Time on the twin's clock: the tick whose flash the cameras record.
    pub at: Duration,
    /// True pose of the robot at that time, in the tank's frame.
    pub pose: Pose<f64>,
}

/// Finished recording of the cameras.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Path of the tracking file.
    pub path: PathBuf,
    /// Number of frames.
    pub frames: u64,
    /// Time of frame 0 on the twin's clock.
    pub started: Duration,
    /// Cycles that began during the recording.
    pub cycle_starts: Vec<CycleStart>,
}

/// Cameras that are on.
#[derive(Debug)]
struct Cameras {
    camera: Camera,
    next_frame_us: u64,
    recorder: Option<Recorder>,
}

/// A recording under way.
#[derive(Debug)]
struct Recorder {
    file: MotiveFile,
    started_us: u64,
    cycle_starts: Vec<CycleStart>,
    failed: Option<TrackError>,
}

/// Servos and links of a robot in a tank under cameras.
///
/// ```
/// use std::time::Duration;
/// use swimmer_files::SwimmerFile;
/// use twin::{TwinConfig, World};
///
/// let mut world = World::new(&TwinConfig::new(&SwimmerFile::preset("robot").unwrap(), 1))?;
/// let before = world.pose();
/// world.advance(Duration::from_secs(1));
/// assert_eq!((world.now(), world.pose()), (Duration::from_secs(1), before), "without pulses nothing moves");
/// # Ok::<(), swimmer_model::InvalidSwimmer>(())
/// ```
#[derive(Debug)]
pub struct World {
    servos: Servos,
    tank: Tank,
    now_us: u64,
    reach: f64,
    camera: CameraConfig,
    seed: u64,
    recordings: u64,
    cameras: Option<Cameras>,
    /// Frames that wait to be taken; `None` without an observer.
    watched: Option<VecDeque<(Duration, Frame)>>,
    cycle_starts: Vec<CycleStart>,
}

impl World {
    /// Returns a straight robot at time zero, with position and heading from its seed.
    ///
    /// # Errors
    /// Lengths and drags form no valid swimmer, or one whose drag the robot's settings cannot hold.
    pub fn new(config: &TwinConfig) -> Result<Self, InvalidSwimmer> {
        config
            .swimmer
            .common_drag()
            .map_err(InvalidSwimmer::Uncommon)?;
        let mut rng = ChaCha8Rng::seed_from_u64(config.seed);
        rng.set_stream(3);
        let mut draw = |largest: f64| rng.random_range(-largest..largest);
        let pose = Pose::new(draw(0.2), draw(0.2), draw(std::f64::consts::PI));
        let tank = Tank::new(&config.swimmer, pose)?.with_current(config.current);
        let tank = match config.passive {
            Some(passive) => tank.with_spring(passive),
            None => tank,
        };
        Ok(Self {
            servos: Servos::new(config.shafts, config.plant),
            tank,
            now_us: 0,
            reach: 0.5 * config.swimmer.links.middle,
            camera: config.camera.clone(),
            seed: config.seed,
            recordings: 0,
            cameras: None,
            watched: None,
            cycle_starts: Vec::new(),
        })
    }

    /// Clock of the world.
    pub fn now(&self) -> Duration {
        Duration::from_micros(self.now_us)
    }

    /// Clock of the world in whole µs.
    pub(crate) fn now_us(&self) -> u64 {
        self.now_us
    }

    /// True pose of the robot, in the tank's frame.
    pub fn pose(&self) -> Pose<f64> {
        self.tank.pose()
    }

    /// True joint angles, rad.
    pub fn angles(&self) -> [f64; 2] {
        self.tank.phi().into()
    }

    /// Sets new pulses of the servos, ns, or switches them off.
    pub fn set_pulses(&mut self, pulses_ns: Option<[u32; 2]>) {
        self.servos.set_pulses(pulses_ns);
    }

    /// Records the start of a cycle: the flash that the cameras record.
    pub fn begin_cycle(&mut self) {
        let start = CycleStart {
            at: self.now(),
            pose: self.tank.pose(),
        };
        self.cycle_starts.push(start);
        if let Some(recorder) = self.recorder_mut() {
            recorder.cycle_starts.push(start);
        }
    }

    /// Cycles that have begun so far.
    pub fn cycle_starts(&self) -> &[CycleStart] {
        &self.cycle_starts
    }

    /// Starts a recording with the next frame (frames come every 10 ms of the world's clock) into a tracking file at `path`. An
    /// earlier recording ends.
    ///
    /// # Errors
    /// [`TrackError`] if the file cannot be written.
    pub fn start_recording(&mut self, path: &Path) -> Result<(), TrackError> {
        let (seed, number) = (self.seed, self.recordings);
        let file = MotiveFile::create(path, &self.camera, seed)?;
        let started_us = self.now_us.next_multiple_of(FRAME_US);
        self.recordings += 1;
        self.cameras = Some(Cameras {
            camera: Camera::new(self.camera.clone(), self.reach, seed, number),
            next_frame_us: started_us,
            recorder: Some(Recorder {
                file,
                started_us,
                cycle_starts: Vec::new(),
                failed: None,
            }),
        });
        Ok(())
    }

    /// From the next frame on, keeps frames for [`take_frames`](Self::take_frames). A recording under way, or one that is started
    /// later, holds the same frames.
    ///
    /// ```
    /// use std::time::Duration;
    /// use swimmer_files::SwimmerFile;
    /// use twin::{TwinConfig, World};
    ///
    /// let mut world = World::new(&TwinConfig::new(&SwimmerFile::preset("robot").unwrap(), 1))?;
    /// world.watch();
    /// world.advance(Duration::from_millis(45));
    /// let stamps: Vec<u128> = world.take_frames().map(|(stamp, _)| stamp.as_millis()).collect();
    /// assert_eq!(stamps, [0, 10, 20, 30, 40]);
    /// # Ok::<(), swimmer_model::InvalidSwimmer>(())
    /// ```
    pub fn watch(&mut self) {
        self.watched.get_or_insert_default();
        if self.cameras.is_none() {
            self.cameras = Some(self.unrecorded_cameras());
        }
    }

    fn unrecorded_cameras(&mut self) -> Cameras {
        let number = self.recordings;
        self.recordings += 1;
        Cameras {
            camera: Camera::new(self.camera.clone(), self.reach, self.seed, number),
            next_frame_us: self.now_us.next_multiple_of(FRAME_US),
            recorder: None,
        }
    }

    /// Frames that were taken while watched, in order, each with its time on the world's clock. Of frames that nobody takes for ten
    /// seconds the oldest are dropped.
    pub fn take_frames(&mut self) -> impl Iterator<Item = (Duration, Frame)> {
        self.watched
            .as_mut()
            .map(std::mem::take)
            .into_iter()
            .flatten()
    }

    fn recorder_mut(&mut self) -> Option<&mut Recorder> {
        self.cameras.as_mut()?.recorder.as_mut()
    }

    /// Error that ended the present recording early, if any.
    pub fn recording_failed(&self) -> Option<&TrackError> {
        self.cameras.as_ref()?.recorder.as_ref()?.failed.as_ref()
    }

    /// Finishes the recording and its file. Returns `None` without a recording.
    ///
    /// # Errors
    /// [`TrackError`]; written rows remain.
    pub fn finish_recording(&mut self) -> Result<Option<Recording>, TrackError> {
        let recorder = self
            .cameras
            .as_mut()
            .and_then(|cameras| cameras.recorder.take());
        if self.watched.is_none() {
            self.cameras = None;
        }
        let Some(recorder) = recorder else {
            return Ok(None);
        };
        if let Some(error) = recorder.failed {
            return Err(error);
        }
        let path = recorder.file.path().to_path_buf();
        let frames = recorder.file.finish()?;
        Ok(Some(Recording {
            path,
            frames,
            started: Duration::from_micros(recorder.started_us),
            cycle_starts: recorder.cycle_starts,
        }))
    }

    /// Advances to `to`, from frame to frame; an earlier time has no effect. A frame due at `to` is included.
    pub fn advance(&mut self, to: Duration) {
        self.advance_us(u64::try_from(to.as_micros()).unwrap_or(u64::MAX));
    }

    /// Advances to a time in µs.
    pub(crate) fn advance_us(&mut self, to_us: u64) {
        while let Some(frame) = self.next_frame_us().filter(|frame| *frame <= to_us) {
            self.move_until(frame);
            self.expose();
        }
        if to_us > self.now_us {
            self.move_until(to_us);
        }
    }

    fn next_frame_us(&self) -> Option<u64> {
        self.cameras.as_ref().map(|cameras| cameras.next_frame_us)
    }

    fn move_until(&mut self, until_us: u64) {
        let seconds = until_us.saturating_sub(self.now_us) as f64 * 1e-6;
        let tank = &mut self.tank;
        self.servos
            .advance(seconds, |phi, seconds| tank.follow(phi, seconds));
        self.now_us = until_us;
    }

    fn expose(&mut self) {
        let pose = self.tank.pose();
        let stamp = self.now();
        let Some(cameras) = &mut self.cameras else {
            return;
        };
        let frame = cameras.camera.expose(&pose);
        cameras.next_frame_us += FRAME_US;
        if let Some(recorder) = cameras.recorder.as_mut().filter(|r| r.failed.is_none()) {
            recorder.failed = recorder.file.push(&frame).err();
        }
        if let Some(watched) = &mut self.watched {
            if watched.len() >= MOST_FRAMES {
                watched.pop_front();
            }
            watched.push_back((stamp, frame));
        }
    }
}
