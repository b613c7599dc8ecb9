//! The bootstrap of the paper's fit: runs drawn anew, and whole cycles within them; every drawn campaign is fitted again,
//! exactly, on the surface. Fewer than five runs draw nothing worth the name, and are refused. Intervals are bias-corrected and accelerated (Efron's `BCa`), with
//! the acceleration from leaving out each run.
//!
//! From few runs a bootstrap is too narrow: what is drawn varies by (n − 1)/n less than what it was drawn from, and normal
//! quantiles know nothing of a variance that is itself estimated. The quantiles are therefore those of
//! Student's t, widened by √(n/(n − 1)) (the expanded percentiles of T. Hesterberg, The American Statistician 69, 371, 2015).
//!
//! Means of drawn cycles vary by (n − 1)/n less than means of true ones, and drawing breaks the order in which neighbouring
//! steps belong together: the draws are widened by what both take away.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, Normal};

use super::EvidenceOptions;
use super::surface::Surface;
use crate::fit::WEIGHTS;
use crate::least_squares::{Model as _, minimise};
use crate::quantities::QUANTITIES;
use crate::student;

/// From fewer runs it says nothing.
pub(super) const ENOUGH_RUNS: usize = 5;

/// Population of the bootstrap: one run's values of single cycles about their mean, each quantity in units of its scale.
#[derive(Debug, Clone)]
pub(super) struct RunDeviations {
    pub(super) means: [f64; QUANTITIES],
    /// `true` for each quantity that the run has.
    pub(super) there: [bool; QUANTITIES],
    /// Deviations from the mean, widened.
    pub(super) deviations: [Vec<f64>; QUANTITIES],
}

/// Estimates, in (r_s/L, ln χ).
pub(super) struct Bootstrap {
    pub(super) seed: u64,
    pub(super) draws: usize,
    pub(super) at_border: usize,
    pub(super) intervals: [[f64; 2]; 2],
    pub(super) points: Vec<[f64; 2]>,
}

/// Draws and fits.
pub(super) fn bootstrap(
    surface: &Surface,
    runs: &[RunDeviations],
    optimum: [f64; 2],
    level: f64,
    options: EvidenceOptions,
) -> Option<Bootstrap> {
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    if runs.len() < ENOUGH_RUNS {
        return None;
    }
    let measured: Vec<f64> = runs.iter().flat_map(|run| run.means).collect();
    let there: Vec<bool> = runs.iter().flat_map(|run| run.there).collect();
    let mut draws: Vec<[f64; 2]> = Vec::with_capacity(options.draws);
    let mut at_border = 0;
    for _ in 0..options.draws {
        let mut weights = vec![0.0; runs.len()];
        for _ in runs {
            weights[rng.random_range(0..runs.len())] += 1.0;
        }
        let mut values = measured.clone();
        for (run, values) in runs.iter().zip(values.chunks_mut(QUANTITIES)) {
            for (value, deviations) in values.iter_mut().zip(&run.deviations) {
                let mut sum = 0.0;
                for _ in deviations {
                    sum += deviations[rng.random_range(0..deviations.len())];
                }
                *value += sum / deviations.len().max(1) as f64;
            }
        }
        let at = papers_fit(surface, (&values, &there), &weights, optimum);
        at_border += usize::from(!surface.rectangle.holds(at));
        draws.push(at);
    }
    let left_out: Vec<[f64; 2]> = (0..runs.len())
        .map(|run| {
            let mut weights = vec![1.0; runs.len()];
            weights[run] = 0.0;
            papers_fit(surface, (&measured, &there), &weights, optimum)
        })
        .collect();
    let count = runs.len() as f64;
    let reach = (count / (count - 1.0)).sqrt() * student::quantile(count - 1.0, level)?;
    let interval = |parameter: usize| {
        accelerated(
            draws.iter().map(|at| at[parameter]).collect(),
            optimum[parameter],
            &left_out.iter().map(|at| at[parameter]).collect::<Vec<_>>(),
            reach,
        )
    };
    Some(Bootstrap {
        seed: options.seed,
        draws: options.draws,
        at_border,
        intervals: [interval(0)?, interval(1)?],
        points: draws,
    })
}

/// The paper's criterion over weighted runs, its scales taken from the drawn runs as from any others.
pub(super) fn papers_fit(
    surface: &Surface,
    (values, there): (&[f64], &[bool]),
    runs: &[f64],
    start: [f64; 2],
) -> [f64; 2] {
    let mut scales = [0.0_f64; QUANTITIES];
    for (row, value) in values.iter().enumerate() {
        if runs[row / QUANTITIES] > 0.0 {
            scales[row % QUANTITIES] = scales[row % QUANTITIES].max(value.abs());
        }
    }
    let weigh = |row: usize| {
        if !there[row] {
            return 0.0;
        }
        runs[row / QUANTITIES] * WEIGHTS[row % QUANTITIES] / scales[row % QUANTITIES].powi(2)
    };
    let weights: Vec<f64> = (0..values.len()).map(weigh).collect();
    minimise(surface, values, &weights, &start, &surface.bounds())
        .map_or(start, |end| [end.at[0], end.at[1]])
}

/// `BCa`: percentiles of the draws, corrected for bias (position of the optimum in the draws) and for acceleration (change of the
/// spread with the value). The ends lie `reach` standard deviations out.
fn accelerated(
    mut draws: Vec<f64>,
    optimum: f64,
    left_out: &[f64],
    reach: f64,
) -> Option<[f64; 2]> {
    draws.sort_by(f64::total_cmp);
    let count = draws.len() as f64;
    if draws.is_empty() {
        return None;
    }
    let normal = Normal::standard();
    // Ties (a border) count half.
    let below = draws.partition_point(|d| *d < optimum) as f64;
    let not_above = draws.partition_point(|d| *d <= optimum) as f64;
    let share = (f64::midpoint(below, not_above) / count).clamp(1.0 / count, 1.0 - 1.0 / count);
    let bias = normal.inverse_cdf(share);
    let mean = left_out.iter().sum::<f64>() / left_out.len().max(1) as f64;
    let (mut squares, mut cubes) = (0.0, 0.0);
    for value in left_out {
        squares += (mean - value).powi(2);
        cubes += (mean - value).powi(3);
    }
    let acceleration = if squares > 0.0 {
        cubes / (6.0 * squares.powf(1.5))
    } else {
        0.0
    };
    let end = |out: f64| {
        let z = bias + out;
        let moved = normal.cdf(bias + z / (1.0 - acceleration * z));
        quantile(&draws, moved)
    };
    Some([end(-reach), end(reach)])
}

/// The value below which a share of sorted values lies.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    let place = share.clamp(0.0, 1.0) * last as f64;
    let (low, part) = (place.floor() as usize, place.fract());
    let value = |i: usize| sorted.get(i.min(last)).copied().unwrap_or(f64::NAN);
    value(low) * (1.0 - part) + value(low + 1) * part
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal quantile of 95 %.
    const NINE_OF_TEN: f64 = 1.644_853_6;

    #[test]
    fn without_bias_and_acceleration_it_is_the_percentile_interval() {
        let draws: Vec<f64> = (0..=1000).map(f64::from).collect();
        let [low, high] = accelerated(draws, 500.0, &[1.0, 2.0, 3.0], NINE_OF_TEN).unwrap();
        assert!(
            (low - 50.0).abs() < 1.0 && (high - 950.0).abs() < 1.0,
            "{low} {high}"
        );
    }

    #[test]
    fn draws_that_lie_too_low_are_moved_up() {
        let draws: Vec<f64> = (0..=1000).map(f64::from).collect();
        let [low, high] = accelerated(draws, 600.0, &[1.0, 2.0, 3.0], NINE_OF_TEN).unwrap();
        assert!(low > 80.0 && high > 970.0, "{low} {high}");
    }
}
