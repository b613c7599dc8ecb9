//! Telemetry, keep-alives and clock messages.

use crate::Joint;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// State of the brain; `gait-player` has the glossary and the state diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum StateName {
    /// Pulses off.
    Stopped,
    /// Pulses off, latched until [`crate::Request::ClearEStop`].
    EStopped,
    /// Pulses on, holding a pose.
    Holding,
    /// Ramp to the first knot.
    Starting,
    /// Playing the table.
    Playing,
    /// Holding a pose within a play.
    Paused,
    /// Ramp to neutral.
    Stopping,
    /// At neutral, pulses on for the last half second.
    Settling,
}

/// Cause of the last stop, in increasing order of severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, Schema)]
pub enum StopCause {
    /// The robot has not moved since its start.
    Boot,
    /// The last cycle ended.
    Finished,
    /// Stop of an operator.
    Requested,
    /// A detached pause reached 60 s.
    PauseExpired,
    /// The link became silent.
    LinkLost,
    /// The battery was low for 1 s.
    BatteryLow,
    /// E-stop of an operator.
    EStop,
}

/// Boolean facts, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Flags(pub u16);

impl Flags {
    /// The battery is below its limit, or was within the last 5 s.
    pub const BATTERY_LOW: Self = Self(1);
    /// Three resets in 60 s: arming is refused.
    pub const RESET_LOOP: Self = Self(2);
    /// No valid frame of the open session within the lease.
    pub const LINK_SILENT: Self = Self(4);
    /// The play or pause continues without a link.
    pub const DETACHED: Self = Self(8);
    /// A committed table waits for the end of a cycle.
    pub const SWAP_PENDING: Self = Self(16);
    /// Settings or table are not stored yet.
    pub const UNSAVED: Self = Self(32);
    /// The cycle began in this tick or shortly before: the LED flashes.
    pub const CYCLE_FLASH: Self = Self(64);
    /// The last storage operation failed.
    pub const STORAGE_FAILED: Self = Self(128);
    /// A shared key is set: from the next session on only signed frames act, except for stops.
    pub const KEY_SET: Self = Self(256);
    /// A person is at the robot: the bench window is open, or the session uses the USB cable. Requests that require presence
    /// are allowed.
    pub const PRESENT: Self = Self(512);
    /// Arming is locked because of repeated short starts, as in a servo's brown-out; set together with [`Flags::RESET_LOOP`].
    pub const SHORT_STARTS: Self = Self(1024);
    /// The front joint has a spring in place of a servo: its output stays low.
    pub const FRONT_PASSIVE: Self = Self(2048);
    /// The back joint has a spring in place of a servo: its output stays low.
    pub const BACK_PASSIVE: Self = Self(4096);

    /// Returns true if all bits of `other` are set.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Joint with a spring in place of a servo. Returns `None` if both joints have servos.
    pub fn passive(self) -> Option<Joint> {
        [
            (Self::FRONT_PASSIVE, Joint::Front),
            (Self::BACK_PASSIVE, Joint::Back),
        ]
        .into_iter()
        .find_map(|(flag, joint)| self.contains(flag).then_some(joint))
    }

    /// Sets the bits of `other` if `condition` is true.
    #[must_use]
    pub fn with(self, other: Self, condition: bool) -> Self {
        if condition {
            Self(self.0 | other.0)
        } else {
            self
        }
    }
}

/// Telemetry of the robot, about 25 times a second while a session is open, if the link has capacity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Telemetry {
    /// The robot's clock at the reported tick, µs since its start.
    pub robot_us: u64,
    /// State of the brain.
    pub state: StateName,
    /// Cause of the present or last stop.
    pub cause: StopCause,
    /// Further facts, as bits.
    pub flags: Flags,
    /// Finished cycles.
    pub cycle: u32,
    /// Requested cycles; 0 is endless.
    pub cycles: u32,
    /// Finished fraction of the cycle, in 2⁻¹⁶.
    pub phase: u16,
    /// Commanded angles φ₁, φ₂ in 1e-4 rad.
    pub setpoint: [i16; 2],
    /// Pulses, ns; 0 if they are off, and at a passive joint.
    pub pulse_ns: [u32; 2],
    /// Battery voltage, mV; `None` if it is not measured.
    pub battery_mv: Option<u16>,
    /// Pose according to the model.
    pub pose: Pose,
    /// Complete frames received, modulo 2¹⁶.
    pub frames_ok: u16,
    /// Corrupt frames received, modulo 2¹⁶.
    pub frames_bad: u16,
}

/// Pose of the middle link, predicted by the model from the commanded angles, in the frame of the middle link at the start of
/// the play's first cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct Pose {
    /// Displacement along the initial heading, m.
    pub x: f32,
    /// Displacement across it, m.
    pub y: f32,
    /// Heading, rad.
    pub theta: f32,
}

/// Keep-alive, host to robot, outside the order of requests; it also requests the robot's time. It renews the lease if it is
/// fresh: the host received a frame of the robot at most a second ago, later than at any keep-alive before. So neither recorded
/// keep-alives nor those in a dead host's buffer renew the lease.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Heartbeat {
    /// Host time of sending, µs.
    pub host_us: u64,
    /// Latest robot time that the host has received in this session, µs; 0 before the first.
    pub heard_us: u64,
}

/// Reply to [`Heartbeat`], robot to host, with its sequence number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Pong {
    /// Host time of the [`Heartbeat`], µs.
    pub host_us: u64,
    /// Robot time at which the keep-alive was read, µs.
    pub received_us: u64,
    /// Robot time at which the reply was passed to the transmitter, µs.
    pub sent_us: u64,
}
