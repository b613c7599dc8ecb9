//! Measured values of the runs of a fit, in common units.

use super::WEIGHTS;
use super::errors::{RunErrors, Variance, within_runs};
use crate::cycles::{Cycles, Statistics};
use crate::error::FitError;
use crate::quantities::{NAMES, QUANTITIES, TELLING, measured};

/// Quantity in whose scale each is measured.
const SCALED_LIKE: [usize; QUANTITIES] = [0, 1, 2, 0, 2];

/// X, ΔY, Δθ, Y and net turn of every run, each in units of its scale.
#[derive(Debug, Clone)]
pub(crate) struct RunValues {
    /// Largest measured X, ΔY \[m\], Δθ \[rad\]; Y goes with X, the turn with Δθ.
    pub(crate) scales: [f64; QUANTITIES],
    /// Five of each run; those of the first of several repeats are their mean.
    pub(crate) values: Vec<f64>,
    /// The same of each run by itself.
    pub(crate) own: Vec<f64>,
    /// Their variances within runs.
    pub(crate) within: Vec<Variance>,
    /// The same of each run by itself.
    pub(crate) own_within: Vec<Variance>,
    /// Values that count: Y and turn only if they are requested.
    pub(crate) used: Vec<bool>,
    /// Values that were measured or stated.
    there: Vec<bool>,
    /// Values that count if they are requested: all but those of later repeats.
    counts: Vec<bool>,
}

impl RunValues {
    /// Of cycles, with the variances that their scatter does not show. `first` is the first run of the same gait, for each run:
    /// repeats count as one run with their mean, since what the model misses of a gait it misses in all of them.
    pub(crate) fn of<'a>(
        runs: impl Iterator<Item = (&'a Cycles, RunErrors)>,
        first: &[usize],
    ) -> Result<Self, FitError> {
        let (statistics, errors): (Vec<[Statistics; QUANTITIES]>, Vec<RunErrors>) = runs
            .map(|(cycles, errors)| (measured(cycles), errors))
            .unzip();
        let mut scales = [0.0_f64; QUANTITIES];
        for (q, scale) in scales.iter_mut().enumerate() {
            let sizes = statistics.iter().map(|run| run[SCALED_LIKE[q]].mean.abs());
            *scale = sizes.fold(0.0, f64::max);
            let there = |run: &[Statistics; QUANTITIES]| run[SCALED_LIKE[q]].mean.is_finite();
            if !statistics.iter().any(there) {
                // Without a value nothing is in its scale.
                *scale = 1.0;
            }
            if !(*scale > 0.0 && scale.is_finite()) {
                return Err(FitError::NothingMeasured { quantity: NAMES[q] });
            }
        }
        let scaled = |(run, errors): ([Variance; QUANTITIES], &RunErrors)| {
            std::array::from_fn::<_, QUANTITIES, _>(|q| Variance {
                value: (run[q].value + errors.path[q]) / scales[q].powi(2),
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
        let mut out = Self {
            scales,
            used: Vec::new(),
            there,
            counts: Vec::new(),
            own: values.clone(),
            values,
            own_within: Vec::new(),
            within: within_runs(&statistics, &errors)
                .into_iter()
                .zip(&errors)
                .flat_map(scaled)
                .collect(),
        };
        out.counts.clone_from(&out.there);
        out.own_within.clone_from(&out.within);
        out.average_repeats(first);
        out.used = (0..out.values.len())
            .map(|row| row % QUANTITIES < TELLING && out.counts[row])
            .collect();
        Ok(out)
    }

    /// Gives the mean of repeats to the first of them, with its variance: by the cycles, or by the repeats' own scatter if that
    /// is larger. The others do not count.
    fn average_repeats(&mut self, first: &[usize]) {
        for leader in 0..first.len() {
            let repeats: Vec<usize> = (leader..first.len())
                .filter(|run| first.get(*run) == Some(&leader))
                .collect();
            if repeats.len() < 2 {
                continue;
            }
            for q in 0..QUANTITIES {
                let rows = repeats.iter().map(|run| QUANTITIES * run + q);
                let rows: Vec<usize> = rows.filter(|row| self.there[*row]).collect();
                let Some((head, others)) = rows.split_first() else {
                    continue;
                };
                let count = rows.len() as f64;
                let mean = rows.iter().map(|row| self.own[*row]).sum::<f64>() / count;
                let squares = rows.iter().map(|row| (self.own[*row] - mean).powi(2));
                let scatter = squares.sum::<f64>() / (count - 1.0).max(1.0) / count;
                let within = rows.iter().map(|row| self.within[*row].value).sum::<f64>();
                let within = within / count.powi(2);
                let freedom = rows.iter().map(|row| self.within[*row].freedom);
                let freedom = freedom.sum::<f64>();
                self.values[*head] = mean;
                self.within[*head] = if scatter > within || freedom <= 0.0 {
                    Variance {
                        value: scatter.max(within),
                        freedom: count - 1.0,
                    }
                } else {
                    Variance {
                        value: within,
                        freedom,
                    }
                };
                for other in others {
                    self.counts[*other] = false;
                }
            }
        }
    }

    /// The same with Y and net turn.
    pub(crate) fn with_all(&self) -> Self {
        Self {
            used: self.counts.clone(),
            ..self.clone()
        }
    }

    /// Room for one thing more that is known beforehand.
    pub(crate) fn push_known(&mut self) {
        self.used.push(true);
        self.there.push(true);
        self.counts.push(true);
    }

    /// Returns `true` if the value was measured or stated.
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

    /// Returns `true` if every value that counts has an error, by scatter or as stated.
    pub(crate) fn has_errors(&self) -> bool {
        let mut used = self.within.iter().zip(&self.used);
        used.all(|(within, used)| !used || within.is_known())
    }

    /// Number of values that count.
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
