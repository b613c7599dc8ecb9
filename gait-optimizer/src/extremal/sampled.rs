//! Sampling of an extremal as a cycle.

use swimmer_files::ArcKind;
use swimmer_model::Model;

use super::equations::{Motion, shape};
use super::flow::flowed;
use super::shooting::{Chain, Class, Entry, Stretch};
use crate::cycle::{Cycle, Samples};

/// Least number of samples per piece.
const FEWEST: usize = 4;

/// Samples the full cycle of a chain at uniform steps of power length, arc by arc. The start of an arc is marked as a corner, since
/// the curvature jumps there (at a corner of the forbidden shapes the direction too), so that no interpolation crosses it. Returns
/// `None` if an arc cannot be integrated.
pub(crate) fn sampled(model: &Model<f64>, chain: &Chain, samples: usize) -> Option<Cycle> {
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
    Some(match chain.class {
        Class::Quarter => out.unfolded([!starts_bent, true]),
        Class::Closed { .. } => out.closed(),
    })
}
