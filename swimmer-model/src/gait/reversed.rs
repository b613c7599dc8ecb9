//! Time-reversed gait, whose stroke is the inverse of the original.

use super::{Gait, GaitPoint};
use crate::Scalar;

/// The gait u ↦ Φ(1 − u).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reversed<G>(pub G);

impl<T: Scalar, G: Gait<T>> Gait<T> for Reversed<G> {
    fn at(&self, u: T) -> GaitPoint<T> {
        let forward = self.0.at(T::one() - u);
        GaitPoint {
            phi: forward.phi,
            rate: -forward.rate,
        }
    }

    fn pieces(&self) -> usize {
        self.0.pieces()
    }

    fn piece_end(&self, i: usize) -> T {
        match self.mirrored(i) {
            Some(j) => T::one() - self.0.piece_end(j),
            None => T::one(),
        }
    }

    fn corner_at_end(&self, i: usize) -> bool {
        // Across u = 1 it is the same knot both ways.
        self.0.corner_at_end(self.mirrored(i).unwrap_or(i))
    }
}

impl<G> Reversed<G> {
    /// Piece of the forward gait with the same end as piece `i`. Returns `None` for the last piece.
    fn mirrored<T: Scalar>(&self, i: usize) -> Option<usize>
    where
        G: Gait<T>,
    {
        self.0.pieces().checked_sub(i + 2)
    }
}
