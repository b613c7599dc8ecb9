//! The search for the start: every extremal leaves the same one-parameter family, and is kept where λ₄ ends at zero.
//!
//! A singular arc can begin in two places: on φ₁ = φ₂ at some angle, or at the end of an arc that ran along a bound from the
//! corner where that bound meets φ₁ = φ₂. Such a line of places is a [`StartFamily`]. At each place the height vanishes for just
//! one `y_f`, so the place fixes the whole extremal, and a scan over the family with a scalar root search on
//! `λ₄(t_f) = 0` finds every quarter gait without a guess. One more candidate never leaves the bound at all.

use swimmer_model::Model;

use super::Fates;
use super::flow::{FINE, Fate, Quarter, Touch, TraceOptions, follow, lasting};
use super::start_family::{Place, StartFamily};
use crate::arcs::{SMOOTH, Trace};
use crate::cycle::Cycle;
use crate::momentum::{Flow, Momentum, Motion, State, shape};
use crate::numerics::root;
use crate::region::Region;
use crate::runge_kutta::StepControl;

/// An extremal that meets all end conditions.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) quarter: Quarter,
    pub(crate) momentum: Momentum,
}

impl Candidate {
    /// The cycle in four times so many samples at equal steps of power length; none where it cannot be traced.
    pub(crate) fn cycle(&self, model: &Model<f64>, samples: usize) -> Option<Cycle> {
        let legs = || lasting(&self.quarter.legs);
        let mut start = legs().next()?.from;
        start[5] = 0.0;
        let route: Vec<_> = legs()
            .map(|leg| (leg.motion, leg.to[5] - leg.from[5]))
            .collect();
        let trace = Trace::new((model, self.momentum), start, &route, &[], samples)?;
        let [first, last] = trace.ends()?;
        // Square to φ₁ = φ₂ (φ₁ = −φ₂) is a direction without a part along it.
        let square = [first.x + first.y, last.x - last.y].map(|along| along.abs() < SMOOTH);
        Some(trace.samples(false).unfolded(square))
    }
}

/// The shooting problem.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Search<'a> {
    /// The swimmer with L = 1.
    pub(crate) model: &'a Model<f64>,
    pub(crate) region: &'a Region,
    /// λ₃.
    pub(crate) sign: f64,
    /// What the quarter does where it first meets φ₁ = −φ₂; it ends where it meets that line again.
    pub(crate) touch: Touch,
    /// Places to look at on each family.
    pub(crate) scan_points: usize,
}

/// What a scan saw beside the candidates.
#[derive(Debug, Clone, Default)]
pub(crate) struct Seen {
    pub(crate) fates: Fates,
    /// Extremals that end, whatever their λ₄ there: the family's index, the place on it and λ₃ x.
    ended: Vec<(usize, f64, f64)>,
}

impl Seen {
    /// Those of the extremals seen that carry farthest: gaits within the bounds, but no optima, since their λ₄ does not end at zero. Only
    /// such as may carry a quarter farther than `least`. Each with its family's index, the place on it, and how far it carries, about.
    pub(crate) fn farthest(&self, least: f64) -> impl Iterator<Item = (usize, f64, f64)> + use<> {
        const MOST: usize = 24;
        /// How far off the coarse scan may be, over L.
        const OFF: f64 = 1e-3;
        let mut ended = self.ended.clone();
        ended.retain(|(_, _, carried)| *carried > least - OFF);
        ended.sort_by(|a, b| b.2.total_cmp(&a.2));
        ended.into_iter().take(MOST)
    }
}

/// Places looked at on each family.
pub(crate) const SCAN_POINTS: usize = 40;
/// The same where that finds no optimum: the places from which extremals end may lie in a narrow gap.
pub(crate) const FINER_SCAN: usize = 320;
const COARSE: StepControl = StepControl {
    tolerance: 1e-4,
    longest: 0.7,
};
/// |λ₄| over L from which on the fine tolerance takes over.
const NEAR: f64 = 1e-3;
const MIDDLING: StepControl = StepControl {
    tolerance: 1e-9,
    longest: 0.5,
};
/// Halvings of an interval at whose ends different arcs follow each other, or of which only one end has an extremal that ends.
const HALVINGS: usize = 10;
/// Most extremals that these cost on a family: where other arcs follow from place to place, that is rounding.
const MOST_REFINEMENTS: usize = 2 * SCAN_POINTS;

/// An extremal that ends.
#[derive(Debug, Clone, Copy)]
struct Miss {
    lambda4: f64,
    /// Which arcs follow each other.
    arcs: u64,
    /// Whether it heads the right way; what does not is no gait.
    heads: bool,
}

/// A place looked at, and the extremal from there where it ends.
type Look = (f64, Option<Miss>);

impl<'a> Search<'a> {
    /// All candidates, in the order of the families, and what became of the rest.
    pub(crate) fn candidates(&self, families: &[StartFamily]) -> (Vec<Candidate>, Seen) {
        let mut seen = Seen::default();
        let mut found = Vec::new();
        for (index, family) in families.iter().enumerate() {
            self.scan((index, family), &mut seen, &mut found);
            found.extend(self.never_leaving(family));
        }
        (found, seen)
    }

    fn scan(
        &self,
        (index, family): (usize, &StartFamily),
        seen: &mut Seen,
        found: &mut Vec<Candidate>,
    ) {
        let [low, high] = family.range();
        let place =
            |look: usize| low + (high - low) * (look as f64 + 0.5) / self.scan_points as f64;
        let mut looks: Vec<Look> = (0..self.scan_points)
            .map(|look| (place(look), self.look((index, family), place(look), seen)))
            .collect();
        // Between the outermost places and the family's own ends, where its arc shrinks to nothing.
        let [before, after] = [(looks.first(), low), (looks.last(), high)].map(|(last, end)| {
            let (p, _) = last.filter(|look| look.1.is_some())?;
            let p = end + 1e-7 * (p - end);
            Some((p, self.missed(family, p, COARSE)))
        });
        looks.splice(0..0, before);
        looks.extend(after);
        let mut left = MOST_REFINEMENTS;
        for pair in looks.array_windows() {
            self.refine(family, *pair, &mut left, found);
        }
    }

    /// One extremal of the scan.
    fn look(
        &self,
        (index, family): (usize, &StartFamily),
        p: f64,
        seen: &mut Seen,
    ) -> Option<Miss> {
        let fates = &mut seen.fates;
        fates.sent += 1;
        let Some((quarter, final_y)) = self.shoot(family, p, COARSE) else {
            fates.wrong_way += 1;
            return None;
        };
        match quarter.fate {
            Fate::Ended if self.ended(&quarter) => {
                fates.ended += 1;
                let miss = Miss::of(&quarter, final_y, self.sign);
                let nearest = fates.nearest.unwrap_or(f64::INFINITY);
                fates.nearest = Some(nearest.min(miss.lambda4.abs()));
                seen.ended.push((index, p, self.sign * quarter.end[2]));
                return Some(miss);
            }
            Fate::Ended => fates.ended += 1,
            Fate::CameBack => fates.came_back += 1,
            Fate::LeftHorizon => fates.left_horizon += 1,
            Fate::Stalled | Fate::TooManyArcs => fates.lost += 1,
        }
        None
    }

    /// Roots between two places: where other arcs follow, or the extremal of one does not end, looks closer. At most
    /// `left` times.
    fn refine(
        &self,
        family: &StartFamily,
        [a, b]: [Look; 2],
        left: &mut usize,
        found: &mut Vec<Candidate>,
    ) {
        let mut open = vec![(a, b, HALVINGS)];
        while let Some((a, b, halvings)) = open.pop() {
            let mut ends = [a.1, b.1].into_iter().flatten();
            if !ends.any(|miss| miss.heads) {
                continue;
            }
            match (a.1, b.1) {
                (Some(from), Some(to)) if from.arcs == to.arcs || halvings == 0 || *left == 0 => {
                    let root = self.root(family, [(a.0, from.lambda4), (b.0, to.lambda4)]);
                    found.extend(root.and_then(|p| self.candidate(family, p)));
                }
                _ if halvings == 0 || *left == 0 => {}
                _ => {
                    *left -= 1;
                    let p = 0.5 * (a.0 + b.0);
                    let middle = (p, self.missed(family, p, COARSE));
                    open.push((middle, b, halvings - 1));
                    open.push((a, middle, halvings - 1));
                }
            }
        }
    }

    /// The root of `λ₄(t_f)` between two places of the coarse scan: near it at the coarse tolerance, which the bracket holds for,
    /// then secants at the fine one. None where it does not change its sign, and at a jump.
    fn root(&self, family: &StartFamily, ends: [(f64, f64); 2]) -> Option<f64> {
        let changes = ends[0].1.signum() * ends[1].1.signum() < 0.0;
        let coarse = |p| self.miss(family, p, COARSE);
        let near = changes.then(|| root(ends, NEAR, coarse)).flatten()?;
        self.polished(family, near)
    }

    /// From a place near a root to the root: secants at a middling tolerance, then a few steps at the fine one with the slope
    /// found there, since the fine shots are what costs. None where the secants lead away.
    pub(super) fn polished(&self, family: &StartFamily, near: f64) -> Option<f64> {
        let (p, slope) = self.secants(family, near)?;
        let mut here = (p, self.miss(family, p, FINE)?);
        for _ in 0..6 {
            if here.1.abs() < 1e-14 {
                return Some(here.0);
            }
            let next = here.0 - here.1 / slope;
            let lambda4 = self.miss(family, next, FINE)?;
            if lambda4.abs() > 0.5 * here.1.abs() {
                break; // rounding, or a slope that does not hold
            }
            here = (next, lambda4);
        }
        (here.1.abs() < 1e-10).then_some(here.0)
    }

    /// Secant method at the middling tolerance: a place with a small `λ₄(t_f)` and the slope there.
    fn secants(&self, family: &StartFamily, near: f64) -> Option<(f64, f64)> {
        let mut before = (near, self.miss(family, near, MIDDLING)?);
        // Away from the family's end, which may be nearer.
        let [low, high] = family.range();
        let aside = if near < 0.5 * (low + high) {
            1e-5
        } else {
            -1e-5
        };
        let mut here = near + aside;
        for _ in 0..12 {
            let lambda4 = self.miss(family, here, MIDDLING)?;
            let slope = (lambda4 - before.1) / (here - before.0);
            let next = here - lambda4 / slope;
            if !next.is_finite() || (next - near).abs() > 0.05 {
                return None;
            }
            if lambda4.abs() < 1e-6 {
                return Some((next, slope));
            }
            before = (here, lambda4);
            here = next;
        }
        None
    }

    /// The candidate that leaves a family at p.
    pub(super) fn candidate(&self, family: &StartFamily, p: f64) -> Option<Candidate> {
        let (quarter, final_y) = self.shoot(family, p, FINE)?;
        let whole = match family {
            StartFamily::StartLine { .. } => quarter,
            // Again from the start: the multiplier itself must fall to zero at p.
            StartFamily::Bounds { .. } | StartFamily::EndLine { .. } => {
                let start = family.start()?;
                let whole = self.whole(&start, final_y, family.begins_straight());
                let mut legs = whole.legs.iter();
                let left = legs.find(|leg| leg.motion == Motion::Singular)?;
                let place = self.place(family, p, FINE)?.state;
                ((shape(&left.from) - shape(&place)).norm() < 1e-6).then_some(whole)?
            }
        };
        self.ended(&whole).then_some(Candidate {
            quarter: whole,
            momentum: Momentum::of_quarter(self.sign, final_y),
        })
    }

    /// The extremal that runs along the bounds to the very end.
    pub(super) fn never_leaving(&self, family: &StartFamily) -> Option<Candidate> {
        if family.touched() {
            return None; // which would be no loop
        }
        let final_y = family.end()?[3];
        let quarter = self.whole(&family.start()?, final_y, false);
        let mut legs = quarter.legs.iter();
        let stayed = legs.all(|leg| leg.motion != Motion::Singular);
        let on_the_end = (quarter.end[3] - final_y).abs() < 1e-10;
        (self.ended(&quarter) && stayed && on_the_end).then(|| Candidate {
            quarter,
            momentum: Momentum::of_quarter(self.sign, final_y),
        })
    }

    /// The quarter that begins at a place.
    fn whole(&self, start: &Place, final_y: f64, touched: bool) -> Quarter {
        let flow = self.flow(final_y, start.motion);
        let options = self.options(FINE, &start.state, touched);
        follow(flow, self.region, start.state, options)
    }

    /// `λ₄(t_f)` over λ₃ of the extremal that leaves a family at p, where that extremal ends.
    fn miss(&self, family: &StartFamily, p: f64, control: StepControl) -> Option<f64> {
        Some(self.missed(family, p, control)?.lambda4)
    }

    /// The same, with the arcs.
    fn missed(&self, family: &StartFamily, p: f64, control: StepControl) -> Option<Miss> {
        let (quarter, final_y) = self.shoot(family, p, control)?;
        self.ended(&quarter)
            .then(|| Miss::of(&quarter, final_y, self.sign))
    }

    /// The quarter that becomes singular at place p of a family, with its `y_f`. None where the singular control would leave
    /// the region, or no `y_f` makes the height vanish.
    fn shoot(&self, family: &StartFamily, p: f64, control: StepControl) -> Option<(Quarter, f64)> {
        let place = self.place(family, p, control)?;
        let final_y = family.final_y(self.model, &place, p)?;
        let Place { state, motion } = place;
        let phi = shape(&state);
        let singular = self.flow(final_y, Motion::Singular);
        let direction = singular.direction(&state);
        let inwards = match motion {
            Motion::Singular => direction.y - direction.x,
            Motion::Along(track) => track.inwards(&phi).dot(&direction),
        };
        let began = family.start().map_or(state, |start| start.state);
        let options = self.options(control, &began, family.touched());
        (inwards > 0.0).then(|| (follow(singular, self.region, state, options), final_y))
    }

    /// From a state of a quarter that began in another.
    fn options(&self, control: StepControl, began: &State, touched: bool) -> TraceOptions {
        TraceOptions {
            control,
            leaves: true,
            touch: self.touch,
            touched,
            began: began[0] + began[1],
        }
    }

    fn ended(&self, quarter: &Quarter) -> bool {
        let touches = self.touch != Touch::Ends;
        quarter.fate == Fate::Ended && quarter.touched == touches && !quarter.ends_in_a_spike()
    }

    /// A place, one step of tolerance closer than what is followed from there.
    fn place(&self, family: &StartFamily, p: f64, control: StepControl) -> Option<Place> {
        let coarse = control.tolerance > MIDDLING.tolerance;
        let flow = self.flow(0.0, Motion::Singular);
        family.place(flow, p, if coarse { MIDDLING } else { FINE })
    }

    /// An arc of an extremal with this `y_f`.
    pub(super) fn flow(&self, final_y: f64, motion: Motion) -> Flow<'a> {
        Flow {
            model: self.model,
            momentum: Momentum::of_quarter(self.sign, final_y),
            motion,
        }
    }
}

impl Miss {
    fn of(quarter: &Quarter, final_y: f64, sign: f64) -> Self {
        let arcs = lasting(&quarter.legs).fold(0, |arcs: u64, leg| {
            let arc = match leg.motion {
                Motion::Singular => 1,
                Motion::Along(track) => 2 + track.index as u64,
            };
            arcs.wrapping_mul(31).wrapping_add(arc)
        });
        Self {
            lambda4: quarter.end[3] - final_y,
            arcs,
            heads: sign * quarter.end[2] > 0.0,
        }
    }
}

#[cfg(test)]
mod tests;
