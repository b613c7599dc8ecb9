//! Where the zero-level curves meet the diagonals φ₁ = ±φ₂.

use nalgebra::Vector2;

use super::{HeightMap, Level, Row};

/// A line on which a height vanishes by symmetry shows no more than this.
const BY_SYMMETRY: f64 = 1e-13;
/// Samples of half a diagonal between which one zero at most is expected.
const SAMPLES: u32 = 400;

impl HeightMap {
    /// The zeros of a height with φ₁ = φ₂ > 0, in rising order; none where it vanishes all along the diagonal.
    pub fn zeros_on_diagonal(&self, row: Row) -> Vec<f64> {
        self.zeros_along(row, &Vector2::new(1.0, 1.0))
    }

    /// The zeros φ₂ > 0 of a height with φ₁ = −φ₂, in rising order; none where it vanishes all along the diagonal.
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
        // Zero at Φ = 0 itself is symmetry, not a crossing: the first stretch starts beside it.
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
