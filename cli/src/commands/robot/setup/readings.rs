//! Four angles read at a protractor, and what they say of a servo: which way it turns, by how much, where it is straight, and
//! its dead band.
//!
//! The joint is commanded to −A, 0, +A and 0 again. A servo with a dead band stops that much short of each command, on the
//! side that it comes from, so that the two readings at 0 differ by twice the dead band.

use link_protocol::ServoSettings;

/// Best accuracy of a protractor over a link, rad.
const READ_WITHIN: f64 = 0.052;
/// Gains nearer to 1 are as built: a degree in each reading makes as much.
const GAIN_WITHIN: f64 = 0.05;

/// Angles of one joint in the order in which they are read, rad; positive to the left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Readings {
    /// At −A.
    pub(super) low: f64,
    /// At 0, from there.
    pub(super) after_low: f64,
    /// At +A.
    pub(super) high: f64,
    /// At 0, from there.
    pub(super) after_high: f64,
}

/// Properties of a servo, relative to the map that it was read with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ServoProperties {
    /// It turns the other way.
    pub(super) mirrored: bool,
    /// Actual over commanded angle.
    pub(super) gain: f64,
    /// Angle at the command 0, rad, without the effect of its dead band.
    pub(super) offset: f64,
    /// Half width of the dead band, rad.
    pub(super) dead_band: f64,
}

impl Readings {
    /// Evaluates the readings of a joint that was commanded to ±`swing` \[rad\].
    ///
    /// # Errors
    /// The reason why they cannot be those of a servo, as a sentence.
    pub(super) fn evaluate(&self, swing: f64) -> Result<ServoProperties, String> {
        let degrees = f64::to_degrees;
        let lag = (self.after_high - self.after_low) / 2.0;
        let turned = (self.high - self.low) / 2.0 + lag;
        if turned.abs() < 0.5 * swing {
            return Err(format!(
                "the joint turned by {:.0}° where {:.0}° to either side were commanded: is its horn screwed on, and its dead band below {:.0}°?",
                degrees(turned.abs()),
                degrees(swing),
                degrees(swing) / 2.0
            ));
        }
        let middles = [
            f64::midpoint(self.after_low, self.after_high),
            f64::midpoint(self.low, self.high),
        ];
        if (middles[0] - middles[1]).abs() > 2.0 * READ_WITHIN {
            return Err(format!(
                "the readings contradict each other: the middle of the two at 0 is {:.0}°, that of the outer two {:.0}°; is a sign wrong, or did the horn slip?",
                degrees(middles[0]),
                degrees(middles[1])
            ));
        }
        let dead_band = lag * turned.signum();
        if dead_band < -READ_WITHIN {
            return Err(format!(
                "coming from the left the joint stood {:.0}° further right than coming from the right, which no servo does; is a sign wrong?",
                degrees(-2.0 * dead_band)
            ));
        }
        Ok(ServoProperties {
            mirrored: turned < 0.0,
            gain: turned.abs() / swing,
            offset: f64::midpoint(middles[0], middles[1]),
            dead_band: dead_band.max(0.0),
        })
    }
}

impl ServoProperties {
    /// The map with which the joint follows its command, given the one that it was read with (without a trim).
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // pulses of some ms; the wire's precision
    pub(super) fn settings(&self, before: &ServoSettings) -> ServoSettings {
        let gain = if self.is_as_built() { 1.0 } else { self.gain };
        let slope = f64::from(before.slope_rad_per_us);
        let sign = |reversed: bool| if reversed { -1.0 } else { 1.0 };
        let reversed = before.reversed != self.mirrored;
        // The pulse at which it stands straight, in tenths of a µs.
        let away_us = -self.offset / (slope * gain) * sign(reversed);
        let centre_us = f64::from(before.centre_ns) / 1e3 + away_us;
        ServoSettings {
            centre_ns: (centre_us * 10.0).round() as u32 * 100,
            slope_rad_per_us: ((slope * gain * 1e6).round() / 1e6) as f32,
            reversed,
            trim: 0,
        }
    }

    /// `true` if it turns as its map states, within the accuracy of a protractor.
    pub(super) fn is_as_built(&self) -> bool {
        (self.gain - 1.0).abs() <= GAIN_WITHIN
    }
}

#[cfg(test)]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "pulses of some ms, angles in the wire's precision"
)]
mod tests {
    use super::*;
    use gait_player::servo::ServoMap;
    use gait_player::servo::plant::{PlantParameters, ServoPlant};

    const SWING: f64 = 0.4363;
    const AS_BUILT: ServoSettings = ServoSettings {
        centre_ns: 1_500_000,
        slope_rad_per_us: 0.0274,
        reversed: false,
        trim: 0,
    };

    /// Readings of a servo with `truth` that is commanded through `belief`, with resolution `grain`.
    fn read(truth: ServoMap, dead_band: f64, belief: ServoMap, grain: f64) -> Readings {
        let plant = PlantParameters {
            max_rate: 3.5,
            dead_band,
            pulse_step_ns: 320,
        };
        let mut shaft = ServoPlant::new(0.03);
        let mut at = |angle: f64| {
            let command = plant.command(&truth, belief.pulse_ns(angle as f32));
            shaft.advance(&plant, command, 10.0);
            (shaft.angle / grain).round() * grain
        };
        // Pulses begin at 0.
        at(0.0);
        Readings {
            low: at(-SWING),
            after_low: at(0.0),
            high: at(SWING),
            after_high: at(0.0),
        }
    }

    /// The servos' own model, which the wizard does not know, is what is read here.
    #[test]
    fn mirrored_off_centre_and_sluggish_servos_are_found() {
        for reversed in [false, true] {
            for centre_ns in [1_485_000, 1_500_000, 1_512_000] {
                for dead_band in [0.0_f64, 0.017, 0.14, 0.2] {
                    let truth = ServoMap {
                        centre_ns,
                        reversed,
                        ..ServoMap::ROBOT
                    };
                    let readings = read(truth, dead_band, AS_BUILT.into(), 1e-9);
                    let evaluate = readings.evaluate(SWING).unwrap();
                    assert_eq!(evaluate.mirrored, reversed);
                    assert!(
                        (evaluate.dead_band - dead_band).abs() < 0.01,
                        "{evaluate:?}"
                    );
                    let settings = evaluate.settings(&AS_BUILT);
                    assert_eq!(settings.reversed, reversed);
                    assert!(settings.centre_ns.abs_diff(centre_ns) < 500, "{settings:?}");
                    // Through a map that was wrong before the same is found.
                    let wrong = ServoSettings {
                        reversed: true,
                        centre_ns: 1_490_000,
                        ..AS_BUILT
                    };
                    let again = read(truth, dead_band, wrong.into(), 1e-9);
                    let again = again.evaluate(SWING).unwrap().settings(&wrong);
                    assert_eq!(again.reversed, reversed);
                    assert!(again.centre_ns.abs_diff(centre_ns) < 500, "{again:?}");
                }
            }
        }
    }

    /// Whole degrees are all that a protractor gives.
    #[test]
    fn whole_degrees_find_the_centre_to_a_degree_and_leave_the_slope_alone() {
        let degree = 1f64.to_radians();
        for dead_band in [0.0, 8.0 * degree] {
            for offset_us in [-11.3_f64, -4.0, 0.0, 2.2, 12.0] {
                let truth = ServoMap {
                    centre_ns: (1_500_000.0 + offset_us * 1000.0) as u32,
                    reversed: true,
                    ..ServoMap::ROBOT
                };
                let evaluate = read(truth, dead_band, AS_BUILT.into(), degree);
                let evaluate = evaluate.evaluate(SWING).unwrap();
                assert!(
                    (evaluate.dead_band - dead_band).abs() <= degree,
                    "{evaluate:?}"
                );
                let settings = evaluate.settings(&AS_BUILT);
                let straight = ServoMap::from(settings).pulse_ns(0.0);
                assert!(
                    f64::from(truth.angle(straight)).abs() <= degree,
                    "{settings:?}"
                );
                assert!((settings.slope_rad_per_us - 0.0274).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn another_slope_is_found() {
        let truth = ServoMap {
            slope_rad_per_us: 0.0274 * 1.09,
            ..ServoMap::ROBOT
        };
        let evaluate = read(truth, 0.05, AS_BUILT.into(), 1e-9);
        let settings = evaluate.evaluate(SWING).unwrap().settings(&AS_BUILT);
        assert!((settings.slope_rad_per_us / truth.slope_rad_per_us - 1.0).abs() < 0.01);
    }

    #[test]
    fn readings_that_no_servo_gives_are_told() {
        let rad = f64::to_radians;
        for (readings, words) in [
            ([1.0, 0.0, 3.0, 1.0], "the joint turned by"),
            ([-25.0, 20.0, 25.0, 20.0], "contradict"),
            ([-30.0, 8.0, 30.0, -8.0], "no servo does"),
        ] {
            let [low, after_low, high, after_high] = readings.map(rad);
            let readings = Readings {
                low,
                after_low,
                high,
                after_high,
            };
            let problem = readings.evaluate(SWING).unwrap_err();
            assert!(problem.contains(words), "{problem}");
        }
    }
}
