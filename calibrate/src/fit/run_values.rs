//! What the runs of a fit measured, in the units in which everything compares.

use super::WEIGHTS;
use super::errors::{Variance, within_runs};
use crate::cycles::{Cycles, Statistics};
use crate::error::FitError;
use crate::quantities::{NAMES, QUANTITIES, TELLING, measured};

/// In whose scale each is told.
const SCALED_LIKE: [usize; QUANTITIES] = [0, 1, 2, 0, 2];

/// X, ΔY, Δθ, Y and net turn of every run, each in units of its scale.
#[derive(Debug, Clone)]
pub(crate) struct RunValues {
    /// Largest measured X, ΔY \[m\], Δθ \[rad\]; Y goes with X, the turn with Δθ.
    pub(crate) scales: [f64; QUANTITIES],
    /// Five of each run.
    pub(crate) values: Vec<f64>,
    /// Their variances within runs.
    pub(crate) within: Vec<Variance>,
    /// Which of them count: Y and turn only where they are asked for.
    pub(crate) used: Vec<bool>,
    /// Which of them were measured or told.
    there: Vec<bool>,
}

impl RunValues {
    /// Of cycles, with the variances of what the model makes of measured angles.
    pub(crate) fn of<'a>(
        runs: impl Iterator<Item = (&'a Cycles, [f64; QUANTITIES])>,
    ) -> Result<Self, FitError> {
        let (statistics, more): (Vec<[Statistics; QUANTITIES]>, Vec<[f64; QUANTITIES]>) =
            runs.map(|(cycles, more)| (measured(cycles), more)).unzip();
        let mut scales = [0.0_f64; QUANTITIES];
        for (q, scale) in scales.iter_mut().enumerate() {
            let sizes = statistics.iter().map(|run| run[SCALED_LIKE[q]].mean.abs());
            *scale = sizes.fold(0.0, f64::max);
            let there = |run: &[Statistics; QUANTITIES]| run[SCALED_LIKE[q]].mean.is_finite();
            if !statistics.iter().any(there) {
                // Nobody told it: nothing is in its scale.
                *scale = 1.0;
            }
            if !(*scale > 0.0 && scale.is_finite()) {
                return Err(FitError::NothingMeasured { quantity: NAMES[q] });
            }
        }
        let scaled = |(run, more): ([Variance; QUANTITIES], [f64; QUANTITIES])| {
            std::array::from_fn::<_, QUANTITIES, _>(|q| Variance {
                value: (run[q].value + more[q]) / scales[q].powi(2),
                ..run[q]
            })
        };
        let there: Vec<bool> = statistics
            .iter()
            .flat_map(|run| run.map(|statistics| statistics.mean.is_finite()))
            .collect();
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        let values: Vec<f64> = statistics
            .iter()
            .flat_map(|run| {
                std::array::from_fn::<_, QUANTITIES, _>(|q| finite(run[q].mean / scales[q]))
            })
            .collect();
        Ok(Self {
            scales,
            used: (0..values.len())
                .map(|row| row % QUANTITIES < TELLING && there[row])
                .collect(),
            there,
            values,
            within: within_runs(&statistics)
                .into_iter()
                .zip(more)
                .flat_map(scaled)
                .collect(),
        })
    }

    /// The same with Y and net turn.
    pub(crate) fn with_all(&self) -> Self {
        Self {
            used: self.there.clone(),
            ..self.clone()
        }
    }

    /// Room for one thing more that is known beforehand.
    pub(crate) fn push_known(&mut self) {
        self.used.push(true);
        self.there.push(true);
    }

    /// Whether a value was measured or told at all.
    pub(crate) fn is_there(&self, row: usize) -> bool {
        self.there.get(row).copied().unwrap_or(false)
    }

    /// The paper's weights of those that count.
    pub(crate) fn papers_weights(&self) -> Vec<f64> {
        let weigh = |(row, used): (usize, &bool)| {
            if *used {
                WEIGHTS[row % QUANTITIES]
            } else {
                0.0
            }
        };
        self.used.iter().enumerate().map(weigh).collect()
    }

    /// How many count.
    pub(crate) fn count(&self) -> usize {
        self.used.iter().filter(|used| **used).count()
    }

    /// The same without some values.
    pub(crate) fn without(&self, left_out: impl Fn(usize) -> bool) -> Self {
        let mut out = self.clone();
        for (row, used) in out.used.iter_mut().enumerate() {
            *used = *used && !left_out(row);
        }
        out
    }

    /// Weights of least squares for these variances.
    pub(crate) fn weights(&self, variance: impl Fn(usize) -> f64) -> Vec<f64> {
        let weigh = |(row, used): (usize, &bool)| if *used { 1.0 / variance(row) } else { 0.0 };
        self.used.iter().enumerate().map(weigh).collect()
    }
}
