//! From a polygon to the fastest curve nearby, to rounding, whatever limits its servos.
//!
//! The cycle is cut into phases, on each of which the same limits bind: one, and the direction is free; two, or one along a bound
//! of the angles, and it is not. A phase is a few polynomials on which its limits hold at Gauss nodes; with what binds known, Newton's
//! method finds all of them and when each phase ends. Multipliers below zero and limits that are overstepped then tell, node by
//! node, what should bind instead.

mod binding;
mod equations;
mod newton;

use nalgebra::{DVector, Vector2};

use self::newton::Outcome;
use super::arc::Shape;
use super::certificate::least_squares;
use super::chain::{Layout, Net};
use super::interior::Polygon;
use super::problem::Setting;
use super::quadrature::{cut, legendre};

/// Coefficients of each joint's angle on an element.
const BENDS: usize = 8;
/// Of them, those that are read off a polygon.
const FITTED: usize = 3;
/// Times that what binds is mended.
const MENDS: usize = 24;
/// Multipliers below this share push on a side of a polygon; corners this close to a bound rest on it.
const PUSHES: f64 = 1e-2;
const RESTS: f64 = 2e-3;
/// A turn of the direction by 1 rad counts as much as this share of the period; it is looked at over so short a share.
const TURNS: f64 = 1.0 / 8.0;
const STEP: f64 = 1e-5;
/// A phase of one limit is cut into this part of all elements at least.
const FREE: usize = 8;
/// Phases of a smaller share of the period are left out.
const SHORTEST: f64 = 1e-5;
/// Share of the period of a phase along a bound that is put in where a corner rests on it.
const PUT_IN: f64 = 4e-3;

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
        self.draft.layout.period(&self.draft.z)
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

    /// The same on about so many elements, with what binds between those of before.
    pub(crate) fn refined(&self, setting: &Setting, elements: usize) -> Option<Self> {
        let phases = self.phases().to_vec();
        let curve = |share: f64| self.at(share);
        let draft = Draft::new((&curve, self.period()), &phases, elements, BENDS);
        mended(setting, phases, draft, elements)
    }
}

/// The fastest curve near a polygon, on about so many elements; none where there is none.
pub(crate) fn polished(setting: &Setting, polygon: &Polygon, elements: usize) -> Option<Curve> {
    let place = |share: f64| along(polygon, share);
    let (phases, offset) = begun(with_touches(&of_polygon(setting, polygon)))?;
    let curve = |share: f64| place(share + offset);
    let draft = Draft::new((&curve, polygon.period()), &phases, elements, FITTED);
    mended(setting, phases, draft, elements)
}

/// Newton's method until what binds is what should; none where it is not found.
fn mended(
    setting: &Setting,
    mut phases: Vec<Phase>,
    mut draft: Draft,
    elements: usize,
) -> Option<Curve> {
    let mut best = None;
    for _ in 0..MENDS {
        let before = draft.clone();
        match newton::solve(setting, draft) {
            Outcome::Lost => return None,
            Outcome::Gone(phase, after) => {
                let count = after.phases.len();
                let [one, two] = [phase + count - 1, phase + 1].map(|at| &after.phases[at % count]);
                // Where the velocity jumps in its place, the method has found that; else it may have gone astray.
                let jumps = one.limits == two.limits && one.side != two.side;
                let before = if jumps { *after } else { before };
                phases.clone_from(&before.phases);
                let gone = phases.remove(phase);
                let count = phases.len();
                if count < 2 {
                    return best;
                }
                match phases.get_mut(phase) {
                    Some(next) => next.from = gone.from,
                    None => phases[count - 1].to = gone.to,
                }
                let next = &mut phases[phase % count].touches;
                next.extend(gone.touches.into_iter().chain(gone.bound));
                next.sort_unstable();
                next.dedup();
                let (merged, offset) = begun(phases)?;
                phases = merged;
                let period = before.layout.period(&before.z);
                let curve = |share: f64| before.at(share + offset);
                draft = Draft::new((&curve, period), &phases, elements, BENDS);
            }
            Outcome::Solved(curve, wanted) => {
                let (next, offset) = begun(wanted)?;
                let same = next.len() == curve.phases().len()
                    && next
                        .iter()
                        .zip(curve.phases())
                        .all(|(one, other)| one.binds_as(other) && one.touches == other.touches);
                if same {
                    return Some(*curve);
                }
                draft = Draft::new(
                    (&|share| curve.at(share + offset), curve.period()),
                    &next,
                    elements,
                    BENDS,
                );
                phases = next;
                best = Some(*curve);
            }
        }
    }
    best
}

/// A polygon at a share of its period, modulo 1.
fn along(polygon: &Polygon, share: f64) -> Vector2<f64> {
    let Polygon { layout, z, .. } = polygon;
    let mut left = share.rem_euclid(1.0) * layout.period(z);
    for side in 0..layout.arcs() {
        let time = z[layout.time_index(side)];
        if left <= time {
            let [from, to] = layout.ends(z, side);
            return from + (to - from) * (left / time);
        }
        left -= time;
    }
    layout.corner(z, 0)
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

/// A curve to start from: phases cut into elements.
#[derive(Debug, Clone)]
struct Draft {
    phases: Vec<Phase>,
    phase_of: Vec<usize>,
    /// Where in the period each element began, and its share; those of a phase keep their ratios.
    spans: Vec<(f64, f64)>,
    layout: Layout,
    z: DVector<f64>,
}

impl Draft {
    /// Of about so many elements, or more where phases are many, the first bends of each fitted to a curve over the share of the period.
    fn new(
        (curve, period): (&dyn Fn(f64) -> Vector2<f64>, f64),
        phases: &[Phase],
        elements: usize,
        fitted: usize,
    ) -> Self {
        let mut phase_of = Vec::new();
        let mut spans = Vec::new();
        for (number, phase) in phases.iter().enumerate() {
            let way = |share: f64| curve(share + STEP) - curve(share - STEP);
            let rates = [elements as f64, elements as f64 * TURNS];
            // Where the direction is free, errors of the speed are of second order in those of the costate.
            let free = phase.limits.len() == 1;
            let least = if free { elements.div_ceil(FREE) } else { 1 };
            let parts = cut((phase.from, phase.to), way, (rates, least));
            phase_of.extend(parts.iter().map(|_| number));
            spans.extend(parts.into_iter().map(|(from, to)| (from, to - from)));
        }
        let layout = Layout::new(vec![Shape::Free { bends: BENDS }; spans.len()]);
        let mut z = DVector::zeros(layout.size);
        for (element, &(from, length)) in spans.iter().enumerate() {
            let corner = curve(from);
            z[2 * element] = corner.x;
            z[2 * element + 1] = corner.y;
            z[layout.time_index(element)] = length * period;
        }
        for (element, &(from, length)) in spans.iter().enumerate() {
            let [start, end] = layout.ends(&z, element);
            for joint in 0..2 {
                let rows: Vec<(Vec<f64>, f64)> = (1..24)
                    .map(|k| {
                        let s = f64::from(k) / 24.0;
                        let hump = s * (1.0 - s);
                        let values = legendre(fitted, 2.0 * s - 1.0);
                        let row = values.iter().take(fitted).map(|p| hump * p).collect();
                        let straight = start + (end - start) * s;
                        (row, (curve(from + length * s) - straight)[joint])
                    })
                    .collect();
                let (bends, _) = least_squares(&rows, fitted);
                let at = layout.bends_index(element) + BENDS * joint;
                z.rows_mut(at, fitted).copy_from_slice(&bends);
            }
        }
        Self {
            phases: phases.to_vec(),
            phase_of,
            spans,
            layout,
            z,
        }
    }

    /// The shape at a share of the period, modulo 1.
    fn at(&self, share: f64) -> Vector2<f64> {
        let mut left = share.rem_euclid(1.0) * self.layout.period(&self.z);
        for element in 0..self.layout.arcs() {
            let time = self.z[self.layout.time_index(element)];
            if left <= time {
                let ends = self.layout.ends(&self.z, element);
                let bends = self.layout.bends(&self.z, element);
                return self.layout.shapes[element].at(&ends, bends, left / time);
            }
            left -= time;
        }
        self.layout.corner(&self.z, 0)
    }
}
