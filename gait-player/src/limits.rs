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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Boot;
    use crate::brain::{BrainConfig, Identity};
    use link_protocol::{Board, FirmwareVersion};

    #[test]
    fn a_configuration_tightens_and_never_loosens() {
        let firmware = FirmwareVersion {
            major: 0,
            minor: 1,
            patch: 0,
            commit: [0; 8],
        };
        let board = Board::Twin;
        let identity = Identity { firmware, board };
        let robot = BrainConfig::robot(identity, Boot::power_on(1, 1)).configuration;
        for (factor, expected) in [(0.5, 0.5), (1.0, 1.0), (2.0, 1.0)] {
            let configuration = Configuration {
                max_angle: factor * Limits::ROBOT.max_angle,
                max_rate: factor * Limits::ROBOT.max_rate,
                ..robot
            };
            let limits = Limits {
                max_angle: expected * Limits::ROBOT.max_angle,
                max_rate: expected * Limits::ROBOT.max_rate,
                ..Limits::ROBOT
            };
            assert_eq!(Limits::ROBOT.tightened(&configuration), limits);
        }
    }
}
