//! An extremal as a sampled cycle.

use swimmer_files::ArcKind;
use swimmer_model::Model;

use super::equations::{Motion, shape};
use super::flow::flowed;
use super::shooting::{Chain, Class, Entry};
use crate::Arc;
use crate::cycle::{Cycle, Samples};

/// A chain at equal steps of power length, arc by arc. Where an arc begins is a corner: the curvature jumps there (the direction
/// too at a corner of the forbidden shapes), and no interpolation shall reach across.
#[derive(Debug, Clone)]
pub(crate) struct Sampled {
    samples: Samples,
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
            samples: Samples::default(),
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
                    sampled.samples.corners.push(sampled.samples.phi.len());
                }
                sampled
                    .samples
                    .arcs
                    .push((kind, sampled.samples.phi.len(), 0));
            }
            let mut here = *state;
            for step in 0..count {
                let along = from + share * step as f64 / count as f64;
                sampled.samples.along.push(along);
                sampled.samples.phi.push(shape(&here));
                here = flowed(model, &arc.motion, &here, share / count as f64)?.0;
            }
            from += share;
            if let Some(arc) = sampled.samples.arcs.last_mut() {
                arc.2 = sampled.samples.phi.len();
            }
            last = Some(shape(&here));
        }
        sampled.samples.along.push(total);
        sampled.samples.phi.push(last?);
        Some(sampled)
    }

    /// The arcs with their joint angles.
    pub(crate) fn arcs(&self) -> Vec<Arc> {
        self.samples.arcs()
    }

    /// The full cycle.
    pub(crate) fn cycle(&self, class: Class) -> Cycle {
        match class {
            Class::Quarter => self.samples.unfolded([!self.starts_bent, true]),
            Class::Closed { .. } => self.samples.closed(),
        }
    }
}
