//! Predictor–corrector continuation of a branch: step control and location of events.

use std::ops::Range;

use super::branch_point::{BranchPoint, FIGURES, slope};
use crate::parallel::Watch;

use super::{ContinuationProblem, Event, EventKind, Fold, OtherSide, Start};

/// Smallest step, and accuracy of an event, as a share of the whole range.
const SMALLEST: f64 = 5e-7;
/// Largest number of gaits per branch beyond those of the regular steps.
const MOST_GAITS: usize = 2000;
/// Share of the first gait's gain below which a branch counts as ended.
const FADED: f64 = 1e-4;
/// Largest number of changes of the arcs in one step.
const MOST_CHANGES: usize = 8;
/// Exponents of the change with the distance to the end of the branch that indicate a fold (1/2 in theory).
const TURNS_BACK: Range<f64> = 0.42..0.6;
/// Distances over which the exponent is fitted, as shares of the whole range.
const POWER_OVER: Range<f64> = 1e-5..1e-2;
/// Largest number of bisections for the end of a gap.
const MOST_HALVINGS: usize = 16;
/// Number of points before a fold at which its other extremal is searched.
const MOST_BEFORE: usize = 12;

/// Solver for the gaits of one objective.
pub(super) trait Family {
    /// `true` if a branch that ends continues with the nearest other gait.
    const JUMPS: bool;

    /// First gait.
    fn start(&self, start: &Start) -> Result<BranchPoint, String>;

    /// Gait at another value, near the last one and the one before it.
    fn next(
        &self,
        value: f64,
        here: &BranchPoint,
        before: Option<&BranchPoint>,
    ) -> Result<BranchPoint, String>;

    /// Optimum nearest to a gait that is no longer optimal, if the continuation changes to it.
    fn optimum(&self, _value: f64, _last: &BranchPoint) -> Option<BranchPoint> {
        None
    }

    /// Other extremal at the end of a branch.
    fn other_side(&self, _before: &BranchPoint, _last: &BranchPoint) -> Option<OtherSide> {
        None
    }
}

/// Branch with its events.
pub(super) struct Track {
    pub(super) kept: Vec<BranchPoint>,
    pub(super) events: Vec<Event>,
}

/// Parameter value of stop `number`, at which all branches have a point.
pub(super) fn stop(problem: &ContinuationProblem, number: usize) -> f64 {
    let share = number as f64 / problem.steps as f64;
    problem.from + share * (problem.to - problem.from)
}

/// Smallest step.
pub(super) fn smallest(problem: &ContinuationProblem) -> f64 {
    SMALLEST * (problem.to - problem.from).abs()
}

/// Failure of a step.
enum Refused {
    Another(Box<BranchPoint>),
    Nothing(String),
}

/// Candidate for the next gait, and its distance relative to the largest change per step.
type Tried = Result<(BranchPoint, f64), Refused>;

/// Follows one branch.
pub(super) fn follow<F: Family>(
    problem: &ContinuationProblem,
    family: &F,
    branch: usize,
    first: BranchPoint,
    watch: Watch<'_>,
) -> Track {
    Walk {
        problem,
        family,
        branch,
        floor: FADED * first.gain(),
        gaits: MOST_GAITS + 4 * problem.steps,
        since: 0,
        track: Track {
            kept: vec![first.clone()],
            events: Vec::new(),
        },
        here: first,
        before: None,
    }
    .run(watch)
}

struct Walk<'a, F: Family> {
    problem: &'a ContinuationProblem,
    family: &'a F,
    branch: usize,
    floor: f64,
    /// Remaining number of gaits.
    gaits: usize,
    /// Index of the first point after the last jump.
    since: usize,
    track: Track,
    here: BranchPoint,
    before: Option<BranchPoint>,
}

impl<F: Family> Walk<'_, F> {
    fn run(mut self, watch: Watch<'_>) -> Track {
        let smallest = smallest(self.problem);
        let whole = (self.problem.to - self.problem.from) / self.problem.steps as f64;
        let mut step = whole;
        for number in 1..=self.problem.steps {
            watch((number as f64 - 1.0) / self.problem.steps as f64);
            let target = stop(self.problem, number);
            // A jump may have passed the target.
            while (target - self.here.value) * whole > 0.0 {
                let left = target - self.here.value;
                let value = if step.abs() >= left.abs() * 0.999_999 {
                    target
                } else {
                    self.here.value + step
                };
                if self.gaits == 0 {
                    self.ends(
                        "more steps are needed than allowed".to_owned(),
                        value - self.here.value,
                    );
                    return self.track;
                }
                match self.tried(value) {
                    Ok((found, off)) => {
                        if !self.accepts(found) {
                            return self.track;
                        }
                        let larger = step * if off < 0.4 { 2.0 } else { 1.1 };
                        step = larger.clamp(-whole.abs(), whole.abs());
                    }
                    Err(refused) => {
                        step = 0.5 * (value - self.here.value);
                        if step.abs() >= smallest {
                            continue;
                        }
                        if !self.stops(refused, 2.0 * step) {
                            return self.track;
                        }
                        step = whole / 16.0;
                    }
                }
            }
        }
        self.event(self.here.value, 0.0, EventKind::Reached);
        self.track
    }

    fn event(&mut self, value: f64, within: f64, kind: EventKind) {
        self.track.events.push(Event {
            branch: self.branch,
            value,
            within: within.abs(),
            kind,
        });
    }

    fn tried(&mut self, value: f64) -> Tried {
        self.gaits = self.gaits.saturating_sub(1);
        match self.family.next(value, &self.here, self.before.as_ref()) {
            Ok(found) => match self.here.off(&found) {
                off if off <= 1.0 => Ok((found, off)),
                _ => Err(Refused::Another(Box::new(found))),
            },
            Err(reason) => Err(Refused::Nothing(reason)),
        }
    }

    /// Accepts a gait as the next point. Returns `false` if the branch ends there.
    fn accepts(&mut self, found: BranchPoint) -> bool {
        let mut from = self.here.clone();
        if !found.holds() {
            let (last, next) = self.parted(&from, &found, BranchPoint::holds);
            let (value, within) = between(last.value, next.value);
            let failed = next.gait.certificate.failures();
            self.event(value, within, EventKind::Lost { failed });
            return self.resumes();
        }
        let passes = |kept: &BranchPoint| kept.gait.certificate.pass();
        if passes(&from) != passes(&found) {
            let alone = passes(&from);
            let (last, next) = self.parted(&from, &found, |kept| passes(kept) == alone);
            let (value, within) = between(last.value, next.value);
            self.event(value, within, EventKind::Symmetry { alone });
        }
        for _ in 0..MOST_CHANGES {
            if from.arcs() == found.arcs() {
                break;
            }
            let before = from.arcs();
            let (last, next) = self.parted(&from, &found, |kept| kept.arcs() == before);
            self.changes(&last, &next);
            from = next;
        }
        let faded = found.gain() < self.floor;
        self.before = Some(std::mem::replace(&mut self.here, found));
        self.track.kept.push(self.here.clone());
        if faded {
            self.ends("the gait fades to nothing".to_owned(), 0.0);
        }
        !faded
    }

    /// Bisects for two neighbouring gaits, of which only the first has a property of `from`.
    fn parted(
        &mut self,
        from: &BranchPoint,
        to: &BranchPoint,
        has: impl Fn(&BranchPoint) -> bool,
    ) -> (BranchPoint, BranchPoint) {
        let (mut last, mut next) = (from.clone(), to.clone());
        while (next.value - last.value).abs() > smallest(self.problem) && self.gaits > 0 {
            self.gaits -= 1;
            let value = 0.5 * (last.value + next.value);
            let middle = self
                .family
                .next(value, &last, None)
                .or_else(|_| self.family.next(value, &next, None));
            match middle {
                Ok(middle) if last.off(&middle) <= 1.0 => {
                    if has(&middle) {
                        last = middle;
                    } else {
                        next = middle;
                    }
                }
                _ => break,
            }
        }
        (last, next)
    }

    /// Handles a failed step. Returns `true` if the branch continues with another gait.
    fn stops(&mut self, refused: Refused, step: f64) -> bool {
        let exponent = self.exponent();
        let other = self.other_side();
        let (value, within) = between(self.here.value, self.here.value + step);
        let turns = exponent.is_some_and(|power| TURNS_BACK.contains(&power));
        let folds = other.is_some() || turns;
        if folds {
            self.event(value, within, EventKind::Fold(Fold { other, exponent }));
        }
        match refused {
            Refused::Another(found) if F::JUMPS && found.gait.certificate.pass() => {
                self.lands(*found);
                true
            }
            _ if folds => self.resumes(),
            Refused::Another(_) => {
                self.ends(
                    "beyond, only gaits of other branches are found".to_owned(),
                    step,
                );
                self.resumes()
            }
            Refused::Nothing(reason) => {
                self.ends(reason, step);
                self.resumes()
            }
        }
    }

    /// Continues from a gait beyond the largest change per step.
    fn lands(&mut self, found: BranchPoint) {
        let (apart, exponent) = (self.here.apart(&found), self.exponent());
        let (value, within) = between(self.here.value, found.value);
        self.event(value, within, EventKind::Jump { apart, exponent });
        let last = self.here.clone();
        if last.arcs() != found.arcs() {
            self.changes(&last, &found);
        }
        self.since = self.track.kept.len();
        self.track.kept.push(found.clone());
        self.here = found;
        self.before = None;
    }

    /// Continues with the nearest optimum at the next stop that has one. Returns `false` without such an optimum, or if the
    /// family does not jump.
    fn resumes(&mut self) -> bool {
        if !F::JUMPS {
            return false;
        }
        let along = self.problem.to - self.problem.from;
        for number in 1..=self.problem.steps {
            let value = stop(self.problem, number);
            if (value - self.here.value) * along <= 0.0 {
                continue;
            }
            if let Some(found) = self.family.optimum(value, &self.here) {
                let nearest = self.nearest(found);
                self.lands(nearest);
                return true;
            }
        }
        false
    }

    /// Nearest end of a gap without an optimum.
    fn nearest(&self, found: BranchPoint) -> BranchPoint {
        let (mut none, mut nearest) = (self.here.value, found);
        for _ in 0..MOST_HALVINGS {
            if (nearest.value - none).abs() <= smallest(self.problem) {
                break;
            }
            let value = 0.5 * (none + nearest.value);
            match self.family.optimum(value, &self.here) {
                Some(found) => nearest = found,
                None => none = value,
            }
        }
        nearest
    }

    /// Records a change of the arcs.
    fn changes(&mut self, last: &BranchPoint, next: &BranchPoint) {
        let (value, within) = between(last.value, next.value);
        let kind = EventKind::Structure {
            before: last.arcs(),
            after: next.arcs(),
        };
        self.event(value, within, kind);
    }

    /// Other extremal of a fold, searched far enough from the fold to be distinguished from the optimum.
    fn other_side(&self) -> Option<OtherSide> {
        let points = self.track.kept.get(self.since..).unwrap_or_default();
        let mut nearest = None;
        for before in points.iter().rev().skip(1).take(MOST_BEFORE) {
            if let Some(other) = self.family.other_side(before, &self.here) {
                if other.ascent_directions.is_some_and(|count| count > 0) {
                    return Some(other);
                }
                nearest = nearest.or(Some(other));
            }
        }
        nearest
    }

    fn ends(&mut self, reason: String, step: f64) {
        let exponent = self.exponent();
        let (value, within) = between(self.here.value, self.here.value + step);
        self.event(value, within, EventKind::Ended { reason, exponent });
    }

    /// Exponent of the gait's change with the distance to the last point, over points with the same arcs.
    fn exponent(&self) -> Option<f64> {
        let way = (self.problem.to - self.problem.from).abs();
        let points = self.track.kept.get(self.since..).unwrap_or_default();
        let near: Vec<_> = points
            .iter()
            .filter(|kept| kept.arcs() == self.here.arcs())
            .map(|kept| ((kept.value - self.here.value).abs(), kept.figures()))
            .filter(|(distance, _)| POWER_OVER.contains(&(distance / way)))
            .collect();
        let last = self.here.figures();
        let powers = (0..FIGURES).filter_map(|figure| {
            let value = |figures: &[f64; FIGURES]| figures.get(figure).copied();
            let last = value(&last)?;
            let change = |figures| Some((value(figures)? - last).abs().ln());
            let logs: Option<Vec<_>> = near
                .iter()
                .map(|(distance, figures)| Some([distance.ln(), change(figures)?]))
                .collect();
            slope(&logs?)
        });
        // A figure that the fold does not affect to first order changes linearly.
        powers.min_by(f64::total_cmp)
    }
}

fn between(last: f64, next: f64) -> (f64, f64) {
    (0.5 * (last + next), 0.5 * (next - last).abs())
}
