//! Result of the questions about one joint, in pulses and in words.

use gait_player::servo::ServoMap;
use link_protocol::{PulseRange, RobotLimits, ServoSettings};

use super::operator::{degrees, takes_it};
use super::readings::ServoProperties;
use crate::quantity;

/// Result of the questions about one joint.
pub(super) struct Measured {
    pub(super) settings: ServoSettings,
    pub(super) dead_band: f64,
    /// End stops to the right and to the left, rad; the first is negative.
    pub(super) ends: [f64; 2],
}

impl Measured {
    /// The pulses of its end stops, within those that the robot sends at all.
    pub(super) fn range(&self, full: PulseRange) -> PulseRange {
        let map = ServoMap::from(self.settings);
        #[allow(clippy::cast_possible_truncation)] // the wire's precision
        let mut pulses = self.ends.map(|angle| map.pulse_ns(angle as f32));
        pulses.sort_unstable();
        PulseRange {
            shortest_ns: pulses[0].clamp(full.shortest_ns, full.longest_ns),
            longest_ns: pulses[1].clamp(full.shortest_ns, full.longest_ns),
        }
    }
}

/// All pulses that the robot sends at all.
pub(super) fn full_range(limits: &RobotLimits) -> PulseRange {
    PulseRange {
        shortest_ns: limits.pulse_min_ns,
        longest_ns: limits.pulse_max_ns,
    }
}

/// Describes what the readings show.
pub(super) fn measured_text(
    name: &str,
    found: &ServoProperties,
    settings: &ServoSettings,
) -> String {
    let mut parts = vec![
        if found.mirrored {
            "turns the other way: its sign is changed"
        } else {
            "turns the right way"
        }
        .to_owned(),
        format!(
            "stands {} from straight: its centre is {} µs",
            quantity::angle(found.offset),
            f64::from(settings.centre_ns) / 1e3
        ),
    ];
    if !found.is_as_built() {
        parts.push(format!(
            "turns {:.0} % of the commanded angle: its slope is {} rad a µs",
            found.gain * 100.0,
            settings.slope_rad_per_us
        ));
    }
    format!("The {name} joint {}.", parts.join("; it "))
}

/// Parses two angles in degrees, to the left and to the right; the right end is negative.
pub(super) fn end_stops(answer: &str, most: f64) -> Result<[f64; 2], String> {
    if takes_it(answer) {
        return Ok([-most, most]);
    }
    let advice = || {
        format!(
            "Write two angles in degrees between 1 and {}, as 90 75.",
            most.to_degrees().floor()
        )
    };
    let mut angles = answer.split_whitespace().map(degrees);
    let (Some(Ok(left)), Some(Ok(right)), None) = (angles.next(), angles.next(), angles.next())
    else {
        return Err(advice());
    };
    let fits = |angle: f64| (0.017..=most + 1e-3).contains(&angle);
    if fits(left) && fits(right) {
        Ok([-right, left])
    } else {
        Err(advice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn end_stops_are_two_angles() {
        assert_eq!(end_stops("", 2.8), Ok([-2.8, 2.8]));
        let [right, left] = end_stops("90 75", 2.8).unwrap();
        assert!((left - 90f64.to_radians()).abs() < 1e-12);
        assert!((right + 75f64.to_radians()).abs() < 1e-12);
        for text in ["90", "90 75 1", "-90 75", "0 75", "170 75", "x y"] {
            assert!(end_stops(text, 2.8).is_err(), "{text}");
        }
    }

    /// A mirrored servo's left end is its short pulse.
    #[test]
    fn end_stops_become_pulses_within_the_robots_own() {
        let full = PulseRange {
            shortest_ns: 1_400_000,
            longest_ns: 1_700_000,
        };
        let measured = |reversed| Measured {
            settings: ServoSettings {
                centre_ns: 1_500_000,
                slope_rad_per_us: 0.02,
                reversed,
                trim: 0,
            },
            dead_band: 0.0,
            ends: [-1.0, 2.4],
        };
        let range = measured(false).range(full);
        assert_eq!(
            (range.shortest_ns, range.longest_ns),
            (1_450_000, 1_620_000)
        );
        let range = measured(true).range(full);
        assert_eq!(
            (range.shortest_ns, range.longest_ns),
            (1_400_000, 1_550_000)
        );
    }
}
