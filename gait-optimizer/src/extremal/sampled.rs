//! An extremal as a sampled cycle.

use nalgebra::Vector2;
use swimmer_files::{ArcKind, GaitArc};
use swimmer_model::Model;

use super::equations::{Motion, shape};
use super::flow::flowed;
use super::shooting::{Chain, Class, Entry};
use crate::Arc;
use crate::cycle::{Cycle, Quarter};

/// A chain at equal steps of power length, arc by arc.
#[derive(Debug, Clone)]
pub(crate) struct Sampled {
    /// Power length over that of the chain.
    at: Vec<f64>,
    phi: Vec<Vector2<f64>>,
    /// Each arc with its first and last sample.
    arcs: Vec<(ArcKind, usize, usize)>,
    /// Samples where an arc begins: there the curvature jumps (the direction too at a corner of the forbidden shapes).
    joints: Vec<usize>,
    /// Whether the first sample is a kink.
    starts_bent: bool,
}

/// Fewest samples of a piece.
const FEWEST: usize = 4;

impl Sampled {
    /// None where an arc cannot be followed.
    pub(crate) fn new(model: &Model<f64>, chain: &Chain, samples: usize) -> Option<Self> {
        let total = chain.length();
        let mut sampled = Self {
            at: Vec::with_capacity(samples + 1),
            phi: Vec::with_capacity(samples + 1),
            arcs: Vec::new(),
            joints: Vec::new(),
            starts_bent: chain
                .arcs
                .first()
                .is_some_and(|arc| matches!(arc.entry, Entry::Corner(_))),
        };
        let mut from = 0.0;
        let mut before = None;
        let mut last = None;
        for (index, arc, state) in chain.pieces() {
            let share = arc.length / arc.pieces as f64;
            let count = (FEWEST..samples)
                .find(|&count| count as f64 * total >= samples as f64 * share)
                .unwrap_or(FEWEST);
            if before != Some(index) {
                before = Some(index);
                let kind = match &arc.motion {
                    Motion::Free => ArcKind::Regular,
                    Motion::Along(wall) => wall.kind(),
                };
                if index > 0 || sampled.starts_bent || chain.arcs.len() > 1 {
                    sampled.joints.push(sampled.phi.len());
                }
                sampled.arcs.push((kind, sampled.phi.len(), 0));
            }
            let mut here = *state;
            for step in 0..count {
                sampled
                    .at
                    .push((from + share * step as f64 / count as f64) / total);
                sampled.phi.push(shape(&here));
                here = flowed(model, &arc.motion, &here, share / count as f64)?.0;
            }
            from += share;
            if let Some(arc) = sampled.arcs.last_mut() {
                arc.2 = sampled.phi.len();
            }
            last = Some(shape(&here));
        }
        sampled.at.push(1.0);
        sampled.phi.push(last?);
        Some(sampled)
    }

    /// The arcs with their joint angles.
    pub(crate) fn arcs(&self) -> Vec<Arc> {
        let at = |i: usize| self.phi.get(i).map_or([f64::NAN; 2], |phi| [phi.x, phi.y]);
        let arcs = self.arcs.iter().map(|&(kind, from, to)| Arc {
            kind,
            from: at(from),
            to: at(to),
        });
        arcs.collect()
    }

    fn place(&self, i: usize) -> f64 {
        self.at.get(i).copied().unwrap_or(1.0)
    }

    fn gait_arcs(&self) -> Vec<GaitArc> {
        let arcs = self.arcs.iter().map(|&(kind, from, to)| GaitArc {
            kind,
            from: self.place(from),
            to: self.place(to),
        });
        arcs.collect()
    }

    /// The full cycle.
    pub(crate) fn cycle(&self, class: Class) -> Cycle {
        match class {
            Class::Quarter => Cycle::of_quarter(&Quarter {
                at: self.at.clone(),
                phi: &self.phi,
                corners: self
                    .joints
                    .iter()
                    .filter(|&&i| i > 0)
                    .map(|&i| self.place(i))
                    .collect(),
                arcs: self.gait_arcs(),
                square: [!self.starts_bent, true],
            }),
            Class::Closed { .. } => {
                let mut cycle = Cycle {
                    u: self.at.clone(),
                    phi: self.phi.clone(),
                    // Marked as corners, so that no interpolation reaches across a jump of the curvature.
                    corners: self.joints.iter().map(|&i| self.place(i)).collect(),
                    arcs: self.gait_arcs(),
                };
                // The last sample repeats the first to the last bit.
                if let (Some(first), Some(last)) =
                    (cycle.phi.first().copied(), cycle.phi.last_mut())
                {
                    *last = first;
                }
                cycle
            }
        }
    }
}
