//! What a servo makes of its pulses: a limited rate and a dead band. The one truth for the twin (which moves by it), the
//! calibration and every prediction (which must know what really moved).
//!
//! The dead band is a play operator: the shaft stands while the command is within `dead_band` of it; beyond, it runs at
//! `max_rate` towards the command and stops where the error has shrunk to `dead_band`.

use super::ServoMap;

/// What sets a servo apart from an ideal one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantParameters {
    /// Fastest turn, rad/s; infinite for none.
    pub max_rate: f64,
    /// Error that does not move the shaft yet, rad; 0 for none.
    pub dead_band: f64,
    /// Pulses come in multiples of this, ns; 0 and 1 for whole nanoseconds.
    pub pulse_step_ns: u32,
}

impl PlantParameters {
    /// A servo that is where it is told to be.
    pub const IDEAL: Self = Self {
        max_rate: f64::INFINITY,
        dead_band: 0.0,
        pulse_step_ns: 0,
    };

    /// The angle that a pulse commands: quantised as the timer quantises it, then read by the map.
    pub fn command(&self, map: &ServoMap, pulse_ns: u32) -> f64 {
        let step = self.pulse_step_ns.max(1);
        let quantised = pulse_ns.saturating_add(step / 2) / step * step;
        f64::from(map.angle(quantised))
    }
}

/// A servo's shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoPlant {
    /// Where the shaft is, rad.
    pub angle: f64,
}

impl ServoPlant {
    /// A shaft at rest at `angle` \[rad\].
    pub const fn new(angle: f64) -> Self {
        Self { angle }
    }

    /// Time until the shaft stands under a constant command \[s\]; 0 where it stands already.
    pub fn time_to_rest(&self, parameters: &PlantParameters, command: f64) -> f64 {
        let excess = libm::fabs(command - self.angle) - parameters.dead_band;
        if excess > 0.0 {
            excess / parameters.max_rate
        } else {
            0.0
        }
    }

    /// Lets `seconds` pass under a constant command \[rad\]; exact.
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
