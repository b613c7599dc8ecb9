//! Emulated board in the twin's tank: its pulses drive the twin's servos, and the twin's cameras track it.

use std::collections::VecDeque;
use std::error::Error;
use std::fmt;
use std::time::Duration;

use host_link::port::{Device, WireSpeed};
use twin::{VirtualRobot, World};

use crate::{Board, BoardLine, EmulatorError, Events, LogLine, Period};

/// Virtual robot that runs the firmware image.
#[derive(Debug)]
pub struct EmulatedRobot {
    board: Board,
    line: BoardLine,
    world: World,
    /// Time up to which the tank has advanced; the board may be ahead, within `quiet`.
    now: Duration,
    quiet: Quiet,
    /// Periods that the tank has not processed yet.
    ahead: VecDeque<Period>,
    /// Time at which the board lost its power.
    dark_from: Duration,
    events: Events,
    heard: Duration,
    keeps_events: bool,
    reader: Option<LogReader>,
    failed: Option<EmulatorError>,
}

/// Interval without arrivals at the board, within which the board may run ahead.
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
    /// Places a board in a tank, with its radio connected. Both clocks must be at zero.
    ///
    /// # Errors
    /// [`EmulatorError`] if the board does not reply.
    pub fn new(mut board: Board, world: World) -> Result<Self, EmulatorError> {
        board.set_connected(true)?;
        Ok(Self {
            board,
            line: BoardLine::Uart,
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

    /// Plugs in the USB cable and disconnects the radio; the port is then the USB cable.
    ///
    /// # Errors
    /// [`EmulatorError`] if the board does not reply.
    pub fn over_usb(mut self) -> Result<Self, EmulatorError> {
        self.line = BoardLine::Usb;
        self.board.set_connected(false)?;
        self.board.set_plugged(true)?;
        Ok(self)
    }

    /// Passes every line of the firmware's log to `reader`.
    #[must_use]
    pub fn with_log_reader(mut self, reader: impl FnMut(&LogLine) + Send + 'static) -> Self {
        self.reader = Some(LogReader(Box::new(reader)));
        self
    }

    /// Discards events, for a long run in which they are not read.
    #[must_use]
    pub fn without_events(mut self) -> Self {
        self.keeps_events = false;
        self
    }

    /// The board.
    pub fn board_mut(&mut self) -> &mut Board {
        &mut self.board
    }

    /// Takes the events since the last call.
    pub fn take_events(&mut self) -> Events {
        std::mem::take(&mut self.events)
    }

    /// Time at which the last received byte reached the board's UART or USB port.
    pub fn last_heard(&self) -> Duration {
        self.heard
    }

    /// Performs an action and keeps the first failure, since the trait `Device` cannot return errors.
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
        // The pulses of a period act from its start.
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
            BoardLine::Uart => {
                let count = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
                self.heard =
                    self.heard.max(self.board.now()) + WireSpeed::robot().byte_time() * count;
                self.attempt(|robot| robot.board.feed(bytes));
            }
            BoardLine::Usb => {
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

/// Both pulses in whole nanoseconds. Returns `None` if the pulses are off.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 16-bit counts of 320 ns
fn pulses_ns(period: &Period) -> Option<[u32; 2]> {
    period
        .powered()
        .then(|| period.pulses_us().map(|us| (us * 1000.0).round() as u32))
}
