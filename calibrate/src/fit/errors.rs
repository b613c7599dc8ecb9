//! Errors of X, ΔY and Δθ of a run, estimated from its cycles.
//!
//! Their variance comes from as few as four cycles, so it is itself uncertain: the runs' variances are shrunk towards a common
//! value, as far as their own scatter allows (Smyth's moderated variances, Stat. Appl. Genet. Mol. Biol. 3, 2004). Two cycles can
//! agree by chance, so the noise of the cameras is a lower bound of each variance, and a run of two or three cycles is pooled
//! with the others at least up to [`LEAST_FREEDOM`] degrees of freedom.
//!
//! Steps X of neighbouring cycles share one position, so camera noise gives them a negative correlation and a drifting tank a
//! positive one; their lag-1 correlation is pooled over the runs.
//!
//! An error that all cycles of a run share does not show here, but in the residuals of the fit (`components.rs`).

use statrs::function::gamma::digamma;

use crate::cycles::Statistics;
use crate::median::median;
use crate::quantities::{QUANTITIES, TELLING};

/// A squared standard error and how many degrees of freedom it rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Variance {
    pub(crate) value: f64,
    /// Infinite for what is known beforehand, of no run.
    pub(crate) freedom: f64,
}

/// Relative deviation below which numbers are rounding.
const ROUNDING: f64 = 1e-12;
/// Degrees of freedom of a variance that is common to all runs, as far as the data show.
pub(super) const MOST_FREEDOM: f64 = 1e4;

/// Degrees of freedom of a run's variance, at least: its own and those that it shares with other runs.
const LEAST_FREEDOM: f64 = 3.0;

impl Variance {
    /// `true` if the error rests on scatter or on a stated error. If not, `value` is a lower bound.
    pub(crate) fn is_known(self) -> bool {
        self.freedom > 0.0
    }
}

/// Variances of a run's values from other sources than the scatter between its cycles.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct RunErrors {
    /// Variance of the model's values by errors of measured joint angles: it adds to the variance of the mean.
    pub(crate) path: [f64; QUANTITIES],
    /// Variance of a single cycle by the noise of the cameras: a lower bound of the scatter between cycles.
    pub(crate) noise: [f64; QUANTITIES],
}

/// Variances of the means of X, ΔY, Δθ, run by run, from the deviations between cycles, none below the noise of the cameras.
pub(crate) fn within_runs(
    measured: &[[Statistics; QUANTITIES]],
    errors: &[RunErrors],
) -> Vec<[Variance; QUANTITIES]> {
    let nothing = Variance {
        value: 0.0,
        freedom: 0.0,
    };
    let mut out = vec![[nothing; QUANTITIES]; measured.len()];
    // Scatter over noise of those quantities that show both.
    let mut excess: Vec<f64> = Vec::new();
    for quantity in 0..QUANTITIES {
        let of_runs: Vec<Statistics> = measured.iter().map(|run| run[quantity]).collect();
        let sizes = of_runs.iter().map(|s| s.mean.abs());
        // f64::max leaves out what is not there.
        let largest = sizes.fold(0.0, f64::max);
        // Only steps have a reason to be correlated.
        let lag1 = if quantity == 0 || quantity >= TELLING {
            common_lag(&of_runs)
        } else {
            0.0
        };
        let rounding = (ROUNDING * largest).powi(2);
        let floors: Vec<f64> = errors
            .iter()
            .map(|errors| errors.noise[quantity].max(rounding))
            .collect();
        let variances = moderated(&of_runs, &floors);
        let seen = variances.iter().zip(errors).zip(&of_runs);
        excess.extend(
            seen.filter(|((variance, errors), s)| {
                variance.is_known() && s.count > 1 && errors.noise[quantity] > 0.0
            })
            .map(|((variance, errors), _)| variance.value / errors.noise[quantity]),
        );
        for (out, variance) in out.iter_mut().zip(variances) {
            out[quantity] = variance;
        }
        let stated = median(
            of_runs
                .iter()
                .filter(|s| states_error(s))
                .map(|s| s.se.powi(2)),
        );
        for (out, s) in out.iter_mut().zip(&of_runs) {
            if s.mean.is_nan() {
                // Not there: it has no weight.
                out[quantity] = Variance {
                    value: 0.0,
                    freedom: 1.0,
                };
                continue;
            }
            if states_error(s) {
                out[quantity] = Variance {
                    value: s.se.powi(2),
                    freedom: MOST_FREEDOM,
                };
                continue;
            }
            if let (Some(value), false) = (stated, out[quantity].is_known()) {
                // As sure as the runs that state an error.
                out[quantity] = Variance {
                    value,
                    freedom: 1.0,
                };
                continue;
            }
            let n = s.count.max(1) as f64;
            // Cycles that vary against each other widen the sample's deviation, and the other way round.
            let inflation = (1.0 + 2.0 * lag1 * (1.0 - 1.0 / n)) / (1.0 - 2.0 * lag1 / n);
            out[quantity].value *= inflation.max(1.0 / n) / n;
        }
    }
    // A quantity of which each run has a single value scatters over its noise as the others do.
    if let Some(excess) = median(excess.into_iter()) {
        for (variances, errors) in out.iter_mut().zip(errors) {
            for (variance, noise) in variances.iter_mut().zip(errors.noise) {
                if !variance.is_known() && noise > 0.0 {
                    *variance = Variance {
                        value: variance.value * excess.max(1.0),
                        freedom: 1.0,
                    };
                }
            }
        }
    }
    out
}

/// Returns `true` if a value has an error and no cycles.
fn states_error(s: &Statistics) -> bool {
    s.sd.is_nan() && s.se.is_finite()
}

/// The lag-1 correlation of all runs together, corrected for the bias −1/n due to a run's own mean.
fn common_lag(runs: &[Statistics]) -> f64 {
    let (mut products, mut squares) = (0.0, 0.0);
    for s in runs
        .iter()
        .filter(|s| s.count >= 5 && s.sd > 0.0 && s.lag1.is_finite())
    {
        let n = s.count as f64;
        products += (s.lag1 + 1.0 / n) * (n - 1.0);
        squares += n - 1.0;
    }
    if squares > 0.0 {
        (products / squares).clamp(-0.5, 0.5)
    } else {
        0.0
    }
}

/// Variances of single cycles, shrunk towards each other, each at least its lower bound.
fn moderated(runs: &[Statistics], floors: &[f64]) -> Vec<Variance> {
    let samples: Vec<(f64, f64)> = runs
        .iter()
        .zip(floors)
        .filter(|(s, _)| s.count > 1 && !s.sd.is_nan())
        .map(|(s, floor)| (s.sd.powi(2).max(*floor), s.count as f64 - 1.0))
        .collect();
    let Some(prior) = prior(&samples) else {
        let unknown = |floor: &f64| Variance {
            value: *floor,
            freedom: 0.0,
        };
        return floors.iter().map(unknown).collect();
    };
    let posterior = |(s, floor): (&Statistics, &f64)| {
        let own = if s.sd.is_nan() {
            0.0
        } else {
            (s.count as f64 - 1.0).max(0.0)
        };
        let shared = if samples.len() > 1 {
            prior.freedom.max(LEAST_FREEDOM - own)
        } else {
            prior.freedom
        };
        let freedom = own + shared;
        let sum = own * s.sd.powi(2).max(*floor) + shared * prior.value;
        // A single value has no deviation: NaN times nothing.
        let sum = if own > 0.0 { sum } else { shared * prior.value };
        Variance {
            value: if freedom > 0.0 {
                (sum / freedom).max(*floor)
            } else {
                prior.value.max(*floor)
            },
            freedom: freedom.max(1.0),
        }
    };
    runs.iter().zip(floors).map(posterior).collect()
}

/// Common distribution of the runs' variances: scaled inverse χ², by the moments of their logarithms.
fn prior(samples: &[(f64, f64)]) -> Option<Variance> {
    let count = samples.len() as f64;
    let logs: Vec<f64> = samples
        .iter()
        .filter(|(value, _)| *value > 0.0)
        .map(|(value, freedom)| value.ln() - digamma(freedom / 2.0) + (freedom / 2.0).ln())
        .collect();
    if logs.is_empty() {
        return None;
    }
    let mean = logs.iter().sum::<f64>() / count;
    let spread = logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    let expected = samples.iter().map(|(_, f)| trigamma(f / 2.0)).sum::<f64>() / count;
    let freedom = if logs.len() < 2 {
        0.0
    } else {
        inverse_trigamma(spread - expected).map_or(MOST_FREEDOM, |half| 2.0 * half)
    };
    let shift = if freedom > 0.0 {
        digamma(freedom / 2.0) - (freedom / 2.0).ln()
    } else {
        0.0
    };
    Some(Variance {
        value: (mean + shift).exp(),
        freedom: freedom.min(MOST_FREEDOM),
    })
}

/// ψ′(x) for x > 0, by its recurrence and asymptotic series.
fn trigamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    for _ in 0..10 {
        if x >= 10.0 {
            break;
        }
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    sum + 1.0 / x + y / 2.0 + y / x * (1.0 / 6.0 - y * (1.0 / 30.0 - y / 42.0))
}

/// The x at which ψ′(x) = value; `None` for a value that only infinity reaches. Newton's method on 1/ψ′, which is convex.
fn inverse_trigamma(value: f64) -> Option<f64> {
    if value < 1.0 / MOST_FREEDOM {
        return None;
    }
    let mut x = 0.5 + 1.0 / value;
    for _ in 0..60 {
        let at = trigamma(x);
        let slope = (trigamma(x * (1.0 + 1e-5)) - trigamma(x * (1.0 - 1e-5))) / (2e-5 * x);
        let step = at * (1.0 - at / value) / slope;
        x += step;
        if (step / x).abs() < 1e-10 {
            break;
        }
    }
    (x > 0.0).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statistics(values: &[f64]) -> Statistics {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        Statistics {
            mean,
            sd: (squares / (n - 1.0)).sqrt(),
            se: 0.0,
            lag1: 0.0,
            count: values.len(),
        }
    }

    #[test]
    fn trigamma_and_its_inverse() {
        let pi = std::f64::consts::PI;
        assert!((trigamma(1.0) - pi * pi / 6.0).abs() < 1e-9);
        assert!((trigamma(0.5) - pi * pi / 2.0).abs() < 1e-9);
        for x in [0.3, 1.0, 7.0, 200.0] {
            assert!(
                (inverse_trigamma(trigamma(x)).unwrap() / x - 1.0).abs() < 1e-6,
                "{x}"
            );
        }
        assert!(inverse_trigamma(-0.1).is_none());
    }

    #[test]
    fn alike_variances_are_pooled_and_unlike_ones_are_not() {
        let alike: Vec<Statistics> = (0..6)
            .map(|i| statistics(&[1.0, 2.0 + 0.01 * f64::from(i), 3.0, 4.0]))
            .collect();
        let pooled = moderated(&alike, &[1e-18; 6]);
        assert!(pooled.iter().all(|v| v.freedom > 100.0), "{pooled:?}");
        let unlike: Vec<Statistics> = (0..6)
            .map(|i| {
                let scale = 10_f64.powi(i);
                statistics(&[1.0, 1.0 + scale, 1.0 - scale, 1.0 + 2.0 * scale])
            })
            .collect();
        let own = moderated(&unlike, &[1e-18; 6]);
        assert!(own.iter().all(|v| v.freedom < 6.0), "{own:?}");
        assert!(own[5].value > 1e6 * own[0].value);
    }

    /// Two cycles that agree to the last digit weigh no more than the cameras' noise and the other runs allow.
    #[test]
    fn cycles_that_agree_by_chance_do_not_make_a_value_certain() {
        let runs: Vec<[Statistics; QUANTITIES]> = [0.0, 1e-9, 2e-4, 3e-4]
            .iter()
            .map(|apart| [statistics(&[0.01, 0.01 + apart]); QUANTITIES])
            .collect();
        let errors = RunErrors {
            noise: [1e-10; QUANTITIES],
            ..RunErrors::default()
        };
        let found = within_runs(&runs, &[errors; 4]);
        for run in &found {
            for variance in run {
                assert!(variance.value > 4e-11, "{variance:?}");
                assert!(variance.freedom >= LEAST_FREEDOM, "{variance:?}");
            }
        }
        let ratio = found[3][0].value / found[0][0].value;
        assert!(ratio < 100.0, "{ratio}");
    }

    /// Two cycles have one step: its variance follows from the noise and from what the amplitudes scatter beyond theirs.
    #[test]
    fn a_single_step_scatters_as_amplitudes_do() {
        let mut run = [statistics(&[0.01, 0.0102]); QUANTITIES];
        run[0] = Statistics {
            sd: f64::NAN,
            se: f64::NAN,
            count: 1,
            ..run[0]
        };
        let errors = RunErrors {
            noise: [1e-9; QUANTITIES],
            ..RunErrors::default()
        };
        let found = within_runs(&[run; 3], &[errors; 3]);
        assert!(found[0][0].is_known(), "{:?}", found[0][0]);
        // Noise and excess are alike, but the amplitude is a mean of two cycles.
        let ratio = found[0][0].value / found[0][1].value;
        assert!((ratio - 2.0).abs() < 1e-9, "{ratio}");
        // Without noise nothing is known of it.
        let unknown = within_runs(&[run; 3], &[RunErrors::default(); 3]);
        assert!(!unknown[0][0].is_known() && unknown[0][1].is_known());
    }

    #[test]
    fn a_common_lag_is_found_without_the_bias_of_the_mean() {
        let run = |lag1: f64| Statistics {
            lag1,
            ..statistics(&[1.0, 2.0, 3.0, 2.0, 1.0])
        };
        assert!(common_lag(&[run(-0.2), run(-0.2)]).abs() < 1e-12);
        assert!((common_lag(&[run(-0.7), run(-0.5)]) + 0.4).abs() < 1e-12);
    }
}
