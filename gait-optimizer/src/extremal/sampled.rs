//! An extremal as a sampled cycle.

use swimmer_files::ArcKind;
use swimmer_model::Model;

use super::equations::{Motion, shape};
use super::flow::flowed;
use super::shooting::{Chain, Class, Entry, Stretch};
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
        let bent = |arc: &Stretch| matches!(arc.entry, Entry::Corner(_));
        let starts_bent = chain.arcs.first().is_some_and(bent);
        let mut out = Samples::default();
        let mut states = chain.states.iter();
        let mut from = 0.0;
        let mut last = None;
        for (index, arc) in chain.arcs.iter().enumerate() {
            let share = arc.length / arc.pieces as f64;
            let count = (FEWEST..samples)
                .find(|&count| count as f64 * total >= samples as f64 * share)
                .unwrap_or(FEWEST);
            let kind = match &arc.motion {
                Motion::Free => ArcKind::Regular,
                Motion::Along(wall) => wall.kind(),
            };
            let first = out.phi.len();
            if index > 0 || starts_bent || chain.arcs.len() > 1 {
                out.corners.push(first);
            }
            for _ in 0..arc.pieces {
                let mut here = *states.next()?;
                for step in 0..count {
                    out.along.push(from + share * step as f64 / count as f64);
                    out.phi.push(shape(&here));
                    here = flowed(model, &arc.motion, &here, share / count as f64)?.0;
                }
                from += share;
                last = Some(shape(&here));
            }
            out.arcs.push((kind, first, out.phi.len()));
        }
        out.along.push(total);
        out.phi.push(last?);
        Some(Self {
            samples: out,
            starts_bent,
        })
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
