//! The way of the joints between a table and a servo's shaft, as a gait that the model can swim: a chain of straight pieces.

use nalgebra::Vector2;
use swimmer_model::{Gait, GaitPoint};

/// A chain of straight pieces, each given the same share of u: only its shape means something, not its timing.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    vertices: Vec<Vector2<f64>>,
}

impl Polyline {
    /// Through these shapes \[rad\]; repeated ones are left out.
    pub fn new(vertices: impl IntoIterator<Item = Vector2<f64>>) -> Self {
        let mut vertices: Vec<_> = vertices.into_iter().collect();
        vertices.dedup();
        Self { vertices }
    }

    /// Its corners \[rad\].
    pub fn vertices(&self) -> &[Vector2<f64>] {
        &self.vertices
    }
}

impl Gait<f64> for Polyline {
    fn at(&self, u: f64) -> GaitPoint<f64> {
        let pieces = self.pieces();
        let scaled = (u - u.floor()) * pieces as f64;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of the pieces; NaN becomes 0"
        )]
        let index = (scaled as usize).min(pieces - 1);
        let vertex = |index| self.vertices.get(index).copied();
        let from = vertex(index).unwrap_or_default();
        let turn = vertex(index + 1).unwrap_or(from) - from;
        GaitPoint {
            phi: from + turn * (scaled - index as f64),
            rate: turn * pieces as f64,
        }
    }

    fn pieces(&self) -> usize {
        self.vertices.len().saturating_sub(1).max(1)
    }

    fn piece_end(&self, i: usize) -> f64 {
        (i + 1) as f64 / self.pieces() as f64
    }

    fn corner_at_end(&self, _i: usize) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_the_slopes_of_the_chain() {
        let [one, two, three] = [[0.0, 0.0], [1.0, 0.2], [0.3, 0.9]].map(Vector2::from);
        let chain = Polyline::new([one, two, two, three, one]);
        assert_eq!(chain.pieces(), 3);
        for i in 0..50 {
            let u = (f64::from(i) + 0.5) / 50.0;
            let slope = (chain.at(u + 1e-6).phi - chain.at(u - 1e-6).phi) / 2e-6;
            assert!((slope - chain.at(u).rate).norm() < 1e-6, "{u}");
        }
        assert!((chain.at(0.0).phi - one).norm() < 1e-15);
    }
}
