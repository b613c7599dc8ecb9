//! Intersections of the zero-level curves with the diagonals φ₁ = ±φ₂.

use nalgebra::Vector2;

use super::{HeightMap, Level, Row};

/// Largest height on a line on which it vanishes by symmetry.
const BY_SYMMETRY: f64 = 1e-13;
/// Number of samples of half a diagonal, between which at most one zero is expected.
const SAMPLES: u32 = 400;

impl HeightMap {
    /// Zeros of a height with φ₁ = φ₂ > 0, in rising order; empty if it vanishes on the whole diagonal.
    pub fn zeros_on_diagonal(&self, row: Row) -> Vec<f64> {
        self.zeros_along(row, &Vector2::new(1.0, 1.0))
    }

    /// Zeros φ₂ > 0 of a height with φ₁ = −φ₂, in rising order; empty if it vanishes on the whole diagonal.
    pub fn zeros_on_antidiagonal(&self, row: Row) -> Vec<f64> {
        self.zeros_along(row, &Vector2::new(-1.0, 1.0))
    }

    fn zeros_along(&self, row: Row, direction: &Vector2<f64>) -> Vec<f64> {
        let at = |k: u32| direction * (self.half_width * f64::from(k) / f64::from(SAMPLES));
        let heights: Vec<f64> = (0..=SAMPLES).map(|k| self.height(row, &at(k))).collect();
        if heights.iter().all(|height| height.abs() <= BY_SYMMETRY) {
            return Vec::new();
        }
        let level = Level(|phi: &Vector2<f64>| self.height_and_gradient(row, phi));
        // The zero at Φ = 0 follows from symmetry and is not an intersection, so the first interval starts next to it.
        (0..SAMPLES)
            .zip(heights.iter().zip(heights.iter().skip(1)))
            .filter(|&(k, (before, after))| {
                (*before > 0.0) != (*after > 0.0) && !(k == 0 && before.abs() <= BY_SYMMETRY)
            })
            .filter_map(|(k, _)| level.between(&at(k), &at(k + 1)))
            .map(|phi| phi.y)
            .collect()
    }
}
