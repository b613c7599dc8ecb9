//! Map between joint angle and servo pulse, shared by the brain, the twin, the calibration and the optimiser.

pub mod plant;

use link_protocol::{ANGLE_UNIT_RAD, ServoSettings};

/// Map of one servo: `pulse = centre ± (angle + trim) / slope`. Pulses are in ns, because one µs is 1.57° here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoMap {
    /// Pulse of the straight joint, ns.
    pub centre_ns: u32,
    /// Angle per pulse, rad/µs; positive.
    pub slope_rad_per_us: f32,
    /// The angle grows as the pulse gets shorter.
    pub reversed: bool,
    /// Added to every angle, rad.
    pub trim: f32,
}

impl ServoMap {
    /// The robot's Hitec HS-785HB as built: 1500 µs straight, 1.57° per µs.
    pub const ROBOT: Self = Self {
        centre_ns: 1_500_000,
        slope_rad_per_us: 0.0274,
        reversed: false,
        trim: 0.0,
    };

    /// Pulse for a joint angle \[rad\], ns, rounded and not limited (the clamp does that). NaN gives the centre.
    pub fn pulse_ns(&self, angle: f32) -> u32 {
        let away_ns = (angle + self.trim) / self.slope_rad_per_us * 1000.0;
        let away_ns = if self.reversed { -away_ns } else { away_ns };
        // Two steps: the sum in f32 would lose the last digits of the nanoseconds. `as` saturates, and NaN becomes 0.
        self.centre_ns
            .saturating_add_signed(libm::roundf(away_ns) as i32)
    }

    /// Joint angle of a pulse, rad.
    pub fn angle(&self, pulse_ns: u32) -> f32 {
        let away_us = (i64::from(pulse_ns) - i64::from(self.centre_ns)) as f32 / 1000.0;
        let away = away_us * self.slope_rad_per_us;
        (if self.reversed { -away } else { away }) - self.trim
    }

    /// Pulse change for a step of the angle, ns, rounded up.
    pub fn step_ns(&self, step: f32) -> u32 {
        libm::ceilf(step / self.slope_rad_per_us * 1000.0) as u32
    }
}

impl From<ServoSettings> for ServoMap {
    fn from(settings: ServoSettings) -> Self {
        Self {
            centre_ns: settings.centre_ns,
            slope_rad_per_us: settings.slope_rad_per_us,
            reversed: settings.reversed,
            trim: f32::from(settings.trim) * ANGLE_UNIT_RAD,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_and_its_inverse_agree() {
        for reversed in [false, true] {
            let map = ServoMap {
                reversed,
                trim: 0.03,
                ..ServoMap::ROBOT
            };
            for step in -280_i16..=280 {
                let angle = f32::from(step) / 100.0;
                // Half a nanosecond is 1.4e-5 rad; the rest is rounding of f32.
                assert!(
                    (map.angle(map.pulse_ns(angle)) - angle).abs() < 1.6e-5,
                    "{angle}"
                );
            }
        }
    }

    #[test]
    fn forty_five_degrees_are_28_microseconds() {
        let away = ServoMap::ROBOT.pulse_ns(core::f32::consts::FRAC_PI_4) - 1_500_000;
        assert!((28_600..28_700).contains(&away), "{away}");
    }

    #[test]
    fn settings_on_the_wire_are_the_map_with_the_trim_in_radians() {
        let settings = ServoSettings {
            centre_ns: 1_490_000,
            slope_rad_per_us: 0.03,
            reversed: true,
            trim: -250,
        };
        let map = ServoMap::from(settings);
        assert!((map.trim + 0.025).abs() < 1e-7, "{map:?}");
        let without = ServoMap {
            centre_ns: 1_490_000,
            slope_rad_per_us: 0.03,
            reversed: true,
            trim: map.trim,
        };
        assert_eq!(map, without);
    }

    #[test]
    fn nonsense_does_not_wrap_around() {
        let map = ServoMap::ROBOT;
        assert_eq!(map.pulse_ns(f32::NAN), 1_500_000);
        assert_eq!(map.pulse_ns(f32::NEG_INFINITY), 0);
        assert!(map.pulse_ns(f32::INFINITY) > 2_000_000_000);
    }
}
