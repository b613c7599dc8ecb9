//! Check of a table before it may play: of the interpolant, not only of the knots. It runs in pieces, because a chip without an
//! FPU has two milliseconds per tick; a checker consumes units of work until it returns the [`Facts`].

use super::{Cubic, GaitTable};
use crate::Limits;
use crate::clearance::{clearance, margin, motion};
use libm::{fabsf, sqrtf};
use link_protocol::{ANGLE_UNIT_RAD, CrossingPlace, Joint, Refusal};
use swimmer_model::Links;

/// Allowed overshoot of the interpolant beyond the largest angle, 1e-4 rad. At a corner of a gait on its bound it overshoots by
/// a share of one step. The clamp before the servos cuts it off.
const ANGLE_SLACK: f32 = 50.0;
/// Factor by which slopes may exceed the limit because of rounding to 1e-4 rad.
const RATE_SLACK: f32 = 1.005;
/// Largest ratio of the closing step to the largest other step (plus rounding): gaits are not sampled uniformly in arc length.
const CLOSING_FACTOR: f32 = 2.0;
const CLOSING_SLACK: f32 = 20.0;
/// Units of work of a clearance evaluation; the angles and slopes of an interval are one unit.
pub(crate) const CLEARANCE_WORK: u32 = 2;
/// Share of the margin that may be lost between two clearance evaluations.
const GIVEN_UP: f32 = 0.5;

/// Position in a table with the largest value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest {
    /// Joint of the value.
    pub joint: Joint,
    /// Index of the knot before the position.
    pub knot: u16,
    /// Value there, in 1e-4 rad, or 1e-4 rad per interval.
    pub value: f32,
}

/// Results of a table's check, independent of limits and period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facts {
    knots: u16,
    angle: Largest,
    slope: Largest,
    open: Option<Refusal>,
    crossing: Option<Refusal>,
}

impl Facts {
    /// Checks that the table may be active: closed, clear of crossings, within the largest angle.
    ///
    /// # Errors
    /// The first violated condition.
    pub fn allow(&self, limits: &Limits) -> Result<(), Refusal> {
        if let Some(refusal) = self.open.or(self.crossing) {
            return Err(refusal);
        }
        let limit = limits.max_angle / ANGLE_UNIT_RAD;
        if fabsf(self.angle.value) > limit + ANGLE_SLACK {
            let Largest { joint, knot, value } = self.angle;
            return Err(Refusal::AngleLimit {
                joint,
                knot,
                angle: value as i32,
                limit: limit as i32,
            });
        }
        Ok(())
    }

    /// Shortest period within the rate limit of both joints, µs.
    pub fn min_period_us(&self, limits: &Limits) -> u32 {
        let seconds = shortest_period(fabsf(self.slope.value), self.knots, limits);
        libm::ceilf(seconds * 1e6) as u32
    }

    /// Checks that the table may play at this period.
    ///
    /// # Errors
    /// The period is too short.
    pub fn allow_period(&self, limits: &Limits, period_us: u32) -> Result<(), Refusal> {
        let min_period_us = self.min_period_us(limits);
        if period_us < min_period_us {
            let Largest { joint, knot, .. } = self.slope;
            return Err(Refusal::RateLimit {
                joint,
                knot,
                min_period_us,
            });
        }
        Ok(())
    }
}

/// Shortest period within the rate limit for a joint of this slope (1e-4 rad per interval), s.
fn shortest_period(slope: f32, knots: u16, limits: &Limits) -> f32 {
    slope * ANGLE_UNIT_RAD * f32::from(knots) / (limits.max_rate * RATE_SLACK)
}

impl GaitTable {
    /// Shortest period within the rate limit for one interval, s. The maximum over all intervals is [`Facts::min_period_us`];
    /// the profile shows where a gait is too fast.
    pub fn interval_period(&self, interval: usize, limits: &Limits) -> f32 {
        let slopes = self
            .interval(interval)
            .map(|cubic| fabsf(cubic.largest_slope()));
        shortest_period(slopes[0].max(slopes[1]), self.knots() as u16, limits)
    }
}

/// Check in progress.
#[derive(Clone, Debug)]
pub struct Checker {
    next: usize,
    angle: Largest,
    slope: Largest,
    steps: [f32; 2],
    crossing: Option<Refusal>,
    /// Position within the interval, 0 to 1.
    at: f32,
    /// Distance that the links may still move before the last clearance is used up, m.
    reach: f32,
}

const NOTHING: Largest = Largest {
    joint: Joint::Front,
    knot: 0,
    value: 0.0,
};

impl Checker {
    /// Returns a checker at the start of a table.
    pub const fn new() -> Self {
        Self {
            next: 0,
            angle: NOTHING,
            slope: NOTHING,
            steps: [0.0; 2],
            crossing: None,
            at: 0.0,
            reach: 0.0,
        }
    }

    /// Does `work` units of work (a few more at most). Returns the facts when all is done.
    pub fn advance(&mut self, table: &GaitTable, links: &Links<f32>, work: u32) -> Option<Facts> {
        let mut left = work.max(1);
        while self.next < table.knots() {
            if left == 0 {
                return None;
            }
            let cubics = table.interval(self.next);
            self.measure(&cubics, table.knots());
            left -= 1;
            if !self.follow(&cubics, links, &mut left) {
                return None;
            }
            self.next += 1;
        }
        let knots = table.knots() as u16;
        Some(Facts {
            knots,
            angle: self.angle,
            slope: self.slope,
            open: self.closing(table),
            crossing: self.crossing,
        })
    }

    /// Measures angles and slopes of one interval; idempotent.
    fn measure(&mut self, cubics: &[Cubic; 2], knots: usize) {
        let knot = self.next as u16;
        for (joint, cubic) in [Joint::Front, Joint::Back].into_iter().zip(cubics) {
            let largest = cubic.largest_value(fabsf(self.angle.value));
            raise(&mut self.angle, joint, knot, largest);
            raise(&mut self.slope, joint, knot, cubic.largest_slope());
            if self.next + 1 < knots {
                let rise = fabsf(cubic.value(1.0) - cubic.a);
                self.steps[joint.index()] = self.steps[joint.index()].max(rise);
            }
        }
    }

    /// Follows one interval between clearance evaluations, each step as long as the last clearance allows. Returns true at the
    /// end of the interval.
    fn follow(&mut self, cubics: &[Cubic; 2], links: &Links<f32>, left: &mut u32) -> bool {
        if self.crossing.is_some() {
            return true;
        }
        let moved = |turns: [f32; 2]| motion(links, turns.map(|turn| turn * ANGLE_UNIT_RAD));
        let way = moved([0, 1].map(|joint| cubics[joint].way()));
        let fastest = moved([0, 1].map(|joint| cubics[joint].largest_slope()));
        loop {
            let ahead = way.min(fastest * (1.0 - self.at));
            if self.reach >= ahead {
                self.reach -= ahead;
                self.at = 0.0;
                return true;
            }
            if *left == 0 {
                return false;
            }
            self.at += self.reach / fastest;
            let angles = [0, 1].map(|joint| cubics[joint].value(self.at) * ANGLE_UNIT_RAD);
            let spare = clearance(links, angles) - margin(links);
            *left = left.saturating_sub(CLEARANCE_WORK);
            if spare < 0.0 {
                let [phi1, phi2] = angles.map(|angle| (angle / ANGLE_UNIT_RAD) as i16);
                self.crossing = Some(Refusal::LinksCross {
                    place: CrossingPlace::Gait(self.next as u16),
                    phi1,
                    phi2,
                });
                return true;
            }
            self.reach = spare + GIVEN_UP * margin(links);
        }
    }

    fn closing(&self, table: &GaitTable) -> Option<Refusal> {
        let (first, last) = (table.knot(0), table.knot(table.knots().saturating_sub(1)));
        [Joint::Front, Joint::Back].into_iter().find_map(|joint| {
            let step = i32::from(first[joint.index()]) - i32::from(last[joint.index()]);
            let largest = self.steps[joint.index()];
            let open = fabsf(step as f32) > CLOSING_FACTOR * largest + CLOSING_SLACK;
            open.then_some(Refusal::NotClosed {
                joint,
                step,
                largest: largest as i32,
            })
        })
    }
}

impl Default for Checker {
    fn default() -> Self {
        Self::new()
    }
}

fn raise(largest: &mut Largest, joint: Joint, knot: u16, value: f32) {
    if fabsf(value) > fabsf(largest.value) {
        *largest = Largest { joint, knot, value };
    }
}

impl Cubic {
    /// Value of largest magnitude for t in \[0, 1\]; any smaller one if none exceeds `known`.
    fn largest_value(&self, known: f32) -> f32 {
        let end = self.value(1.0);
        let largest = larger(self.a, end);
        // The curve lies within the convex hull of its control points.
        let hull = larger(
            larger(
                self.a + self.b / 3.0,
                self.a + (2.0 * self.b + self.c) / 3.0,
            ),
            largest,
        );
        if fabsf(hull) <= known.max(fabsf(largest)) {
            return largest;
        }
        // Roots of the slope b + 2ct + 3dt², in the form without cancellation.
        let root = sqrtf((self.c * self.c - 3.0 * self.b * self.d).max(0.0));
        let q = -(self.c + if self.c < 0.0 { -root } else { root });
        let at = |t: f32| {
            if (0.0..=1.0).contains(&t) {
                self.value(t)
            } else {
                end
            }
        };
        larger(largest, larger(at(q / (3.0 * self.d)), at(self.b / q)))
    }

    /// Slope of largest magnitude for t in \[0, 1\].
    fn largest_slope(&self) -> f32 {
        let ends = larger(self.b, self.slope(1.0));
        let vertex = -self.c / (3.0 * self.d);
        if (0.0..=1.0).contains(&vertex) {
            larger(ends, self.slope(vertex))
        } else {
            ends
        }
    }

    /// Upper bound of the total variation of the angle: the length of the control polygon.
    fn way(&self) -> f32 {
        fabsf(self.b) / 3.0
            + fabsf(self.b + self.c) / 3.0
            + fabsf(self.b + 2.0 * self.c + 3.0 * self.d) / 3.0
    }
}

fn larger(a: f32, b: f32) -> f32 {
    if fabsf(b) > fabsf(a) { b } else { a }
}
