//! Servo model: shaft angle from pulses, with rate limit and dead band. Twin, calibration and every prediction share it.
//!
//! The dead band is a play operator: the shaft stands while the command is within `dead_band` of it. Beyond, it turns at
//! `max_rate` towards the command and stops at an error of `dead_band`.

use super::ServoMap;

/// Parameters of a real servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantParameters {
    /// Largest rate, rad/s; infinite for an ideal servo.
    pub max_rate: f64,
    /// Largest error that does not move the shaft, rad; 0 for an ideal servo.
    pub dead_band: f64,
    /// Resolution of the pulses, ns; 0 and 1 stand for whole nanoseconds.
    pub pulse_step_ns: u32,
}

impl PlantParameters {
    /// Ideal servo: the shaft equals the command.
    pub const IDEAL: Self = Self {
        max_rate: f64::INFINITY,
        dead_band: 0.0,
        pulse_step_ns: 0,
    };

    /// Angle that a pulse commands, rad: quantised like the timer, then read by the map.
    pub fn command(&self, map: &ServoMap, pulse_ns: u32) -> f64 {
        let step = self.pulse_step_ns.max(1);
        let quantised = pulse_ns.saturating_add(step / 2) / step * step;
        f64::from(map.angle(quantised))
    }
}

/// Shaft of a servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoPlant {
    /// Angle of the shaft, rad.
    pub angle: f64,
}

impl ServoPlant {
    /// Returns a shaft at rest at `angle` \[rad\].
    pub const fn new(angle: f64) -> Self {
        Self { angle }
    }

    /// Time until the shaft stands under a constant command, s; 0 if it stands already.
    pub fn time_to_rest(&self, parameters: &PlantParameters, command: f64) -> f64 {
        let excess = libm::fabs(command - self.angle) - parameters.dead_band;
        if excess > 0.0 {
            excess / parameters.max_rate
        } else {
            0.0
        }
    }

    /// Advances by `seconds` under a constant command \[rad\]; exact.
    pub fn advance(&mut self, parameters: &PlantParameters, command: f64, seconds: f64) {
        let error = command - self.angle;
        let excess = libm::fabs(error) - parameters.dead_band;
        if excess > 0.0 {
            let step = libm::fmin(excess, parameters.max_rate * seconds);
            self.angle += libm::copysign(step, error);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO: PlantParameters = PlantParameters {
        max_rate: 2.0,
        dead_band: 0.1,
        pulse_step_ns: 0,
    };

    #[test]
    fn it_stands_within_its_dead_band() {
        let mut plant = ServoPlant::new(0.5);
        plant.advance(&SERVO, 0.59, 1.0);
        plant.advance(&SERVO, 0.41, 1.0);
        assert!((plant.angle - 0.5).abs() < 1e-15);
        assert!(plant.time_to_rest(&SERVO, 0.59) <= 0.0);
    }

    #[test]
    fn it_stops_a_dead_band_short_from_either_side() {
        let mut plant = ServoPlant::new(0.0);
        plant.advance(&SERVO, 1.0, 10.0);
        assert!((plant.angle - 0.9).abs() < 1e-15);
        plant.advance(&SERVO, 0.0, 10.0);
        assert!((plant.angle - 0.1).abs() < 1e-15);
    }

    #[test]
    fn it_runs_at_its_rate_whatever_the_steps() {
        let mut plant = ServoPlant::new(0.0);
        assert!((plant.time_to_rest(&SERVO, -1.0) - 0.45).abs() < 1e-15);
        for _ in 0..4 {
            plant.advance(&SERVO, -1.0, 0.1);
        }
        assert!((plant.angle + 0.8).abs() < 1e-12);
        plant.advance(&SERVO, -1.0, 0.1);
        assert!((plant.angle + 0.9).abs() < 1e-12);
    }

    #[test]
    fn an_ideal_servo_is_where_it_is_told() {
        let mut plant = ServoPlant::new(0.0);
        plant.advance(&PlantParameters::IDEAL, 1.25, 1e-9);
        assert!((plant.angle - 1.25).abs() < 1e-15);
    }

    #[test]
    fn pulses_are_rounded_to_the_timer_step() {
        let timer = PlantParameters {
            pulse_step_ns: 320,
            ..PlantParameters::IDEAL
        };
        let map = ServoMap::ROBOT;
        assert!((timer.command(&map, 1_500_100) - f64::from(map.angle(1_500_160))).abs() < 1e-9);
        assert!((timer.command(&map, 1_500_350) - f64::from(map.angle(1_500_480))).abs() < 1e-9);
    }
}
