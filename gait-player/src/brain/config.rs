//! Interface between shell and brain: configuration, boot data, inputs and output.

use crate::{Limits, ShortStarts, servo::ServoMap};
use heapless::String;
use link_protocol::{
    Board, Configuration, FirmwareVersion, Joint, ResetReason, ServoSettings, StateName,
    TangentialDrag,
};

/// Configuration that the shell passes at the start.
#[derive(Clone, Debug)]
pub struct BrainConfig {
    /// Identity that the robot reports.
    pub identity: Identity,
    /// The firmware's limits. A configuration may only tighten them.
    pub limits: Limits,
    /// Geometry and limits until others are set.
    pub configuration: Configuration,
    /// Servo maps until others are set.
    pub servos: [ServoSettings; 2],
    /// Joint without a servo, until another is set.
    pub passive: Option<Joint>,
    /// Capacity of the receive buffer, bytes.
    pub buffer: u16,
    /// State of the robot after the start.
    pub boot: Boot,
}

/// Identity that the robot reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Firmware version and commit.
    pub firmware: FirmwareVersion,
    /// Board type.
    pub board: Board,
}

/// State of the robot after a start or reset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Boot {
    /// Cause of the start.
    pub reset_reason: ResetReason,
    /// Random number that identifies this start.
    pub nonce: u32,
    /// First session number. It must differ from those before the reset: a random number or a persistent counter.
    pub session_seed: u16,
    /// Last [`Output::kept`], from a register that survives a reset but not a power cut; any other value after power-on.
    pub kept: u32,
    /// Message of the last crash; empty without a crash.
    pub crash_message: String<96>,
    /// Last [`Output::starts`], from RAM that survives resets. `None` if the RAM holds no valid record, as after power-on;
    /// [`crate::Brain::load`] then reads the storage.
    pub starts: Option<ShortStarts>,
}

/// Transport to the robot. Each has its own decoder and outbox; the session belongs to the transport of the last greeting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Serial line with the radio. Anyone within radio range can send on it.
    Uart,
    /// USB cable. Its sender is at the robot.
    Usb,
}

impl Transport {
    /// Both transports.
    pub const ALL: [Self; 2] = [Self::Uart, Self::Usb];

    pub(crate) fn index(self) -> usize {
        self as usize
    }
}

/// Measurements of the shell at a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Lowest battery voltage since the last tick, mV. `None` without a divider or a sample.
    pub battery_mv: Option<u16>,
    /// Connection state of the radio (STATE pin); true if there is no such pin. The UART sends nothing while it is false.
    pub link_up: bool,
    /// A host has opened the USB port. USB sends nothing while it is false.
    pub usb_up: bool,
    /// The bench jumper is closed or BOOTSEL is pressed. A closing edge opens the bench window for two minutes.
    pub present: bool,
}

/// Output of a tick: the only path to the hardware.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // each is a wire or a task of the shell
pub struct Output {
    /// Pulses of both servos for the next period, ns; 0 at a passive joint, whose output stays low. `None` switches them off.
    pub pulses_ns: Option<[u32; 2]>,
    /// Commanded angles φ₁, φ₂, rad (kept while pulses are off).
    pub setpoint: [f32; 2],
    /// LED state. During a play it is lit for the first 100 ms of each cycle and dark otherwise, as a mark for the cameras.
    pub led: bool,
    /// True in the first 100 ms of a cycle.
    pub cycle_flash: bool,
    /// State of the brain.
    pub state: StateName,
    /// Word to keep in a register that survives a reset; see [`Boot::kept`].
    pub kept: u32,
    /// [`crate::Brain::serve_storage`] has work to do (pulses are off).
    pub storage_wanted: bool,
    /// Record to keep in RAM that survives a reset; see [`Boot::starts`].
    pub starts: ShortStarts,
    /// Enter the chip's boot loader now: it was requested, its reply was sent and everything is stored.
    pub boot_loader: bool,
}

impl Boot {
    /// Boot data after power-on, without any earlier record.
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
    /// The paper's robot after power-on, with an arbitrary version.
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
    /// The paper's robot: geometry, limits and servos as built.
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
            passive: None,
            buffer: 2048,
            boot,
        }
    }
}
