//! What the servos and the swimmer's body allow. The firmware brings its own limits; a configuration may only tighten
//! them.

use crate::TICK_US;
use link_protocol::Configuration;

/// Limits on angle, rate and pulse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest |φ|, rad.
    pub max_angle: f32,
    /// Largest |dφ/dt|, rad/s.
    pub max_rate: f32,
    /// Shortest pulse, ns.
    pub pulse_min_ns: u32,
    /// Longest pulse, ns.
    pub pulse_max_ns: u32,
    /// The battery is low below this, mV.
    pub battery_limit_mv: u16,
}

impl Limits {
    /// The robot's: sail-winch servos, hard clamp inside 600 to 2400 µs, a pack of 4.8 V.
    pub const ROBOT: Self = Self {
        max_angle: 2.8,
        max_rate: 3.5,
        pulse_min_ns: 1_300_000,
        pulse_max_ns: 1_700_000,
        battery_limit_mv: 4_400,
    };

    /// These limits, tightened by a configuration.
    #[must_use]
    pub fn tightened(&self, configuration: &Configuration) -> Self {
        Self {
            max_angle: self.max_angle.min(configuration.max_angle),
            max_rate: self.max_rate.min(configuration.max_rate),
            ..*self
        }
    }

    /// Largest step of an angle in one tick, rad.
    pub fn max_step(&self) -> f32 {
        self.max_rate * (TICK_US as f32 * 1e-6)
    }
}
