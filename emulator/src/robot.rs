//! The emulated board in a tank: its pulses drive the twin's servos, and the twin's cameras watch.

use std::error::Error;
use std::time::Duration;

use host_link::port::{Device, WireSpeed};
use twin::{VirtualRobot, World};

use crate::{Board, EmulatorError, Events, Period};

/// A robot whose brain is the real firmware.
#[derive(Debug)]
pub struct EmulatedRobot {
    board: Board,
    world: World,
    events: Events,
    heard: Duration,
    failed: Option<EmulatorError>,
}

impl EmulatedRobot {
    /// A board in its world, with its radio connected; both clocks must stand at zero.
    ///
    /// # Errors
    /// [`EmulatorError`] when the board does not answer.
    pub fn new(mut board: Board, world: World) -> Result<Self, EmulatorError> {
        board.set_connected(true)?;
        Ok(Self {
            board,
            world,
            events: Events::default(),
            heard: Duration::ZERO,
            failed: None,
        })
    }

    /// The board.
    pub fn board_mut(&mut self) -> &mut Board {
        &mut self.board
    }

    /// What the board did since this was last called.
    pub fn take_events(&mut self) -> Events {
        std::mem::take(&mut self.events)
    }

    /// When the last byte that came over the line was in the board's UART.
    pub fn last_heard(&self) -> Duration {
        self.heard
    }

    /// Remembers the first failure: a device has no way to tell it.
    fn attempt(&mut self, act: impl FnOnce(&mut Self) -> Result<(), EmulatorError>) {
        if self.failed.is_none() {
            self.failed = act(self).err();
        }
    }

    fn run(&mut self, to: Duration) -> Result<(), EmulatorError> {
        self.board.run(to)?;
        let news = self.board.take_events();
        // The servos see each period's pulses from its start on.
        for period in &news.periods {
            self.world.advance(period.at());
            self.world.set_pulses(pulses_ns(period));
        }
        if !self.board.powered() {
            self.world.set_pulses(None);
        }
        self.world.advance(to);
        self.events.append(news);
        Ok(())
    }
}

impl Device for EmulatedRobot {
    fn advance(&mut self, to: Duration) {
        self.attempt(|robot| robot.run(to));
    }

    fn receive(&mut self, bytes: &[u8]) {
        let count = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
        self.heard = self.heard.max(self.board.now()) + WireSpeed::robot().byte_time() * count;
        self.attempt(|robot| robot.board.feed(bytes));
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        self.board.take_sent(room, out);
    }

    fn failure(&self) -> Option<&(dyn Error + Send + Sync + 'static)> {
        self.failed
            .as_ref()
            .map(|error| error as &(dyn Error + Send + Sync))
    }
}

impl VirtualRobot for EmulatedRobot {
    fn world(&self) -> &World {
        &self.world
    }

    fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }
}

/// Both pulses in whole nanoseconds, or none.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 16-bit counts of 320 ns
fn pulses_ns(period: &Period) -> Option<[u32; 2]> {
    period
        .powered()
        .then(|| period.pulses_us().map(|us| (us * 1000.0).round() as u32))
}
