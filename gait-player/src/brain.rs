//! The brain: its data and its doors.

use crate::Limits;
use crate::storage::Storage;
use heapless::String;
use link_protocol::{Board, Configuration, FirmwareVersion, ResetReason, ServoSettings, StateName};

/// What the shell knows at the start.
#[derive(Clone, Debug)]
pub struct BrainConfig {
    /// What the robot says it is.
    pub identity: Identity,
    /// The firmware's limits; a configuration may tighten them.
    pub limits: Limits,
    /// Used until another is set.
    pub configuration: Configuration,
    /// Used until others are set.
    pub servos: [ServoSettings; 2],
    /// Bytes the receive buffer holds.
    pub buffer: u16,
    /// How the robot came up.
    pub boot: Boot,
}

/// What the robot says it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Version and commit.
    pub firmware: FirmwareVersion,
    /// The board.
    pub board: Board,
}

/// How the robot came up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Boot {
    /// Why.
    pub reset_reason: ResetReason,
    /// Drawn at random: tells one start from another.
    pub nonce: u32,
    /// First session number; must not repeat those before a reset (a random number, or a counter that is kept).
    pub session_seed: u16,
    /// The last [`Output::kept`], from a register that outlives a reset but not a power cut; any value else.
    pub kept: u32,
    /// What the last crash left to tell; empty for none.
    pub crash_message: String<96>,
}

/// What the shell measured by the time of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Battery (lowest since the last tick), mV; `None` where no divider is fitted.
    pub battery_mv: Option<u16>,
    /// The radio says it is connected (STATE pin); true where there is no such pin. Nothing is sent while it is false.
    pub link_up: bool,
}

/// The only door out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Pulses of both servos, ns, for the next period; `None`: off.
    pub pulses_ns: Option<[u32; 2]>,
    /// Commanded angles φ₁, φ₂, rad (kept while pulses are off).
    pub setpoint: [f32; 2],
    /// The LED; while playing it is lit for the first 100 ms of each cycle and dark otherwise, for the cameras.
    pub led: bool,
    /// The first ticks of a cycle.
    pub cycle_flash: bool,
    /// What the brain is doing.
    pub state: StateName,
    /// To be kept in a register that outlives a reset; see [`Boot::kept`].
    pub kept: u32,
    /// [`Brain::serve_storage`] has something to do (pulses are off).
    pub storage_wanted: bool,
}

/// The brain.
pub struct Brain {
    output: Output,
}

impl Brain {
    /// A brain in Stopped (or e-stopped, where a reset found it so).
    pub fn new(_config: BrainConfig) -> Self {
        let output = Output {
            pulses_ns: None,
            setpoint: [0.0; 2],
            led: false,
            cycle_flash: false,
            state: StateName::Stopped,
            kept: 0,
            storage_wanted: false,
        };
        Self { output }
    }

    /// Takes what was stored: settings and the newest whole table. Call once, before the first tick. What is not valid
    /// is as if it were not there.
    ///
    /// # Errors
    /// The storage could not be read; the brain works without.
    pub fn load<S: Storage>(&mut self, _storage: &mut S) -> Result<(), S::Error> {
        Ok(())
    }

    /// Takes bytes from the link: any bytes, in any split. Acts at once, but pulses change only in [`Self::tick`].
    pub fn receive(&mut self, _now_us: u64, _bytes: &[u8]) {}

    /// One servo period: decides the next pulses. Call every [`crate::TICK_US`].
    pub fn tick(&mut self, _now_us: u64, _inputs: &Inputs) -> Output {
        self.output
    }

    /// Takes bytes to be sent; returns how many.
    pub fn transmit(&mut self, _out: &mut [u8]) -> usize {
        0
    }

    /// One bounded step of storing what is not stored yet (an erase, a page, the settings); nothing unless Stopped.
    ///
    /// # Errors
    /// The storage's; the step is tried again a second later.
    pub fn serve_storage<S: Storage>(
        &mut self,
        _now_us: u64,
        _storage: &mut S,
    ) -> Result<(), S::Error> {
        Ok(())
    }
}
