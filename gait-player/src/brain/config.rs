//! What the shell tells the brain, and the one thing the brain tells the shell.

use crate::{Limits, ShortStarts, servo::ServoMap};
use heapless::String;
use link_protocol::{
    Board, Configuration, FirmwareVersion, ResetReason, ServoSettings, StateName, TangentialDrag,
};

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
    /// The last [`Output::starts`], from RAM that outlives resets; `None` where it holds none, as after power was off. Then
    /// [`crate::Brain::load`] asks the storage.
    pub starts: Option<ShortStarts>,
}

/// A way to the robot. Each has its decoder and its bytes on their way out; the session belongs to the one that greeted last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// The serial line, with the radio on it: anybody in range may speak there.
    Uart,
    /// The USB cable: whoever speaks there is at the robot.
    Usb,
}

impl Transport {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Uart, Self::Usb];

    pub(crate) fn index(self) -> usize {
        self as usize
    }
}

/// What the shell measured by the time of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Battery (lowest since the last tick), mV; `None` where no divider is fitted, or no sample came.
    pub battery_mv: Option<u16>,
    /// The radio says it is connected (STATE pin); true where there is no such pin. Nothing is sent over the UART while it is
    /// false.
    pub link_up: bool,
    /// A host has opened the USB port. Nothing is sent there while it is false.
    pub usb_up: bool,
    /// The bench jumper is closed, or BOOTSEL is pressed. Where it becomes so, the bench window opens for two minutes.
    pub present: bool,
}

/// The only door out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // each is a wire or a task of the shell
pub struct Output {
    /// Pulses of both servos, ns, for the next period; `None`: off.
    pub pulses_ns: Option<[u32; 2]>,
    /// Commanded angles φ₁, φ₂, rad (kept while pulses are off).
    pub setpoint: [f32; 2],
    /// The LED; while playing it is lit for the first 100 ms of each cycle and dark otherwise, for the cameras.
    pub led: bool,
    /// The first 100 ms of a cycle.
    pub cycle_flash: bool,
    /// What the brain is doing.
    pub state: StateName,
    /// To be kept in a register that outlives a reset; see [`Boot::kept`].
    pub kept: u32,
    /// [`crate::Brain::serve_storage`] has something to do (pulses are off).
    pub storage_wanted: bool,
    /// To be kept in RAM that outlives a reset; see [`Boot::starts`].
    pub starts: ShortStarts,
    /// Leave for the chip's boot loader now: it was asked for, its answer has left and everything is stored.
    pub boot_loader: bool,
}

impl Boot {
    /// Power was applied and nothing is known from before.
    pub fn power_on(nonce: u32, session_seed: u16) -> Self {
        Self {
            reset_reason: ResetReason::PowerOn,
            nonce,
            session_seed,
            kept: 0,
            crash_message: String::new(),
            starts: None,
        }
    }
}

#[cfg(test)]
impl BrainConfig {
    /// The paper's robot, of no version in particular, as its power comes on.
    pub(crate) fn in_tests() -> Self {
        let firmware = FirmwareVersion {
            major: 0,
            minor: 1,
            patch: 0,
            commit: [0; 8],
        };
        let board = Board::Twin;
        Self::robot(Identity { firmware, board }, Boot::power_on(1, 100))
    }
}

impl BrainConfig {
    /// The paper's robot: its geometry and limits, its servos as built.
    pub fn robot(identity: Identity, boot: Boot) -> Self {
        let servo = ServoSettings {
            centre_ns: ServoMap::ROBOT.centre_ns,
            slope_rad_per_us: ServoMap::ROBOT.slope_rad_per_us,
            reversed: ServoMap::ROBOT.reversed,
            trim: 0,
        };
        let configuration = Configuration {
            middle_m: 0.071,
            front_m: 0.137,
            back_m: 0.137,
            chi: 3.598,
            tangential_drag: TangentialDrag::LogAspect(4.543),
            sphere_radius_m: 0.0692,
            max_angle: Limits::ROBOT.max_angle,
            max_rate: Limits::ROBOT.max_rate,
        };
        Self {
            identity,
            limits: Limits::ROBOT,
            configuration,
            servos: [servo; 2],
            buffer: 2048,
            boot,
        }
    }
}
