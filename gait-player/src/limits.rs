//! Limits of the servos and the swimmer's body. The firmware sets its own limits; a configuration may only tighten them.

use crate::TICK_US;
use crate::servo::ServoMap;
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
    /// Pulse of a straight joint as built, ns. Settings may differ from it by [`CENTRE_ROOM_NS`].
    pub centre_ns: u32,
    /// Angle per pulse as built, rad/µs. Settings may differ from it by [`SLOPE_ROOM`]. The slope converts the rate limit to
    /// pulses, so an arbitrary slope would defeat that limit.
    pub slope_rad_per_us: f32,
    /// Low-battery limit, mV.
    pub battery_limit_mv: u16,
}

/// Allowed deviation of a servo's centre, ns. The horn sits on its spline by teeth of 14°, and servos differ in their straight
/// pulse; 20 µs are 31° here.
pub const CENTRE_ROOM_NS: u32 = 20_000;
/// Allowed relative deviation of a servo's slope from its type.
pub const SLOPE_ROOM: f32 = 0.1;

impl Limits {
    /// Limits of the robot: sail-winch servos, hard clamp inside 600 to 2400 µs, a pack of 4.8 V.
    pub const ROBOT: Self = Self {
        max_angle: 2.8,
        max_rate: 3.5,
        pulse_min_ns: 1_300_000,
        pulse_max_ns: 1_700_000,
        centre_ns: ServoMap::ROBOT.centre_ns,
        slope_rad_per_us: ServoMap::ROBOT.slope_rad_per_us,
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

    /// Returns true if a servo may have this centre \[ns\].
    pub fn allows_centre(&self, centre_ns: u32) -> bool {
        (self.pulse_min_ns..=self.pulse_max_ns).contains(&centre_ns)
            && centre_ns.abs_diff(self.centre_ns) <= CENTRE_ROOM_NS
    }

    /// Returns true if a servo may have this slope \[rad/µs\]; false for NaN.
    pub fn allows_slope(&self, slope_rad_per_us: f32) -> bool {
        let share = slope_rad_per_us / self.slope_rad_per_us;
        (1.0 - SLOPE_ROOM..=1.0 + SLOPE_ROOM).contains(&share)
    }

    /// Largest step of an angle per tick, rad.
    pub fn max_step(&self) -> f32 {
        self.max_rate * (TICK_US as f32 * 1e-6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BrainConfig;

    #[test]
    fn a_configuration_tightens_and_never_loosens() {
        let robot = BrainConfig::in_tests().configuration;
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
