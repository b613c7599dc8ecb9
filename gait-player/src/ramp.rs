//! The way from one pair of angles to another while nothing plays: the soft start to a gait's first knot, the swap to
//! another table, and the stop to neutral. Straight in the plane of shapes, or through neutral where straight crosses.

use crate::{Limits, TICK_US};

/// Neutral: the straight swimmer.
pub const NEUTRAL: [f32; 2] = [0.0; 2];

/// A soft start takes at least this long where it moves at all, µs, so that the tank stays calm.
const GENTLE_US: f32 = 1.0e6;

/// A way in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    first: Leg,
    second: Option<Leg>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Leg {
    from: [f32; 2],
    to: [f32; 2],
    duration_us: u32,
    eased: bool,
}

impl Ramp {
    /// A soft start: eased at both ends, never faster than the limits allow, about a second where they allow it.
    pub fn soft(from: [f32; 2], to: [f32; 2], via_neutral: bool, limits: &Limits) -> Self {
        if via_neutral {
            let second = Leg::soft(NEUTRAL, to, limits);
            Self {
                first: Leg::soft(from, NEUTRAL, limits),
                second: Some(second),
            }
        } else {
            Self {
                first: Leg::soft(from, to, limits),
                second: None,
            }
        }
    }

    /// The way to neutral at the full rate: what every stop takes.
    pub fn to_neutral(from: [f32; 2], limits: &Limits) -> Self {
        let first = Leg {
            from,
            to: NEUTRAL,
            duration_us: whole_ticks(distance(from, NEUTRAL) / limits.max_rate * 1e6),
            eased: false,
        };
        Self {
            first,
            second: None,
        }
    }

    /// Time from end to end, µs.
    pub fn duration_us(&self) -> u32 {
        self.first
            .duration_us
            .saturating_add(self.second.map_or(0, |leg| leg.duration_us))
    }

    /// Angles `elapsed_us` after the start; the last ones ever after.
    pub fn at(&self, elapsed_us: u64) -> [f32; 2] {
        match &self.second {
            Some(second) if elapsed_us >= u64::from(self.first.duration_us) => {
                second.at(elapsed_us - u64::from(self.first.duration_us))
            }
            _ => self.first.at(elapsed_us),
        }
    }
}

impl Leg {
    fn soft(from: [f32; 2], to: [f32; 2], limits: &Limits) -> Self {
        // The eased profile s = t²(3 - 2t) is 1.5 times as fast in its middle as on average.
        let fastest_us = 1.5 * distance(from, to) / limits.max_rate * 1e6;
        let wanted_us = if fastest_us > 0.0 {
            fastest_us.max(GENTLE_US.min(3.0 * fastest_us))
        } else {
            0.0
        };
        Self {
            from,
            to,
            duration_us: whole_ticks(wanted_us),
            eased: true,
        }
    }

    fn at(&self, elapsed_us: u64) -> [f32; 2] {
        if elapsed_us >= u64::from(self.duration_us) {
            return self.to;
        }
        let t = elapsed_us as f32 / self.duration_us as f32;
        let s = if self.eased {
            t * t * (3.0 - 2.0 * t)
        } else {
            t
        };
        core::array::from_fn(|joint| self.from[joint] + s * (self.to[joint] - self.from[joint]))
    }
}

/// The larger of both joints' ways, rad.
fn distance(from: [f32; 2], to: [f32; 2]) -> f32 {
    libm::fmaxf(libm::fabsf(to[0] - from[0]), libm::fabsf(to[1] - from[1]))
}

/// Rounded up to whole ticks: a ramp's end falls on a tick and the last step is no longer than the others.
fn whole_ticks(us: f32) -> u32 {
    // A hair less than the quotient: rounding must not add a tick to a way that fits.
    let ticks = libm::ceilf(us / TICK_US as f32 - 1e-3);
    (ticks.max(0.0) as u32).saturating_mul(TICK_US)
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // a ramp's ends are exact
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn largest_step(ramp: &Ramp) -> f32 {
        (0..=ramp.duration_us() / TICK_US).fold(0.0_f32, |largest, tick| {
            let at = u64::from(tick * TICK_US);
            largest.max(distance(ramp.at(at), ramp.at(at + u64::from(TICK_US))))
        })
    }

    proptest! {
        #[test]
        fn no_step_is_larger_than_the_rate_allows(
            a in -2.8_f32..2.8, b in -2.8_f32..2.8, c in -2.8_f32..2.8, d in -2.8_f32..2.8, via in any::<bool>()
        ) {
            let limits = Limits::ROBOT;
            for ramp in [Ramp::soft([a, b], [c, d], via, &limits), Ramp::to_neutral([a, b], &limits)] {
                prop_assert!(largest_step(&ramp) <= limits.max_step() * 1.002, "{}", largest_step(&ramp));
                prop_assert_eq!(ramp.at(0), [a, b]);
            }
            prop_assert_eq!(Ramp::soft([a, b], [c, d], via, &limits).at(u64::MAX), [c, d]);
            prop_assert_eq!(Ramp::to_neutral([a, b], &limits).at(u64::MAX), NEUTRAL);
        }

        #[test]
        fn a_start_from_neutral_takes_at_most_two_seconds(c in -2.8_f32..2.8, d in -2.8_f32..2.8) {
            prop_assert!(Ramp::soft(NEUTRAL, [c, d], false, &Limits::ROBOT).duration_us() <= 2_000_000);
        }
    }

    #[test]
    fn a_stop_takes_the_angle_over_the_rate() {
        let ramp = Ramp::to_neutral([2.8, -1.0], &Limits::ROBOT);
        assert_eq!(ramp.duration_us(), 800_000);
        let half = ramp.at(400_000);
        assert!(
            (half[0] - 1.4).abs() < 1e-5 && (half[1] + 0.5).abs() < 1e-5,
            "{half:?}"
        );
    }

    #[test]
    fn no_way_takes_no_time() {
        assert_eq!(
            Ramp::soft([0.5, 0.5], [0.5, 0.5], false, &Limits::ROBOT).duration_us(),
            0
        );
        assert_eq!(Ramp::to_neutral(NEUTRAL, &Limits::ROBOT).duration_us(), 0);
    }
}
