//! Homotopy in the bounds: follows a gait while its bounds tighten.
//!
//! The bound on the angles starts at the gait's own largest angle. For crossing links, the side links are shortened by a factor
//! that grows to 1, which moves the forbidden shapes in from |φ| = π. Each step starts from the previous arcs. If no gait is found,
//! or if it is too far away for the step, the step is halved, so that the iteration cannot change to another branch. The
//! continuation stops when the steps become too small.

use swimmer_files::Bounds;
use swimmer_model::{Links, Model};

use super::equations::Motion;
use super::shooting::{Chain, Entry, solve};
use super::wall::walls;
use super::{Extremal, Unpolished, polish_chain};
use crate::parallel::Watch;
use crate::region::Region;

/// Bounds at one point of the homotopy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tightness {
    /// Bound on |φᵢ| \[rad\].
    pub(crate) max_angle: f64,
    /// Share of the side links that must not cross; 0 if they may.
    pub(crate) share: f64,
}

/// Premature end of a branch.
#[derive(Debug, Clone)]
pub(crate) enum Ended {
    /// No gait nearby for tighter bounds, even with the smallest step.
    NoneBeyond { at: Tightness, reason: Unpolished },
    /// Fold: the gait merges with another extremal. `other` is that extremal shortly before the fold.
    Fold { at: Tightness, other: Box<Extremal> },
    /// The gaits found by the last steps are on another branch.
    OtherBranch { at: Tightness },
    /// The gait lost a property of its branch.
    Property {
        at: Tightness,
        property: &'static str,
    },
}

/// First step; the next constant is the smallest.
const FIRST: f64 = 0.05;
const SMALLEST: f64 = 1e-6;
const MOST_STEPS: usize = 400;
/// Number of previous gaits that are kept.
const REMEMBERED: usize = 12;
/// Largest relative change of the efficiency in one step; the next constant is that of the first shape \[rad\].
const MOST_CHANGE: f64 = 0.08;
const MOST_SHIFT: f64 = 0.12;

/// Path of the homotopy.
pub(crate) struct Path<'a> {
    pub(crate) model: &'a Model<f64>,
    /// Least distance between the side links over L.
    pub(crate) clearance: f64,
    /// Check of the properties that the gait must keep; the error names the lost one.
    pub(crate) keeps: &'a dyn Fn(&Extremal) -> Result<(), &'static str>,
    /// Receives the completed share of the way before each step.
    pub(crate) watch: Watch<'a>,
}

impl Path<'_> {
    fn walls(&self, at: Tightness) -> Region {
        let links = self.model.swimmer().links;
        let bounds = Bounds {
            max_angle: Some(at.max_angle),
            no_overlap: at.share > 0.0,
            clearance: at.share * self.clearance,
            ..Bounds::default()
        };
        let shortened = Links {
            middle: links.middle,
            front: links.front * at.share.max(1e-3),
            back: links.back * at.share.max(1e-3),
        };
        walls(&bounds, if at.share > 0.0 { &shortened } else { &links })
    }

    /// Follows a gait from one tightness to another.
    pub(crate) fn follow(
        &self,
        start: Extremal,
        from: Tightness,
        to: Tightness,
    ) -> Result<Extremal, Ended> {
        let between = |t: f64| Tightness {
            max_angle: from.max_angle + t * (to.max_angle - from.max_angle),
            share: from.share + t * (to.share - from.share),
        };
        let way = (to.max_angle - from.max_angle).abs() + (to.share - from.share).abs();
        let (mut here, mut t, mut step) = (start, 0.0_f64, (FIRST / way.max(1e-9)).min(1.0));
        let mut failure;
        // The last gaits of the branch, oldest first.
        let mut way_here: Vec<Extremal> = Vec::new();
        for _ in 0..MOST_STEPS {
            if t >= 1.0 {
                return Ok(here);
            }
            (self.watch)(t);
            let next = (t + step).min(1.0);
            match self.step(&here, between(next)) {
                Ok(found) => match difference(&here, &found) {
                    small if small <= 1.0 => {
                        (self.keeps)(&found).map_err(|property| Ended::Property {
                            at: between(next),
                            property,
                        })?;
                        way_here.push(std::mem::replace(&mut here, found));
                        if way_here.len() > REMEMBERED {
                            way_here.remove(0);
                        }
                        t = next;
                        step *= if small < 0.3 { 2.0 } else { 1.1 };
                        continue;
                    }
                    _ => failure = None,
                },
                Err(reason) => failure = Some(reason),
            }
            step *= 0.5;
            if step * way < SMALLEST {
                let at = between(t);
                let Some(reason) = failure else {
                    return Err(Ended::OtherBranch { at });
                };
                let other = way_here
                    .iter()
                    .rev()
                    .find_map(|before| other_side(self.model, before, &here));
                return Err(match other {
                    Some(other) => Ended::Fold {
                        at,
                        other: Box::new(other),
                    },
                    None => Ended::NoneBeyond { at, reason },
                });
            }
        }
        Err(Ended::OtherBranch { at: between(t) })
    }

    fn step(&self, here: &Extremal, at: Tightness) -> Result<Extremal, Unpolished> {
        let walls = self.walls(at);
        polish_chain(self.model, &walls, within_walls(&walls, &here.chain))
    }
}

/// Replaces the bounds of a chain by those of `walls`.
pub(crate) fn within_walls(walls: &Region, chain: &Chain) -> Chain {
    let mut chain = chain.clone();
    for arc in &mut chain.arcs {
        if let Motion::Along(wall) = &mut arc.motion
            && let Some(moved) = walls.like(wall)
        {
            *wall = moved;
        }
        if let Entry::Corner(corner) = &mut arc.entry
            && let Some(moved) = walls.corner(corner)
        {
            *corner = moved;
        }
    }
    chain
}

/// Distance of two gaits relative to the largest change per step.
fn difference(here: &Extremal, there: &Extremal) -> f64 {
    let scale = |extremal: &Extremal| extremal.heading();
    let change = (scale(there) / scale(here) - 1.0).abs() / MOST_CHANGE;
    let shift = (there.start() - here.start()).amax() / MOST_SHIFT;
    change.max(shift)
}

/// Returns `true` if two chains consist of the same arcs.
pub(crate) fn alike(a: &Chain, b: &Chain) -> bool {
    a.states.len() == b.states.len()
        && a.arcs.len() == b.arcs.len()
        && a.arcs
            .iter()
            .zip(&b.arcs)
            .all(|(a, b)| matches!(a.motion, Motion::Free) == matches!(b.motion, Motion::Free))
}

/// Reflects `here` at `turn`, with its distance multiplied by `factor`; the arcs are those of `here`.
pub(crate) fn mirrored(here: &Chain, turn: &Chain, factor: f64) -> Chain {
    let beyond = |from: f64, to: f64| to + factor * (to - from);
    let mut chain = here.clone();
    for (state, to) in chain.states.iter_mut().zip(&turn.states) {
        for (value, to) in state.iter_mut().zip(to) {
            *value = beyond(*value, *to);
        }
    }
    for (arc, to) in chain.arcs.iter_mut().zip(&turn.arcs) {
        arc.length = beyond(arc.length, to.length);
    }
    chain
}

/// Finds the other extremal at a fold, for the bounds of a gait shortly before it. Its Jacobian has the opposite orientation, which
/// proves the fold.
pub(crate) fn other_side(
    model: &Model<f64>,
    before: &Extremal,
    last: &Extremal,
) -> Option<Extremal> {
    let (here, turn) = (&before.chain, &last.chain);
    if !alike(here, turn) {
        return None;
    }
    [1.0, 1.5, 2.0, 0.7].into_iter().find_map(|factor| {
        let other = solve(model, mirrored(here, turn, factor)).ok()?;
        (other.orientation * before.orientation < 0.0).then_some(other)
    })
}
