//! The search for the start: every extremal leaves the same one-parameter family, and is kept where λ₄ ends at zero.
//!
//! A singular arc can begin in two places: on φ₁ = φ₂ at some angle, or at the end of an arc that ran along a bound from the
//! corner where that bound meets φ₁ = φ₂. Such a line of places is a [`StartFamily`]. At each place the height vanishes for just
//! one `y_f`, so the place fixes the whole extremal, and a scan over the family with a scalar root search on
//! `λ₄(t_f) = 0` finds every quarter gait without a guess. One more candidate never leaves the bound at all.

mod shot;

use swimmer_model::Model;

use super::ExtremalOutcomes;
use super::flow::{FINE, Quarter, Touch, nonempty_legs};
use super::start_family::StartFamily;
use crate::arcs::{SMOOTH, sampled};
use crate::cycle::Cycle;
use crate::momentum::{Flow, Momentum, Motion};
use crate::numerics::root;
use crate::parallel::Watch;
use crate::region::Region;
use crate::runge_kutta::StepControl;
use shot::{Miss, Shot};

/// An extremal that meets all end conditions.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) quarter: Quarter,
    pub(crate) momentum: Momentum,
}

impl Candidate {
    /// The cycle in `4 samples` samples at equal steps of power length. Returns `None` if it cannot be traced.
    pub(crate) fn cycle(&self, model: &Model<f64>, samples: usize) -> Option<Cycle> {
        let legs = || nonempty_legs(&self.quarter.legs);
        let mut start = legs().next()?.from;
        start[5] = 0.0;
        let route: Vec<_> = legs()
            .map(|leg| (leg.motion, leg.to[5] - leg.from[5]))
            .collect();
        let how = (&[] as &[f64], samples);
        let (samples, [first, last]) = sampled((model, self.momentum), start, &route, how, false)?;
        // Square to φ₁ = φ₂ (φ₁ = −φ₂) is a direction without a part along it.
        let square = [first.x + first.y, last.x - last.y].map(|along| along.abs() < SMOOTH);
        Some(samples.unfolded(square))
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
}

/// Quarters that leave a family and do the same where they first meet φ₁ = −φ₂: one parameter.
#[derive(Debug, Clone, Copy)]
pub(crate) struct QuarterBranch<'a> {
    pub(crate) family: &'a StartFamily,
    pub(crate) touch: Touch,
}

/// Behaviours of quarters at their first contact with φ₁ = −φ₂. Up to there they are the same.
const TOUCHES: [Touch; 3] = [Touch::Ends, Touch::GoesInwards, Touch::GoesOutwards];

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
pub(super) const MIDDLING: StepControl = StepControl {
    tolerance: 1e-9,
    longest: 0.5,
};
/// Halvings of an interval at whose ends different arcs follow each other, or of which only one end has an extremal that ends.
const HALVINGS: usize = 10;
/// Most extremals that these cost on a line: where other arcs follow from place to place, that is rounding.
const MOST_REFINEMENTS: usize = 2 * SCAN_POINTS;

/// A place looked at, and the extremals from there where they end, one for each of [`TOUCHES`].
type ScanPoint = (f64, [Option<Miss>; 3]);

impl<'a> Search<'a> {
    /// All candidates, in the order of the families, and the fates of the scan, which probes a number of places of each family. `watch` receives
    /// the share of the families that have been scanned.
    pub(crate) fn candidates(
        &self,
        families: &[StartFamily],
        places: usize,
        watch: Watch<'_>,
    ) -> (Vec<Candidate>, ExtremalOutcomes) {
        let mut outcomes = ExtremalOutcomes::default();
        let mut found = Vec::new();
        for (number, family) in (1..).zip(families) {
            self.scan(family, places, &mut outcomes, &mut found);
            found.extend(self.never_leaving(family));
            watch(f64::from(number) / families.len() as f64);
        }
        (found, outcomes)
    }

    fn scan(
        &self,
        family: &StartFamily,
        places: usize,
        outcomes: &mut ExtremalOutcomes,
        found: &mut Vec<Candidate>,
    ) {
        let [low, high] = family.range();
        let place =
            |extremals_at: usize| low + (high - low) * (extremals_at as f64 + 0.5) / places as f64;
        let mut looks: Vec<ScanPoint> = (0..places)
            .map(|extremals_at| {
                (
                    place(extremals_at),
                    self.extremals_at(family, place(extremals_at), outcomes),
                )
            })
            .collect();
        // Between the outermost places and the family's own ends, where its arc shrinks to nothing.
        let [before, after] = [(looks.first(), low), (looks.last(), high)].map(|(last, end)| {
            let (p, misses) =
                last.filter(|extremals_at| extremals_at.1.iter().any(Option::is_some))?;
            let p = end + 1e-7 * (p - end);
            Some((p, self.misses(family, p, misses.map(|miss| miss.is_some()))))
        });
        looks.splice(0..0, before);
        looks.extend(after);
        let mut left = [MOST_REFINEMENTS; 3];
        for pair in looks.array_windows() {
            self.refine(family, *pair, &mut left, found);
        }
    }

    /// The extremals of the scan at one place.
    fn extremals_at(
        &self,
        family: &StartFamily,
        p: f64,
        outcomes: &mut ExtremalOutcomes,
    ) -> [Option<Miss>; 3] {
        let shot = self.shoot(family, p, COARSE);
        if family.may(Touch::Ends) {
            outcomes.count(shot.as_ref());
        }
        self.misses_of(shot.as_ref(), family, [true; 3])
    }

    /// Roots between two places: where other arcs follow, or the extremal of one does not end, looks closer. At most `left` times on
    /// each line.
    fn refine(
        &self,
        family: &StartFamily,
        [a, b]: [ScanPoint; 2],
        left: &mut [usize; 3],
        found: &mut Vec<Candidate>,
    ) {
        let mut open = vec![(a, b, HALVINGS, [true; 3])];
        while let Some((a, b, halvings, lines)) = open.pop() {
            let mut closer = [false; 3];
            for touch in TOUCHES {
                let line = touch as usize;
                let ends = [a.1[line], b.1[line]];
                if !lines[line] || !ends.iter().flatten().any(|miss| miss.carried > 0.0) {
                    continue;
                }
                let last = halvings == 0 || left[line] == 0;
                match ends {
                    [Some(from), Some(to)] if from.arcs == to.arcs || last => {
                        let line = QuarterBranch { family, touch };
                        found.extend(self.between(line, [(a.0, from.lambda4), (b.0, to.lambda4)]));
                    }
                    _ if last => {}
                    _ => {
                        left[line] -= 1;
                        closer[line] = true;
                    }
                }
            }
            if closer.contains(&true) {
                let p = 0.5 * (a.0 + b.0);
                let middle = (p, self.misses(family, p, closer));
                open.push((middle, b, halvings - 1, closer));
                open.push((a, middle, halvings - 1, closer));
            }
        }
    }

    /// The candidate between two places of the coarse scan, with `λ₄(t_f) = 0`: first at the coarse tolerance, for which the
    /// bracket is valid, then by secants at the fine one. Returns `None` without a change of sign, and at a jump.
    fn between(&self, line: QuarterBranch<'_>, ends: [(f64, f64); 2]) -> Option<Candidate> {
        let changes = ends[0].1.signum() * ends[1].1.signum() < 0.0;
        let coarse = |p| Some(self.miss(line, p, COARSE)?.lambda4);
        let near = changes.then(|| root(ends, NEAR, coarse)).flatten()?;
        self.near(line, near)
    }

    /// The candidate near a place: secants at an intermediate tolerance, then a few steps at the fine one with the same slope,
    /// since the fine shots dominate the cost. Returns `None` if the secants diverge.
    pub(super) fn near(&self, line: QuarterBranch<'_>, near: f64) -> Option<Candidate> {
        let (mut p, slope) = self.secants(line, near)?;
        let lambda4 = |shot: &Shot<'_>| Some(self.miss_of(shot, line)?.lambda4);
        let mut shot = self.shoot(line.family, p, FINE)?;
        let mut here = lambda4(&shot)?;
        for _ in 0..6 {
            if here.abs() < 1e-14 {
                break;
            }
            let next = p - here / slope;
            let closer = self.shoot(line.family, next, FINE)?;
            let there = lambda4(&closer)?;
            if there.abs() > 0.5 * here.abs() {
                break; // rounding, or a slope that does not hold
            }
            (p, shot, here) = (next, closer, there);
        }
        let solved = here.abs() < 1e-10;
        solved.then(|| self.begun(line, p, &shot)).flatten()
    }

    /// Secant method at the middling tolerance: a place with a small `λ₄(t_f)` and the slope there.
    fn secants(&self, line: QuarterBranch<'_>, near: f64) -> Option<(f64, f64)> {
        let mut before = (near, self.miss(line, near, MIDDLING)?.lambda4);
        // Away from the family's end, which may be nearer.
        let [low, high] = line.family.range();
        let aside = if near < 0.5 * (low + high) {
            1e-5
        } else {
            -1e-5
        };
        let mut here = near + aside;
        for _ in 0..12 {
            let lambda4 = self.miss(line, here, MIDDLING)?.lambda4;
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

    /// The extremal that runs along the bounds to the very end.
    pub(super) fn never_leaving(&self, family: &StartFamily) -> Option<Candidate> {
        let touch = Touch::Ends;
        if !family.may(touch) {
            return None; // which would be no loop
        }
        let final_y = family.end()?[3];
        let quarter = self.whole(QuarterBranch { family, touch }, final_y)?;
        let mut legs = quarter.legs.iter();
        let stayed = legs.all(|leg| leg.motion != Motion::Singular);
        let on_the_end = (quarter.end[3] - final_y).abs() < 1e-10;
        let momentum = Momentum::of_quarter(self.sign, final_y);
        (stayed && on_the_end).then_some(Candidate { quarter, momentum })
    }

    /// The extremal that leaves a family at p. Returns `None` if it does not end.
    pub(super) fn miss(
        &self,
        line: QuarterBranch<'_>,
        p: f64,
        control: StepControl,
    ) -> Option<Miss> {
        self.miss_of(&self.shoot(line.family, p, control)?, line)
    }

    /// Those on some lines of a family, from the coarse scan.
    fn misses(&self, family: &StartFamily, p: f64, which: [bool; 3]) -> [Option<Miss>; 3] {
        self.misses_of(self.shoot(family, p, COARSE).as_ref(), family, which)
    }

    fn misses_of(
        &self,
        shot: Option<&Shot<'_>>,
        family: &StartFamily,
        which: [bool; 3],
    ) -> [Option<Miss>; 3] {
        TOUCHES.map(|touch| {
            let asked = which[touch as usize] && family.may(touch);
            self.miss_of(shot.filter(|_| asked)?, QuarterBranch { family, touch })
        })
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

#[cfg(test)]
mod tests;
