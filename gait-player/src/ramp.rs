//! Ramps between two shapes outside a play: soft start to a gait's first knot, swap to another table, and stop to neutral. The
//! path is straight in shape space, or passes through neutral if the straight path crosses.

use crate::{Limits, TICK_US};

/// Neutral: the straight swimmer.
pub const NEUTRAL: [f32; 2] = [0.0; 2];

/// Shortest soft start that moves at all, µs, so that the tank stays calm.
const GENTLE_US: f32 = 1.0e6;
/// Longest soft start, µs, also through neutral: a promise to the operator. If the limits leave too little time, the easing is
/// reduced first.
const LONGEST_US: f32 = 2.0e6;

/// Ramp over time.
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
    /// Share of the eased profile, 0 to 1; the rest has a constant rate.
    ease: f32,
}

impl Ramp {
    /// Soft start: eased at both ends, within the limits, about one second if they allow it. At most two seconds for all limits
    /// that [`link_protocol::Configuration`] may have.
    pub fn soft(from: [f32; 2], to: [f32; 2], via_neutral: bool, limits: &Limits) -> Self {
        let corner = if via_neutral { NEUTRAL } else { to };
        let wanted_us = [(from, corner), (corner, to)].map(|(a, b)| Leg::wanted_us(a, b, limits));
        // Each leg is rounded up to whole ticks if there is time: two rounded legs can exceed a total that the unrounded ones
        // satisfy.
        let rounded_us = wanted_us.map(whole_ticks);
        let share = if rounded_us[0].saturating_add(rounded_us[1]) > LONGEST_US as u32 {
            Some((LONGEST_US / (wanted_us[0] + wanted_us[1])).min(1.0))
        } else {
            None
        };
        Self {
            first: Leg::soft(from, corner, share, limits),
            second: via_neutral.then(|| Leg::soft(corner, to, share, limits)),
        }
    }

    /// Ramp of every stop: to neutral at the full rate. It is not checked for crossing, because it must begin at once. Within
    /// the largest angle of [`Limits::ROBOT`] no such path brings the side links closer than at its start
    /// (`tests/player/crossing.rs`).
    pub fn to_neutral(from: [f32; 2], limits: &Limits) -> Self {
        let first = Leg {
            from,
            to: NEUTRAL,
            duration_us: whole_ticks(fastest_us(from, NEUTRAL, limits)),
            ease: 0.0,
        };
        Self {
            first,
            second: None,
        }
    }

    /// Total duration, µs.
    pub fn duration_us(&self) -> u32 {
        self.first
            .duration_us
            .saturating_add(self.second.map_or(0, |leg| leg.duration_us))
    }

    /// Angles `elapsed_us` after the start, rad; constant after the end.
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
    /// Duration of a soft leg without a time limit, µs.
    fn wanted_us(from: [f32; 2], to: [f32; 2], limits: &Limits) -> f32 {
        // The eased profile s = t²(3 - 2t) is 1.5 times as fast at its midpoint as on average.
        let eased_us = 1.5 * fastest_us(from, to, limits);
        eased_us.max(GENTLE_US.min(3.0 * eased_us))
    }

    /// Soft leg with its natural duration, or with this share of it if time is short.
    fn soft(from: [f32; 2], to: [f32; 2], share: Option<f32>, limits: &Limits) -> Self {
        let (fastest_us, wanted_us) = (
            fastest_us(from, to, limits),
            Self::wanted_us(from, to, limits),
        );
        let duration_us = match share {
            // Rounded down, so two legs together keep the promise.
            Some(share) => {
                let ticks = libm::floorf(share * wanted_us / TICK_US as f32 + 1e-3);
                (ticks as u32 * TICK_US).max(whole_ticks(fastest_us))
            }
            None => whole_ticks(wanted_us),
        };
        // A share `e` of easing makes the midpoint 1 + e/2 times as fast as the average.
        let spare = duration_us as f32 / fastest_us - 1.0;
        Self {
            from,
            to,
            duration_us,
            ease: (2.0 * spare).clamp(0.0, 1.0),
        }
    }

    fn at(&self, elapsed_us: u64) -> [f32; 2] {
        if elapsed_us >= u64::from(self.duration_us) {
            return self.to;
        }
        let t = elapsed_us as f32 / self.duration_us as f32;
        let s = t + self.ease * t * (t * (3.0 - 2.0 * t) - 1.0);
        core::array::from_fn(|joint| self.from[joint] + s * (self.to[joint] - self.from[joint]))
    }
}

/// Larger of both joints' rotations, rad.
fn distance(from: [f32; 2], to: [f32; 2]) -> f32 {
    libm::fmaxf(libm::fabsf(to[0] - from[0]), libm::fabsf(to[1] - from[1]))
}

/// Duration at the full rate, µs.
fn fastest_us(from: [f32; 2], to: [f32; 2], limits: &Limits) -> f32 {
    distance(from, to) / limits.max_rate * 1e6
}

/// Rounds up to whole ticks, so that a ramp ends on a tick and its last step is no longer than the others.
fn whole_ticks(us: f32) -> u32 {
    // A small tolerance: rounding must not add a tick to a fitting duration.
    let ticks = libm::ceilf(us / TICK_US as f32 - 1e-3);
    (ticks.max(0.0) as u32).saturating_mul(TICK_US)
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // the ends of a ramp are exact
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

        /// Any start, also through neutral, with the tightest limits that Configure allows.
        #[test]
        fn every_soft_start_takes_at_most_two_seconds(
            ends in prop::array::uniform4(-1.0_f32..=1.0), corners in any::<bool>(), via in any::<bool>(),
            max_angle in 0.01_f32..2.8, needs_s in 0.1_f32..=1.0
        ) {
            let limits = Limits { max_angle, max_rate: max_angle / needs_s, ..Limits::ROBOT };
            let [a, b, c, d] = ends.map(|end| max_angle * if corners { end.signum() } else { end });
            let ramp = Ramp::soft([a, b], [c, d], via, &limits);
            prop_assert!(ramp.duration_us() <= 2_000_000, "{}", ramp.duration_us());
            prop_assert!(largest_step(&ramp) <= limits.max_step() * 1.002, "{}", largest_step(&ramp) / limits.max_step());
        }
    }

    /// Counterexample of the property above: 1.06 and 0.92 s are less than two, but not if each is rounded up to a tick.
    #[test]
    fn two_legs_that_want_just_less_than_two_seconds_get_no_more() {
        let limits = Limits {
            max_angle: 0.01,
            max_rate: 0.01 / 0.715_860_96,
            ..Limits::ROBOT
        };
        let ramp = Ramp::soft([0.009_915_114, 0.0], [0.002_867_301_7, 0.0], true, &limits);
        assert_eq!(ramp.duration_us(), 2_000_000 - TICK_US);
        assert!(largest_step(&ramp) <= limits.max_step() * 1.002);
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
