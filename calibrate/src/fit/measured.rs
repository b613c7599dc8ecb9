//! What a fit's runs measured, in the units in which everything that is asked after the fit compares.

use super::errors::{Variance, within_runs};
use crate::campaign::RunResult;
use crate::cycles::Statistics;

/// X, ΔY, Δθ of every run, each in units of its scale.
#[derive(Debug, Clone)]
pub(crate) struct RunValues {
    /// Largest measured X \[m\], ΔY \[m\], Δθ \[rad\].
    pub(crate) scales: [f64; 3],
    /// Three of each run.
    pub(crate) values: Vec<f64>,
    /// Their variances within runs.
    pub(crate) within: Vec<Variance>,
}

impl RunValues {
    pub(crate) fn of(runs: &[RunResult]) -> Self {
        let statistics: Vec<[Statistics; 3]> = runs
            .iter()
            .map(|run| [run.cycles.x, run.cycles.delta_y, run.cycles.delta_theta])
            .collect();
        let largest = |q: usize| {
            let sizes = statistics.iter().map(|run| run[q].mean.abs());
            sizes.fold(0.0, f64::max)
        };
        let scales = [0, 1, 2].map(largest);
        let scaled = |run: [Variance; 3]| {
            [0, 1, 2].map(|q| Variance {
                value: run[q].value / scales[q].powi(2),
                ..run[q]
            })
        };
        Self {
            scales,
            values: statistics
                .iter()
                .flat_map(|run| [0, 1, 2].map(|q| run[q].mean / scales[q]))
                .collect(),
            within: within_runs(&statistics)
                .into_iter()
                .flat_map(scaled)
                .collect(),
        }
    }
}
