//! A solved chain, looked at closely.

use swimmer_model::Model;

use crate::extremal::equations::{STATE, State};
use crate::extremal::flow::flowed;
use crate::extremal::shooting::{Chain, Class};

/// Samples of a piece when it is examined.
const LOOKS: usize = 24;

/// States all along a chain.
pub(super) struct Samples {
    /// Number of the arc, power length from the chain's start, state.
    pub(super) rows: Vec<(usize, f64, State)>,
}

impl Samples {
    pub(super) fn new(model: &Model<f64>, chain: &Chain) -> Option<Self> {
        let mut rows = Vec::new();
        let mut from = 0.0;
        for (index, arc, state) in chain.pieces() {
            let share = (arc.length / arc.pieces as f64).max(0.0);
            let mut here = *state;
            rows.push((index, from, here));
            for look in 1..=LOOKS {
                here = flowed(model, &arc.motion, &here, share / LOOKS as f64)?.0;
                rows.push((index, from + share * look as f64 / LOOKS as f64, here));
            }
            from += share;
        }
        Some(Self { rows })
    }

    /// Whether a curve bends round the corner where an arc begins, and not away from it. The forbidden shapes lie beyond
    /// the corner, so the bend is to that side; a quarter is bent against its mirror image.
    pub(super) fn bends_round(&self, chain: &Chain, class: Class, index: usize) -> bool {
        let first = |number: usize| self.rows.iter().find(|row| row.0 == number);
        let last = |number: usize| self.rows.iter().rev().find(|row| row.0 == number);
        let Some((.., start)) = first(index) else {
            return false;
        };
        let before = match (index.checked_sub(1), class) {
            (Some(before), _) => last(before).map(|row| row.2[2]),
            (None, Class::Quarter) => Some(1.5 * std::f64::consts::PI - start[2]),
            (None, Class::Closed { turn, .. }) => {
                last(chain.arcs.len().saturating_sub(1)).map(|row| row.2[2] - turn)
            }
        };
        let Some(before) = before else {
            return false;
        };
        let mean = 0.5 * (before + start[2]);
        // Positive where the corner points to the left of the motion, away from the origin.
        let left = -start[0] * mean.sin() + start[1] * mean.cos();
        (start[2] - before) * left >= 0.0
    }

    /// The state at a power length that may go beyond the end of a closed curve.
    pub(super) fn round(&self, class: Class, total: f64, length: f64) -> State {
        match class {
            Class::Closed { turn, .. } if length > total => {
                let mut state = self.at(length - total);
                state[2] += turn;
                state
            }
            _ => self.at(length),
        }
    }

    /// The state at a power length, from the sample before by linear interpolation.
    pub(super) fn at(&self, length: f64) -> State {
        let after = self
            .rows
            .partition_point(|row| row.1 <= length)
            .clamp(1, self.rows.len().saturating_sub(1).max(1));
        let pick = |i: usize| {
            self.rows
                .get(i)
                .map_or((0.0, [0.0; STATE]), |row| (row.1, row.2))
        };
        let ((from, low), (to, high)) = (pick(after - 1), pick(after));
        let share = if to > from {
            (length - from) / (to - from)
        } else {
            0.0
        };
        std::array::from_fn(|i| low[i] + share * (high[i] - low[i]))
    }
}
