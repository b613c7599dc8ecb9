//! The emulated board in a tank: its pulses drive the twin's servos, and the twin's cameras watch.

use std::collections::VecDeque;
use std::error::Error;
use std::fmt;
use std::time::Duration;

use host_link::port::{Device, WireSpeed};
use twin::{VirtualRobot, World};

use crate::{Board, EmulatorError, Events, Line, LogLine, Period};

/// A robot whose brain is the real firmware.
#[derive(Debug)]
pub struct EmulatedRobot {
    board: Board,
    line: Line,
    world: World,
    /// How far the robot has lived; the board may be ahead, within `quiet`.
    now: Duration,
    quiet: Quiet,
    /// Pulses that the world has not seen yet.
    ahead: VecDeque<Period>,
    /// When the board's power went.
    dark_from: Duration,
    events: Events,
    heard: Duration,
    keeps_events: bool,
    reader: Option<LogReader>,
    failed: Option<EmulatorError>,
}

/// Until when nothing arrives, and how long what is sent takes to where it can be answered.
#[derive(Debug, Clone, Copy, Default)]
struct Quiet {
    until: Duration,
    travel: Duration,
}

struct LogReader(Box<dyn FnMut(&LogLine) + Send>);

impl fmt::Debug for LogReader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("LogReader")
    }
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
            line: Line::Uart,
            world,
            now: Duration::ZERO,
            quiet: Quiet::default(),
            ahead: VecDeque::new(),
            dark_from: Duration::ZERO,
            events: Events::default(),
            heard: Duration::ZERO,
            keeps_events: true,
            reader: None,
            failed: None,
        })
    }

    /// Talks over the USB cable, which is plugged in, and not over the radio, which nobody is connected to.
    ///
    /// # Errors
    /// [`EmulatorError`] when the board does not answer.
    pub fn over_usb(mut self) -> Result<Self, EmulatorError> {
        self.line = Line::Usb;
        self.board.set_connected(false)?;
        self.board.set_plugged(true)?;
        Ok(self)
    }

    /// Shows every line of the firmware's log to `reader`, when it is written.
    #[must_use]
    pub fn with_log_reader(mut self, reader: impl FnMut(&LogLine) + Send + 'static) -> Self {
        self.reader = Some(LogReader(Box::new(reader)));
        self
    }

    /// Keeps no events: for a robot that lives long with nobody to take them.
    #[must_use]
    pub fn without_events(mut self) -> Self {
        self.keeps_events = false;
        self
    }

    /// The board.
    pub fn board_mut(&mut self) -> &mut Board {
        &mut self.board
    }

    /// What the board did since this was last called.
    pub fn take_events(&mut self) -> Events {
        std::mem::take(&mut self.events)
    }

    /// When the last byte that came over the line was in the board's UART, or on its way through the cable.
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
        while self.board.now() < to {
            let Quiet { until, travel } = self.quiet;
            self.board.run_past_byte(until.max(to), travel)?;
            self.take_news();
        }
        // The servos see each period's pulses from its start on.
        while let Some(period) = self.ahead.pop_front_if(|period| period.at() <= to) {
            self.world.advance(period.at());
            self.world.set_pulses(pulses_ns(&period));
        }
        if !self.board.powered() && self.dark_from <= to {
            self.world.set_pulses(None);
        }
        self.world.advance(to);
        self.now = self.now.max(to);
        Ok(())
    }

    fn take_news(&mut self) {
        let news = self.board.take_events();
        self.ahead.extend(news.periods.iter().copied());
        if let Some(cut) = news.power_cuts.last() {
            self.dark_from = cut.at();
        }
        if let Some(LogReader(read)) = &mut self.reader {
            news.log.iter().for_each(read);
        }
        if self.keeps_events {
            self.events.append(news);
        }
    }
}

impl Device for EmulatedRobot {
    fn advance(&mut self, to: Duration) {
        self.attempt(|robot| robot.run(to));
    }

    fn receive(&mut self, bytes: &[u8]) {
        match self.line {
            Line::Uart => {
                let count = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
                self.heard =
                    self.heard.max(self.board.now()) + WireSpeed::robot().byte_time() * count;
                self.attempt(|robot| robot.board.feed(bytes));
            }
            Line::Usb => {
                self.heard = self.board.now();
                self.attempt(|robot| robot.board.feed_usb(bytes));
            }
        }
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        self.board.take_sent(self.line, self.now, room, out);
    }

    fn expect_quiet(&mut self, until: Duration, travel: Duration) {
        self.quiet = Quiet { until, travel };
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
