//! The twin itself: brain, servos, tank and cameras in step, from event to event.

use std::path::{Path, PathBuf};
use std::time::Duration;

use gait_player::{Brain, Inputs, Output, TICK_US};
use host_link::port::Device;
use link_protocol::{MAX_ENCODED, StateName};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_model::{InvalidSwimmer, Pose};

use crate::camera::{Camera, MotiveFile, TrackError};
use crate::config::TwinConfig;
use crate::flash::VirtualFlash;
use crate::servos::Servos;
use crate::tank::Tank;

const FRAME_US: u64 = 1_000_000 / Camera::RATE_HZ as u64;

/// A cycle began.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleStart {
    /// When, on the twin's clock: at the tick whose flash the cameras see.
    pub at: Duration,
    /// Where the robot truly was then, in the tank's frame.
    pub pose: Pose<f64>,
}

/// A finished recording of the cameras.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The tracking file.
    pub path: PathBuf,
    /// Frames in it.
    pub frames: u64,
    /// The twin's clock at its frame 0.
    pub started: Duration,
    /// The cycles that began during it.
    pub cycle_starts: Vec<CycleStart>,
}

#[derive(Debug)]
struct Cameras {
    camera: Camera,
    file: MotiveFile,
    started_us: u64,
    next_frame_us: u64,
    cycle_starts: Vec<CycleStart>,
    failed: Option<TrackError>,
}

/// A robot in a virtual tank.
pub struct Twin {
    config: TwinConfig,
    brain: Brain,
    flash: VirtualFlash,
    servos: Servos,
    tank: Tank,
    output: Option<Output>,
    now_us: u64,
    next_tick_us: u64,
    link_up: bool,
    recordings: u64,
    cameras: Option<Cameras>,
    cycle_starts: Vec<CycleStart>,
}

impl std::fmt::Debug for Twin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Twin")
            .field("now_us", &self.now_us)
            .field("output", &self.output)
            .field("pose", &self.tank.pose())
            .finish_non_exhaustive()
    }
}

impl Twin {
    /// A robot that has just been switched on, at time zero, somewhere in the tank with a heading of its seed.
    ///
    /// # Errors
    /// The lengths and drags make no swimmer.
    pub fn new(config: TwinConfig) -> Result<Self, InvalidSwimmer> {
        let mut rng = ChaCha8Rng::seed_from_u64(config.seed);
        rng.set_stream(3);
        let mut draw = |largest: f64| rng.random_range(-largest..largest);
        let pose = Pose::new(draw(0.2), draw(0.2), draw(std::f64::consts::PI));
        let tank = Tank::new(&config.swimmer, pose)?;
        let mut brain = config.brain();
        let mut flash = config.flash.clone();
        let Ok(()) = brain.load(&mut flash);
        Ok(Self {
            servos: Servos::new(config.servos.map(Into::into), config.plant),
            brain,
            flash,
            tank,
            output: None,
            now_us: 0,
            next_tick_us: 0,
            link_up: true,
            recordings: 0,
            cameras: None,
            cycle_starts: Vec::new(),
            config,
        })
    }

    /// The twin's clock.
    pub fn now(&self) -> Duration {
        Duration::from_micros(self.now_us)
    }

    /// Where the robot truly is, in the tank's frame.
    pub fn pose(&self) -> Pose<f64> {
        self.tank.pose()
    }

    /// Where its joints truly are, rad.
    pub fn angles(&self) -> [f64; 2] {
        self.servos.angles()
    }

    /// What the brain decided in its last tick; `None` before the first.
    pub fn output(&self) -> Option<&Output> {
        self.output.as_ref()
    }

    /// What the brain is doing.
    pub fn state(&self) -> StateName {
        self.output
            .map_or(StateName::Stopped, |output| output.state)
    }

    /// The robot's flash, as it is now: a twin made with it comes up as after a power cut.
    pub fn flash(&self) -> &VirtualFlash {
        &self.flash
    }

    /// What the twin is made of.
    pub fn config(&self) -> &TwinConfig {
        &self.config
    }

    /// The radio's STATE pin: connected or not. Connected at first.
    pub fn set_link_up(&mut self, link_up: bool) {
        self.link_up = link_up;
    }

    /// The cycles that have begun so far.
    pub fn cycle_starts(&self) -> &[CycleStart] {
        &self.cycle_starts
    }

    /// Starts to record at the next frame (frames come every 10 ms of the twin's clock) into a tracking file at `path`. A
    /// recording under way is thrown away.
    ///
    /// # Errors
    /// [`TrackError`] when nothing can be written there.
    pub fn start_recording(&mut self, path: &Path) -> Result<(), TrackError> {
        let reach = 0.5 * self.config.swimmer.links.middle;
        let (seed, number) = (self.config.seed, self.recordings);
        let file = MotiveFile::create(path, &self.config.camera, seed)?;
        let started_us = self.now_us.next_multiple_of(FRAME_US);
        self.recordings += 1;
        self.cameras = Some(Cameras {
            camera: Camera::new(self.config.camera.clone(), reach, seed, number),
            file,
            started_us,
            next_frame_us: started_us,
            cycle_starts: Vec::new(),
            failed: None,
        });
        Ok(())
    }

    /// Ends the recording and puts its file in place; `None` when none was under way.
    ///
    /// # Errors
    /// [`TrackError`]; then no file is left.
    pub fn finish_recording(&mut self) -> Result<Option<Recording>, TrackError> {
        let Some(cameras) = self.cameras.take() else {
            return Ok(None);
        };
        if let Some(error) = cameras.failed {
            return Err(error);
        }
        let path = cameras.file.path().to_path_buf();
        let frames = cameras.file.finish()?;
        Ok(Some(Recording {
            path,
            frames,
            started: Duration::from_micros(cameras.started_us),
            cycle_starts: cameras.cycle_starts,
        }))
    }

    /// Lives until `to` on the twin's clock, from event to event: ticks every 20 ms, frames every 10 ms while recording, and
    /// the end. An earlier time does nothing.
    pub fn advance(&mut self, to: Duration) {
        let to_us = u64::try_from(to.as_micros()).unwrap_or(u64::MAX);
        loop {
            let frame = self
                .cameras
                .as_ref()
                .map_or(u64::MAX, |cameras| cameras.next_frame_us);
            let event = frame.min(self.next_tick_us);
            if event > to_us {
                break;
            }
            self.now_until(event);
            if frame == event {
                self.expose();
            }
            if self.next_tick_us == event {
                self.tick();
            }
        }
        if to_us > self.now_us {
            self.now_until(to_us);
        }
    }

    fn now_until(&mut self, until_us: u64) {
        let seconds = until_us.saturating_sub(self.now_us) as f64 * 1e-6;
        let tank = &mut self.tank;
        self.servos.advance(seconds, |phi| tank.move_joints(phi));
        self.now_us = until_us;
    }

    fn tick(&mut self) {
        let inputs = Inputs {
            battery_mv: Some(self.config.battery_mv),
            link_up: self.link_up,
        };
        let output = self.brain.tick(self.now_us, &inputs);
        let flashed = self.output.is_some_and(|before| before.cycle_flash);
        if output.cycle_flash && !flashed {
            let start = CycleStart {
                at: self.now(),
                pose: self.tank.pose(),
            };
            self.cycle_starts.push(start);
            if let Some(cameras) = &mut self.cameras {
                cameras.cycle_starts.push(start);
            }
        }
        self.servos.set_pulses(output.pulses_ns);
        if output.storage_wanted {
            let Ok(()) = self.brain.serve_storage(self.now_us, &mut self.flash);
        }
        self.output = Some(output);
        self.next_tick_us += u64::from(TICK_US);
    }

    fn expose(&mut self) {
        let pose = self.tank.pose();
        if let Some(cameras) = &mut self.cameras {
            let frame = cameras.camera.expose(&pose);
            if cameras.failed.is_none() {
                cameras.failed = cameras.file.push(&frame).err();
            }
            cameras.next_frame_us += FRAME_US;
        }
    }
}

impl Device for Twin {
    fn advance(&mut self, to: Duration) {
        Self::advance(self, to);
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.brain.receive(self.now_us, bytes);
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        let mut left = room;
        let mut frame = [0; MAX_ENCODED];
        while left > 0 {
            let space = left.min(frame.len());
            let count = self.brain.transmit(&mut frame[..space]).min(space);
            if count == 0 {
                break;
            }
            out.extend_from_slice(&frame[..count]);
            left -= count;
        }
    }
}
