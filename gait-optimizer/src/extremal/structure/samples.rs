//! Dense samples of a solved chain.

use swimmer_model::Model;

use crate::extremal::equations::State;
use crate::extremal::flow::flowed;
use crate::extremal::guess::Trajectory;
use crate::extremal::shooting::{Chain, Class};

/// Number of samples per piece.
const LOOKS: usize = 24;

/// States along a chain.
pub(super) struct Samples {
    /// Index of the arc of each sample.
    arcs: Vec<usize>,
    pub(super) swum: Trajectory,
}

impl Samples {
    pub(super) fn new(model: &Model<f64>, chain: &Chain) -> Option<Self> {
        let turn = match chain.class {
            Class::Closed { turn, .. } => turn,
            Class::Quarter => 0.0,
        };
        let (mut arcs, mut length, mut states) = (Vec::new(), Vec::new(), Vec::new());
        let mut from = 0.0;
        for (index, arc, state) in chain.pieces() {
            let share = (arc.length / arc.pieces as f64).max(0.0);
            let mut here = *state;
            for look in 0..=LOOKS {
                if look > 0 {
                    here = flowed(model, &arc.motion, &here, share / LOOKS as f64)?.0;
                }
                arcs.push(index);
                length.push(from + share * look as f64 / LOOKS as f64);
                states.push(here);
            }
            from += share;
        }
        let swum = Trajectory {
            length,
            states,
            turn,
        };
        Some(Self { arcs, swum })
    }

    /// Samples of an arc: power length from the start of the chain, and state.
    pub(super) fn of_arc(&self, index: usize) -> impl DoubleEndedIterator<Item = (f64, &State)> {
        let first = self.arcs.partition_point(|arc| *arc < index);
        let last = self.arcs.partition_point(|arc| *arc <= index);
        self.swum.rows().take(last).skip(first)
    }

    /// Returns `true` if the curve bends around the corner at the start of an arc. The forbidden shapes are beyond the corner, so the
    /// bend must be to that side; a quarter bends against its mirror image.
    pub(super) fn bends_round(&self, chain: &Chain, index: usize) -> bool {
        let last = |number: usize| Some(self.of_arc(number).next_back()?.1[2]);
        let Some((_, start)) = self.of_arc(index).next() else {
            return false;
        };
        let before = match (index.checked_sub(1), chain.class) {
            (Some(before), _) => last(before),
            (None, Class::Quarter) => Some(1.5 * std::f64::consts::PI - start[2]),
            (None, Class::Closed { turn, .. }) => {
                last(chain.arcs.len().saturating_sub(1)).map(|psi| psi - turn)
            }
        };
        let Some(before) = before else {
            return false;
        };
        let mean = 0.5 * (before + start[2]);
        // Positive if the corner points to the left of the motion, away from the origin.
        let left = -start[0] * mean.sin() + start[1] * mean.cos();
        (start[2] - before) * left >= 0.0
    }
}
