//! From a polygon to the fastest curve nearby, to rounding, whatever limits its servos.
//!
//! The cycle is cut into phases, on each of which the same limits bind: one, and the direction is free; two, or one along a bound
//! of the angles, and it is not. A phase is a few polynomials on which its limits hold at Gauss nodes; with what binds known, Newton's
//! method finds all of them and when each phase ends. Multipliers below zero and limits that are overstepped then tell, node by
//! node, what should bind instead.

mod binding;
mod draft;
mod equations;
mod newton;

use nalgebra::Vector2;

use self::draft::Draft;
use self::newton::Outcome;
use super::chain::Net;
use super::interior::Polygon;
use super::setting::Setting;

/// Coefficients of each joint's angle on an element.
const BENDS: usize = 8;
/// Of them, those that are read off a polygon.
const FITTED: usize = 3;
/// Times that what binds is mended.
const MENDS: usize = 24;
/// Multipliers below this share push on a side of a polygon; corners this close to a bound rest on it.
const PUSHES: f64 = 1e-2;
const RESTS: f64 = 2e-3;
/// Phases of a smaller share of the period are left out.
const SHORTEST: f64 = 1e-5;
/// Share of the period of a phase along a bound that is put in where a corner rests on it.
const PUT_IN: f64 = 4e-3;
/// Times that a phase which loses its length is begun again with more.
const LENGTHENED: usize = 2;
/// Limits may be missed by this share of them between their nodes; with finer elements the error falls by about this power.
const OFF: f64 = 1e-9;
const ORDER: f64 = 7.0;
/// Parts that an element is cut into at most.
const MOST_PARTS: usize = 4;

/// A part of the cycle on which the same limits bind, from one share of the period to another.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Phase {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// By their place in [`Setting::limits`].
    pub(crate) limits: Vec<usize>,
    /// Two limits may leave two velocities, one each side of where they touch: which; of one limit nothing.
    side: i8,
    /// The bound that it runs along, by its place in the region.
    pub(crate) bound: Option<usize>,
    /// Bounds that its first corner rests on.
    pub(crate) touches: Vec<usize>,
    /// Elements that it is cut into at least.
    parts: usize,
}

impl Phase {
    fn binds_as(&self, other: &Self) -> bool {
        (&self.limits, self.side, self.bound) == (&other.limits, other.side, other.bound)
    }
}

/// On which side of where two limits touch a velocity lies.
fn side(setting: &Setting, limits: &[usize], phi: &Vector2<f64>, rate: &Vector2<f64>) -> i8 {
    let &[one, two] = limits else {
        return 0;
    };
    let (all, second) = (setting.limits(), setting.model.second_derivatives(phi));
    let slope = |limit: usize| {
        let slope = all[limit].level(&second, rate).slope;
        Vector2::new(slope[2], slope[3])
    };
    if slope(one).perp(&slope(two)) > 0.0 {
        1
    } else {
        -1
    }
}

/// A curve that meets all conditions of its phases.
#[derive(Debug, Clone)]
pub(crate) struct Curve {
    draft: Draft,
    pub(crate) net: Net,
    pub(crate) speed: f64,
}

impl Curve {
    pub(crate) fn period(&self) -> f64 {
        self.draft.period()
    }

    pub(crate) fn phases(&self) -> &[Phase] {
        &self.draft.phases
    }

    /// The shape at a share of the period, modulo 1.
    pub(crate) fn at(&self, share: f64) -> Vector2<f64> {
        self.draft.at(share)
    }

    /// Each element's phase and where in the period it ends.
    pub(crate) fn elements(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let Draft { layout, z, .. } = &self.draft;
        let ends = (0..layout.arcs()).scan(0.0, |until, element| {
            *until += z[layout.time_index(element)] / self.period();
            Some(*until)
        });
        self.draft.phase_of.iter().copied().zip(ends)
    }

    /// The same on about so many elements, and on more where they miss their limits.
    pub(crate) fn refined(&self, setting: &Setting, elements: usize) -> Option<Self> {
        let mut phases = self.phases().to_vec();
        for (number, phase) in phases.iter_mut().enumerate() {
            let own = self.draft.elements_of(number).count();
            let off = self.draft.off_limits(setting, number);
            let enough = |times: &usize| off < OFF * (*times as f64).powf(ORDER);
            phase.parts = own * (1..MOST_PARTS).find(enough).unwrap_or(MOST_PARTS);
        }
        let draft = self.draft.cut(setting, (&phases, 0.0), elements);
        mended(setting, phases, draft, elements)
    }
}

/// The fastest curve near a polygon, on about so many elements; none where there is none.
pub(crate) fn polished(setting: &Setting, polygon: &Polygon, elements: usize) -> Option<Curve> {
    let (phases, offset) = begun(with_touches(&of_polygon(setting, polygon)))?;
    let curve = |share: f64| polygon.at(share + offset);
    let draft = Draft::new(
        setting,
        (&curve, polygon.period()),
        &phases,
        elements,
        FITTED,
    );
    mended(setting, phases, draft, elements)
}

/// Newton's method until what binds is what should; none where it is not found.
fn mended(
    setting: &Setting,
    mut phases: Vec<Phase>,
    mut draft: Draft,
    elements: usize,
) -> Option<Curve> {
    // Where a phase lost its length first, and how often one has been lengthened since; none is before anything was solved.
    let mut lost: Option<(Draft, usize)> = None;
    let mut lengthened = LENGTHENED;
    // What was solved and should bind otherwise: to come back to it is to go round.
    let mut solved: Vec<Vec<Phase>> = Vec::new();
    for _ in 0..MENDS {
        let before = draft.clone();
        let outcome = newton::solve(setting, draft);
        match outcome {
            Outcome::Lost if lost.is_none() => return None,
            Outcome::Gone(phase, _) if lengthened < LENGTHENED && !jumps(&before, phase) => {
                lengthen(&mut phases, phase);
                lengthened += 1;
                draft = before.cut(setting, (&phases, 0.0), elements);
                lost = lost.or(Some((before, phase)));
            }
            Outcome::Lost | Outcome::Gone(..) => {
                // Where the velocity jumps in its place, the method has found that; else it may have gone astray.
                let (from, phase) = match (lost.take(), outcome) {
                    (None, Outcome::Gone(phase, after)) if jumps(&before, phase) => (*after, phase),
                    (Some(first), _) => first,
                    (None, Outcome::Gone(phase, _)) => (before, phase),
                    (None, _) => return None,
                };
                let (merged, offset) = from.without(phase)?;
                phases = merged;
                draft = from.cut(setting, (&phases, offset), elements);
            }
            Outcome::Solved(curve, wanted) => {
                (lost, lengthened) = (None, 0);
                let (next, offset) = begun(wanted)?;
                if alike(&next, curve.phases()) {
                    return Some(*curve);
                }
                if solved.iter().any(|before| alike(&next, before)) {
                    return None;
                }
                solved.push(curve.phases().to_vec());
                draft = curve.draft.cut(setting, (&next, offset), elements);
                phases = next;
            }
        }
    }
    None
}

/// Whether the same binds in the same order.
fn alike(phases: &[Phase], others: &[Phase]) -> bool {
    let same = |(one, other): (&Phase, &Phase)| one.binds_as(other) && one.touches == other.touches;
    phases.len() == others.len() && phases.iter().zip(others).all(same)
}

/// Whether the velocity jumps between the neighbours of a phase, which bind alike.
fn jumps(draft: &Draft, phase: usize) -> bool {
    let count = draft.phases.len();
    let [one, two] = [phase + count - 1, phase + 1].map(|at| &draft.phases[at % count]);
    one.limits == two.limits && one.side != two.side
}

/// Gives a phase its own length from each of its neighbours, as far as they have it.
fn lengthen(phases: &mut [Phase], phase: usize) {
    let length = phases[phase].to - phases[phase].from;
    if let Some(before) = phase.checked_sub(1) {
        let more = length.min(0.4 * (phases[before].to - phases[before].from));
        phases[before].to -= more;
        phases[phase].from -= more;
    }
    if phase + 1 < phases.len() {
        let more = length.min(0.4 * (phases[phase + 1].to - phases[phase + 1].from));
        phases[phase + 1].from += more;
        phases[phase].to += more;
    }
}

/// One phase a side of a polygon: what pushes against it.
fn of_polygon(setting: &Setting, polygon: &Polygon) -> Vec<Phase> {
    let Polygon { layout, z, .. } = polygon;
    let period = layout.period(z);
    let rests = |corner: usize| -> Vec<usize> {
        let phi = layout.corner(z, corner);
        let bounds = setting.region.bounds().enumerate();
        let near = bounds.filter(|(_, bound)| bound.margin(&phi) < RESTS);
        near.map(|(index, _)| index).collect()
    };
    let mut until = 0.0;
    (0..layout.arcs())
        .map(|k| {
            let (before, after) = (rests(k), rests(k + 1));
            let bound = before.iter().copied().find(|bound| after.contains(bound));
            let mut pushes: Vec<(usize, f64)> = (0..)
                .zip(polygon.pushes[k].iter().map(|push| push * period))
                .collect();
            pushes.sort_by(|(_, a), (_, b)| b.total_cmp(a));
            let most = if bound.is_some() { 1 } else { 2 };
            let share = pushes.first().map_or(0.0, |(_, push)| PUSHES * push);
            let mut limits: Vec<usize> = pushes
                .iter()
                .take(most)
                .filter(|(_, push)| *push >= share)
                .map(|(limit, _)| *limit)
                .collect();
            limits.sort_unstable();
            let [start, end] = layout.ends(z, k);
            let side = side(setting, &limits, &(0.5 * (start + end)), &(end - start));
            let from = until;
            until += z[layout.time_index(k)] / period;
            Phase {
                from,
                to: until,
                limits,
                side,
                bound,
                touches: before,
                parts: 1,
            }
        })
        .collect()
}

/// Phases joined where the same limits bind, from one of their borders on; with the share of the period where that lies.
fn begun(mut phases: Vec<Phase>) -> Option<(Vec<Phase>, f64)> {
    phases.retain(|phase| phase.to - phase.from > SHORTEST);
    let count = phases.len();
    let joins = |phase: &Phase, before: &Phase| {
        phase.binds_as(before)
            && phase
                .touches
                .iter()
                .all(|bound| phase.bound == Some(*bound))
    };
    let first = (0..count).find(|&k| !joins(&phases[k], &phases[(k + count - 1) % count]))?;
    let offset = phases[first].from;
    let mut merged: Vec<Phase> = Vec::new();
    let mut until = 0.0;
    for k in (0..count).map(|k| (first + k) % count) {
        let mut phase = phases[k].clone();
        let length = phase.to - phase.from;
        match merged.last_mut() {
            Some(last) if joins(&phase, last) => last.to += length,
            _ => {
                phase.from = until;
                phase.to = until + length;
                phase.touches.retain(|bound| phase.bound != Some(*bound));
                merged.push(phase);
            }
        }
        until += length;
    }
    // What was left out is shared by the rest.
    for phase in &mut merged {
        phase.from /= until;
        phase.to /= until;
    }
    for k in 0..merged.len() {
        let before = merged[(k + merged.len() - 1) % merged.len()].bound;
        merged[k].touches.retain(|bound| before != Some(*bound));
    }
    (merged.len() > 1).then_some((merged, offset))
}

/// Where a corner rests on a bound along which no side runs, one that does.
fn with_touches(sides: &[Phase]) -> Vec<Phase> {
    let Some((phases, offset)) = begun(sides.to_vec()) else {
        return sides.to_vec();
    };
    let mut all: Vec<Phase> = Vec::new();
    let count = phases.len();
    for (k, phase) in phases.iter().enumerate() {
        let before = &phases[(k + count - 1) % count];
        let mut phase = phase.clone();
        if let Some(&bound) = phase.touches.first() {
            let common = phase.limits.iter().copied();
            let pace = common
                .filter(|limit| before.limits.contains(limit))
                .chain(phase.limits.iter().copied())
                .next();
            let width = PUT_IN.min(0.3 * (phase.to - phase.from));
            all.push(Phase {
                to: phase.from + width,
                limits: pace.into_iter().collect(),
                side: 0,
                bound: Some(bound),
                touches: Vec::new(),
                ..phase.clone()
            });
            phase.from += width;
            phase.touches.clear();
        }
        all.push(phase);
    }
    for phase in &mut all {
        phase.from += offset;
        phase.to += offset;
    }
    all
}
