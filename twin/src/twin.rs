//! Digital twin: brain and world in step, from tick to tick.

use std::path::Path;
use std::time::Duration;

use gait_player::storage::MemoryStorage;
use gait_player::{Brain, Inputs, Output, TICK_US};
use host_link::port::Device;
use link_protocol::{MAX_ENCODED, StateName};
use swimmer_model::{InvalidSwimmer, Pose};

use crate::camera::{Frame, TrackError};
use crate::config::TwinConfig;
use crate::virtual_robot::VirtualRobot;
use crate::world::{CycleStart, Recording, World};

/// Robot in a virtual tank.
pub struct Twin {
    config: TwinConfig,
    brain: Brain,
    flash: MemoryStorage,
    world: World,
    output: Option<Output>,
    next_tick_us: u64,
    link_up: bool,
}

impl std::fmt::Debug for Twin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Twin")
            .field("now", &self.world.now())
            .field("output", &self.output)
            .field("pose", &self.world.pose())
            .finish_non_exhaustive()
    }
}

impl Twin {
    /// Returns a robot after power-on, at time zero, with position and heading from its seed.
    ///
    /// # Errors
    /// Lengths and drags form no valid swimmer.
    pub fn new(config: TwinConfig) -> Result<Self, InvalidSwimmer> {
        let world = World::new(&config)?;
        let mut brain = config.brain();
        let mut flash = config.flash.clone();
        let Ok(()) = brain.load(&mut flash);
        Ok(Self {
            brain,
            flash,
            world,
            output: None,
            next_tick_us: 0,
            link_up: true,
            config,
        })
    }

    /// Clock of the twin.
    pub fn now(&self) -> Duration {
        self.world.now()
    }

    /// True pose of the robot, in the tank's frame.
    pub fn pose(&self) -> Pose<f64> {
        self.world.pose()
    }

    /// True joint angles, rad.
    pub fn angles(&self) -> [f64; 2] {
        self.world.angles()
    }

    /// Output of the brain's last tick. Returns `None` before the first.
    pub fn output(&self) -> Option<&Output> {
        self.output.as_ref()
    }

    /// State of the brain.
    pub fn state(&self) -> StateName {
        self.output
            .map_or(StateName::Stopped, |output| output.state)
    }

    /// Present content of the robot's flash. A twin created with it starts as after a power cut.
    pub fn flash(&self) -> &MemoryStorage {
        &self.flash
    }

    /// Configuration of the twin.
    pub fn config(&self) -> &TwinConfig {
        &self.config
    }

    /// Sets the radio's STATE pin. It is connected at first.
    pub fn set_link_up(&mut self, link_up: bool) {
        self.link_up = link_up;
    }

    /// Cycles that have begun so far.
    pub fn cycle_starts(&self) -> &[CycleStart] {
        self.world.cycle_starts()
    }

    /// Starts a recording with the next frame (frames come every 10 ms of the twin's clock) into a tracking file at `path`. An
    /// earlier recording ends.
    ///
    /// # Errors
    /// [`TrackError`] if the file cannot be written.
    pub fn start_recording(&mut self, path: &Path) -> Result<(), TrackError> {
        self.world.start_recording(path)
    }

    /// Finishes the recording and its file. Returns `None` without a recording.
    ///
    /// # Errors
    /// [`TrackError`]; written rows remain.
    pub fn finish_recording(&mut self) -> Result<Option<Recording>, TrackError> {
        self.world.finish_recording()
    }

    /// Keeps the cameras' frames for [`take_frames`](Self::take_frames), as [`World::watch`].
    pub fn watch(&mut self) {
        self.world.watch();
    }

    /// Frames that were taken while watched, as [`World::take_frames`].
    pub fn take_frames(&mut self) -> impl Iterator<Item = (Duration, Frame)> {
        self.world.take_frames()
    }

    /// Advances to `to` on the twin's clock, from event to event: ticks every 20 ms, frames every 10 ms during a recording, and
    /// the end. An earlier time has no effect.
    pub fn advance(&mut self, to: Duration) {
        let to_us = u64::try_from(to.as_micros()).unwrap_or(u64::MAX);
        while self.next_tick_us <= to_us {
            self.world.advance_us(self.next_tick_us);
            self.tick();
        }
        self.world.advance_us(to_us);
    }

    fn tick(&mut self) {
        let inputs = Inputs {
            battery_mv: Some(self.config.battery_mv),
            link_up: self.link_up,
            usb_up: self.link_up,
            present: false,
        };
        let output = self.brain.tick(self.world.now_us(), &inputs);
        let flashed = self.output.is_some_and(|before| before.cycle_flash);
        if output.cycle_flash && !flashed {
            self.world.begin_cycle();
        }
        self.world.set_pulses(output.pulses_ns);
        if output.storage_wanted {
            let Ok(()) = self
                .brain
                .serve_storage(self.world.now_us(), &mut self.flash);
        }
        self.output = Some(output);
        self.next_tick_us += u64::from(TICK_US);
    }
}

impl VirtualRobot for Twin {
    fn world(&self) -> &World {
        &self.world
    }

    fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }
}

impl Device for Twin {
    fn advance(&mut self, to: Duration) {
        Self::advance(self, to);
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.brain
            .receive(self.world.now_us(), self.config.transport, bytes);
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        let mut left = room;
        let mut frame = [0; MAX_ENCODED];
        while left > 0 {
            let space = left.min(frame.len());
            let count = self
                .brain
                .transmit(self.config.transport, &mut frame[..space])
                .min(space);
            if count == 0 {
                break;
            }
            out.extend_from_slice(&frame[..count]);
            left -= count;
        }
    }
}
