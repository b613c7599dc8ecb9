//! Where a quarter of a symmetric Fourier gait is looked at: the midpoints of Q equal parts of s ∈ (0, π/2).
//!
//! By the two symmetries x′, √P and P continue past both ends as even functions, so the midpoint rule is the periodic
//! trapezoidal rule and converges spectrally. θ′ is even about 0 and odd about π/2, a sum of cos ks with k odd, and so is
//! integrated exactly by a fixed matrix.

use nalgebra::DMatrix;

/// A quarter's nodes, with the matrix that integrates θ′.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    /// s at each node.
    pub(crate) nodes: Vec<f64>,
    /// ∫ds belonging to each node.
    pub(crate) weight: f64,
    /// θ at the nodes is this times θ′ there.
    pub(crate) integral: DMatrix<f64>,
}

impl Grid {
    pub(crate) fn new(count: usize) -> Self {
        let half_step = std::f64::consts::FRAC_PI_2 / (2 * count) as f64;
        // With θ′ = Σ cₖ cos ks, k = 1, 3, …, 2Q − 1: θ(sᵢ) = (2/Q) Σⱼ Σₖ sin(ksᵢ) cos(ksⱼ)/k θ′(sⱼ), and
        // 2 sin a cos b = sin(a + b) + sin(a − b) leaves sums over k that depend on one integer, the argument in half steps.
        let sine_sums: Vec<f64> = (0..=2 * count)
            .map(|steps| {
                let angle = 2.0 * half_step * steps as f64;
                (0..count)
                    .map(|n| (2 * n + 1) as f64)
                    .map(|k| (k * angle).sin() / k)
                    .sum()
            })
            .collect();
        let sum = |steps: usize| sine_sums.get(steps).copied().unwrap_or(0.0);
        let integral = DMatrix::from_fn(count, count, |i, j| {
            let apart = sum(i.abs_diff(j));
            let signed = if i >= j { apart } else { -apart };
            (sum(i + j + 1) + signed) / count as f64
        });
        Self {
            nodes: (0..count).map(|j| half_step * (2 * j + 1) as f64).collect(),
            weight: 2.0 * half_step,
            integral,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    #[test]
    fn odd_cosines_are_integrated_exactly() {
        let grid = Grid::new(12);
        for k in [1.0, 3.0, 11.0] {
            let rate = DVector::from_fn(12, |j, _| (k * grid.nodes[j]).cos());
            let integral = &grid.integral * rate;
            for (s, value) in grid.nodes.iter().zip(integral.iter()) {
                assert!((value - (k * s).sin() / k).abs() < 1e-14);
            }
        }
    }
}
