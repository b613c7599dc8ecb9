//! Telemetry, keep-alives and the clock.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// State of the brain; `gait-player` has the glossary and the diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum StateName {
    /// Pulses off.
    Stopped,
    /// Pulses off, latched until [`crate::Request::ClearEStop`].
    EStopped,
    /// Pulses on, standing still.
    Holding,
    /// On the ramp to the first knot.
    Starting,
    /// Playing the table.
    Playing,
    /// Holding a pose within a play.
    Paused,
    /// On the ramp to neutral.
    Stopping,
    /// At neutral, pulses on for the last half second.
    Settling,
}

/// Cause of the last stop; the later in this list the more severe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, Schema)]
pub enum StopCause {
    /// It has not moved since its start.
    Boot,
    /// The last cycle ended.
    Finished,
    /// An operator's Stop.
    Requested,
    /// A detached pause reached its 60 s.
    PauseExpired,
    /// The link fell silent.
    LinkLost,
    /// The battery was low for 1 s.
    BatteryLow,
    /// An operator's e-stop.
    EStop,
}

/// Yes-or-no facts, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Flags(pub u16);

impl Flags {
    /// The battery is below its limit, or was until less than 5 s ago.
    pub const BATTERY_LOW: Self = Self(1);
    /// Three resets in 60 s: arming is refused.
    pub const RESET_LOOP: Self = Self(2);
    /// No valid frame of the open session within the lease.
    pub const LINK_SILENT: Self = Self(4);
    /// The play, or the pause, goes on without a link.
    pub const DETACHED: Self = Self(8);
    /// A committed table waits for its cycle boundary.
    pub const SWAP_PENDING: Self = Self(16);
    /// Settings or table are not stored yet.
    pub const UNSAVED: Self = Self(32);
    /// The cycle began in this tick or the ones just before: the LED flashes.
    pub const CYCLE_FLASH: Self = Self(64);
    /// The last storage operation failed.
    pub const STORAGE_FAILED: Self = Self(128);
    /// A shared key is set: from the next session on only signed frames act, but for stops.
    pub const KEY_SET: Self = Self(256);
    /// Somebody is at the robot: its bench window is open, or the session came over the USB cable. What needs presence may
    /// be asked for.
    pub const PRESENT: Self = Self(512);
    /// Arming is refused because of starts that followed each other too quickly, as in a servo's brown-out; with
    /// [`Flags::RESET_LOOP`].
    pub const SHORT_STARTS: Self = Self(1024);

    /// All bits of `other` are set.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Sets the bits of `other` where `condition` holds.
    #[must_use]
    pub fn with(self, other: Self, condition: bool) -> Self {
        if condition {
            Self(self.0 | other.0)
        } else {
            self
        }
    }
}

/// Sent by the robot about 25 times a second while a session is open, and only where there is room.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Telemetry {
    /// The robot's clock at the tick this tells of, µs since its start.
    pub robot_us: u64,
    /// State of the brain.
    pub state: StateName,
    /// Why it stops or last stopped.
    pub cause: StopCause,
    /// What else holds.
    pub flags: Flags,
    /// Cycles done.
    pub cycle: u32,
    /// Cycles asked for; 0 is without end.
    pub cycles: u32,
    /// Fraction of the cycle done, in 2⁻¹⁶.
    pub phase: u16,
    /// Commanded angles φ₁, φ₂ in 1e-4 rad.
    pub setpoint: [i16; 2],
    /// Pulses, ns; 0: off.
    pub pulse_ns: [u32; 2],
    /// Battery, mV; `None`: not measured.
    pub battery_mv: Option<u16>,
    /// Where the model says the robot is.
    pub pose: Pose,
    /// Whole frames received, modulo 2¹⁶.
    pub frames_ok: u16,
    /// Broken frames received, modulo 2¹⁶.
    pub frames_bad: u16,
}

/// Pose of the middle link as the model predicts it from the commanded angles, in the frame of the middle link at the
/// start of the play's first cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct Pose {
    /// Along the first heading, m.
    pub x: f32,
    /// Across it, m.
    pub y: f32,
    /// Heading, rad.
    pub theta: f32,
}

/// Host to robot, outside the order of requests: the keep-alive, and the question for the time. It renews the lease if it is
/// fresh: if the host has heard the robot at most a second ago, and later than by any keep-alive before. So neither a
/// recorded keep-alive nor those that a dead host left in a buffer renew the lease.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Heartbeat {
    /// The host's clock when it sent this, µs.
    pub host_us: u64,
    /// The latest time of the robot's clock that the host has heard in this session, µs; 0 where it has heard none yet.
    pub heard_us: u64,
}

/// Robot to host: the answer to [`Heartbeat`], under its sequence number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Pong {
    /// As in the [`Heartbeat`].
    pub host_us: u64,
    /// The robot's clock when the keep-alive was read, µs.
    pub received_us: u64,
    /// The robot's clock when this was handed to the transmitter, µs.
    pub sent_us: u64,
}
