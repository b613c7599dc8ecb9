//! A gait followed as its bounds tighten.
//!
//! The largest angle comes in from beyond the gait's own. For crossing links the side links count as shortened at first, by
//! a factor that grows to 1: that moves the forbidden shapes in from |φ| = π. Each step starts from the arcs of the last one;
//! where the next gait lies too far off for the step, or none is found, the step is halved, so that no other branch is taken
//! for this one, until the branch is seen to end.

use swimmer_files::Bounds;
use swimmer_model::{Links, Model};

use super::equations::Motion;
use super::shooting::{Chain, Entry, solve};
use super::wall::walls;
use super::{Extremal, Unpolished, polish_chain};
use crate::region::Region;

/// How tight the bounds are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tightness {
    /// |φᵢ| may be this \[rad\].
    pub(crate) max_angle: f64,
    /// Share of the side links that may not cross; 0 where they may.
    pub(crate) share: f64,
}

/// Why a gait could not be followed all the way.
#[derive(Debug, Clone)]
pub(crate) enum Ended {
    /// No gait nearby for tighter bounds, however small the step.
    NoneBeyond { at: Tightness, reason: Unpolished },
    /// A fold: the gait meets another extremal, and neither goes on. The other one, shortly before, is the proof.
    Fold { at: Tightness, other: Box<Extremal> },
    /// Steps shrank although gaits were found: each was another branch.
    OtherBranch { at: Tightness },
    /// The gait is no longer what it was called.
    Property {
        at: Tightness,
        property: &'static str,
    },
}

/// The first step, and the smallest.
const FIRST: f64 = 0.05;
const SMALLEST: f64 = 1e-6;
const MOST_STEPS: usize = 400;
/// How many gaits on the way are kept.
const REMEMBERED: usize = 12;
/// The efficiency may change by this share in one step, and the first shape by this much \[rad\].
const MOST_CHANGE: f64 = 0.08;
const MOST_SHIFT: f64 = 0.12;

/// A path of bounds to follow a gait along.
pub(crate) struct Path<'a> {
    pub(crate) model: &'a Model<f64>,
    /// Least distance between the side links over L.
    pub(crate) clearance: f64,
    /// What the gait must keep being, or which property it lost.
    pub(crate) keeps: &'a dyn Fn(&Extremal) -> Result<(), &'static str>,
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
        // The last gaits on the way, oldest first.
        let mut way_here: Vec<Extremal> = Vec::new();
        for _ in 0..MOST_STEPS {
            if t >= 1.0 {
                return Ok(here);
            }
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

/// The same arcs along walls that have moved.
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

/// How far two gaits are apart, over what a step may change.
fn difference(here: &Extremal, there: &Extremal) -> f64 {
    let scale = |extremal: &Extremal| extremal.heading();
    let change = (scale(there) / scale(here) - 1.0).abs() / MOST_CHANGE;
    let shift = (there.start() - here.start()).amax() / MOST_SHIFT;
    change.max(shift)
}

/// Whether two chains are made of the same arcs.
pub(crate) fn alike(a: &Chain, b: &Chain) -> bool {
    a.states.len() == b.states.len()
        && a.arcs.len() == b.arcs.len()
        && a.arcs
            .iter()
            .zip(&b.arcs)
            .all(|(a, b)| matches!(a.motion, Motion::Free) == matches!(b.motion, Motion::Free))
}

/// The chain as far on the other side of `turn` as `here` is on this side, `factor` times; the arcs are those of `here`.
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

/// The other extremal that a branch meets where it ends, under the bounds of a gait shortly before: the proof of a fold.
/// The Jacobian has the other orientation there.
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
