//! Mean, deviation and standard error over cycles.

use swimmer_files::ReportedValue;

/// Statistics of one quantity over the cycles of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// Mean.
    pub mean: f64,
    /// Standard deviation from cycle to cycle; NaN for a single one, which shows no scatter.
    pub sd: f64,
    /// Standard error of the mean. Neighbouring steps share a cycle, so that noise of the cameras makes them vary against
    /// each other; the lag-1 correlation is taken into account from five values on. NaN for a single one.
    pub se: f64,
    /// Lag-1 correlation; 0 below five values, NaN if it is unknown.
    pub lag1: f64,
    /// Number of values.
    pub count: usize,
}

impl Statistics {
    /// Stated value of this number of cycles; NaN if it is not stated.
    pub(crate) fn reported(value: Option<&ReportedValue>, cycles: Option<usize>) -> Self {
        let nothing = f64::NAN;
        let Some(ReportedValue { mean, sd, se }) = value else {
            return Self {
                mean: nothing,
                sd: nothing,
                se: nothing,
                lag1: nothing,
                count: 0,
            };
        };
        let count = cycles.unwrap_or(1);
        let of_sd = sd.map(|sd| sd / (count as f64).sqrt());
        Self {
            mean: *mean,
            sd: sd.unwrap_or(nothing),
            se: se.or(of_sd).unwrap_or(nothing),
            lag1: nothing,
            count,
        }
    }

    pub(super) fn of(values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.collect();
        let n = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let variance = if n > 1.0 {
            squares / (n - 1.0)
        } else {
            f64::NAN
        };
        let products: f64 = values
            .windows(2)
            .map(|w| w.iter().map(|v| v - mean).product::<f64>())
            .sum();
        let lag1 = if values.len() >= 5 && squares > 0.0 {
            products / squares
        } else {
            0.0
        };
        let inflation = (1.0 + 2.0 * lag1 * (1.0 - 1.0 / n)).max(1.0 / n);
        Self {
            mean,
            sd: variance.sqrt(),
            se: (variance / n * inflation).sqrt(),
            lag1,
            count: values.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Statistics;

    #[test]
    fn plain_and_correlated_values() {
        let plain = Statistics::of([1.0, 2.0, 3.0].into_iter());
        assert_eq!((plain.mean, plain.sd, plain.count), (2.0, 1.0, 3));
        assert!((plain.se - 1.0 / 3f64.sqrt()).abs() < 1e-15);
        let alternating = Statistics::of([1.0, 2.0, 1.0, 2.0, 1.0, 2.0].into_iter());
        assert!(alternating.lag1 < -0.7 && alternating.se < alternating.sd / 4.0);
        let one = Statistics::of([4.0].into_iter());
        assert!((one.mean - 4.0).abs() < 1e-15 && one.sd.is_nan() && one.se.is_nan());
    }
}
