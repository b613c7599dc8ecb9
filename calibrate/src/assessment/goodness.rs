//! Goodness of fit, compared with the scatter within the cycles. An error that all cycles share does not widen that scatter.

use serde::Serialize;

use super::Plain;
use super::repeats::{Repeats, repeats};
use super::systematics::Joint;
use crate::fit::CampaignFit;
use crate::fit::likelihood::Estimate;
use crate::least_squares::{Model as _, minimise};
use crate::quantities::{NAMES, QUANTITIES, TELLING, measured};
use crate::student;
use swimmer_model::Gait as _;

/// Signs of the residuals of one quantity, from the smallest gait to the largest.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignTest {
    /// X, ΔY or Δθ.
    pub quantity: &'static str,
    /// Signs of simulated minus measured, one per run.
    pub signs: Vec<i8>,
    /// Number of stretches of equal sign.
    pub stretches: usize,
    /// Probability of as few stretches or fewer with random signs.
    pub chance: f64,
}

/// Fit of one run by itself.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunGoodness {
    /// Y over X, and its standard error from the run's cycles; 0 for a symmetric gait.
    #[cfg_attr(feature = "schema", schemars(with = "[Option<f64>; 2]"))]
    pub y_over_x: [f64; 2],
    /// Probability of a Y as far from the model's or farther; the model has the servos of the swimmer file (Student's t).
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub y_chance: f64,
    /// Net turn of a cycle \[rad\], and its standard error from the run's cycles; 0 for a symmetric gait.
    #[cfg_attr(feature = "schema", schemars(with = "[Option<f64>; 2]"))]
    pub turn_rad: [f64; 2],
    /// Probability of a turn as far from the model's or farther.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub turn_chance: f64,
    /// Velocity along and across the heading that would explain X and Y beyond the model \[m/s\].
    #[cfg_attr(feature = "schema", schemars(with = "[Option<f64>; 2]"))]
    pub drift_m_per_s: [f64; 2],
    /// Ratio of lengths to those predicted from the other runs, and its standard error: a wall reduces it.
    pub scale: Option<[f64; 2]>,
}

/// Goodness of fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Goodness {
    /// χ² of X, ΔY and Δθ by the cycles' own scatter, over the degrees of freedom; `None` if cycles show no scatter.
    pub reduced_chi2: Option<f64>,
    /// Values less parameters.
    pub freedom: usize,
    /// The signs of what the likeliest r_s and χ leave.
    pub signs: Vec<SignTest>,
    /// Run by run.
    pub runs: Vec<RunGoodness>,
    /// Y and net turn that all runs have and the model with systematic errors does not.
    pub common: Vec<CommonDeviation>,
    /// Runs that repeat a gait.
    pub repeats: Vec<Repeats>,
    /// The largest misfit of ΔY and Δθ, which no drift of the fluid explains; `None` if the scatter explains all.
    pub misfit: Option<Misfit>,
}

/// Deviations from run to run that neither scatter nor systematic errors explain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Misfit {
    /// `ΔY` or `Δθ`.
    pub quantity: &'static str,
    /// Their standard deviation over the largest value.
    pub share: f64,
    /// The same over the scatter within runs.
    pub ratio: f64,
}

/// A mean over the runs of what the model leaves, tested against their own scatter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CommonDeviation {
    /// `Y/X` or `net turn`.
    pub quantity: &'static str,
    /// Measured less predicted: a share, or rad.
    pub mean: f64,
    /// Its standard error, by the runs' scatter.
    pub error: f64,
    /// Probability of such a mean if runs had neither (Student's t).
    pub chance: f64,
}

/// Points of a gait at which its size is looked for.
const POINTS: usize = 64;

pub(super) fn goodness(found: &CampaignFit, plain: &Plain, joint: Option<&Joint>) -> Goodness {
    let data = plain.data.without(|row| row % QUANTITIES >= TELLING);
    let has_errors = data.has_errors();
    let weights = data.weights(|row| data.within[row].value);
    let (model, at) = (&plain.model, &plain.telling.at);
    let end = minimise(model, &data.values, &weights, at, &model.bounds());
    let freedom = data.count().saturating_sub(2);
    let sizes: Vec<f64> = found
        .runs
        .iter()
        .map(|run| {
            let points = (0..POINTS).map(|i| run.played.gait.at(i as f64 / POINTS as f64));
            points.map(|point| point.phi.norm()).fold(0.0, f64::max)
        })
        .collect();
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|a, b| sizes[*a].total_cmp(&sizes[*b]));
    Goodness {
        reduced_chi2: end
            .filter(|_| has_errors && freedom > 0)
            .map(|end| end.cost / freedom as f64),
        freedom,
        signs: (0..TELLING)
            .map(|q| {
                let row = |run: &usize| QUANTITIES * run + q;
                let there = order
                    .iter()
                    .map(row)
                    .filter(|row| plain.data.is_there(*row));
                signs(NAMES[q], there.map(|row| plain.telling.residuals[row]))
            })
            .collect(),
        runs: (0..sizes.len())
            .map(|run| of_run(found, plain, joint, run))
            .collect(),
        common: [(3, "Y/X"), (4, "net turn")]
            .into_iter()
            .filter_map(|(q, name)| common(plain, joint, q, name))
            .collect(),
        repeats: repeats(found, plain),
        misfit: joint.and_then(misfit),
    }
}

/// Deviations of ΔY and Δθ over their scatter from which on they are a misfit.
const BEYOND_SCATTER: f64 = 3.0;

fn misfit(joint: &Joint) -> Option<Misfit> {
    let components = &joint.estimate.components;
    let of = |q: usize| {
        let rows = (q..components.within.len()).step_by(QUANTITIES);
        let rows = rows.filter(|row| joint.data.used[*row] && components.is_of_run(*row));
        let within: Vec<f64> = rows.map(|row| components.within[row].value).collect();
        let scatter = (within.iter().sum::<f64>() / within.len() as f64).sqrt();
        let share = components.between[q].sqrt();
        (share > BEYOND_SCATTER * scatter).then_some(Misfit {
            quantity: NAMES[q],
            share,
            ratio: share / scatter,
        })
    };
    let both = [of(1), of(2)].into_iter().flatten();
    both.max_by(|a, b| a.share.total_cmp(&b.share))
}

/// Fewest runs of which a common mean means anything.
const FEWEST_FOR_COMMON: usize = 4;

/// The mean over runs of Y (over X) or net turn beyond the model.
fn common(
    plain: &Plain,
    joint: Option<&Joint>,
    q: usize,
    quantity: &'static str,
) -> Option<CommonDeviation> {
    let estimate = joint.map_or(&plain.all, |joint| &joint.estimate);
    let data = &plain.data;
    let of_run = |run: usize| {
        let row = QUANTITIES * run + q;
        let per = if q == 3 {
            data.values[QUANTITIES * run]
        } else {
            1.0 / data.scales[q]
        };
        data.used[row].then(|| -estimate.residuals[row] / per)
    };
    let values: Vec<f64> = (0..data.values.len() / QUANTITIES)
        .filter_map(of_run)
        .filter(|value| value.is_finite())
        .collect();
    if values.len() < FEWEST_FOR_COMMON {
        return None;
    }
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares = values.iter().map(|value| (value - mean).powi(2));
    let error = (squares.sum::<f64>() / (count - 1.0) / count).sqrt();
    let chance = student::two_sided(count - 1.0, mean / error);
    Some(CommonDeviation {
        quantity,
        mean,
        error,
        chance,
    })
}

fn signs(quantity: &'static str, residuals: impl Iterator<Item = f64>) -> SignTest {
    let signs: Vec<i8> = residuals.map(|r| if r < 0.0 { -1 } else { 1 }).collect();
    let stretches = 1 + signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let up = signs.iter().filter(|sign| **sign > 0).count();
    SignTest {
        chance: chance_of_stretches(up, signs.len() - up, stretches),
        quantity,
        signs,
        stretches,
    }
}

/// Probability of at most this many stretches of one sign among all orders of `a` and `b` signs (runs test of Wald and Wolfowitz); of
/// equal signs if all agree.
fn chance_of_stretches(a: usize, b: usize, stretches: usize) -> f64 {
    if a == 0 || b == 0 {
        return (0.5_f64).powf((a + b) as f64 - 1.0).min(1.0);
    }
    let choose = |n: usize, k: usize| -> f64 {
        if k > n {
            return 0.0;
        }
        (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product()
    };
    let exactly = |r: usize| {
        let half = r / 2;
        if r.is_multiple_of(2) {
            2.0 * choose(a - 1, half - 1) * choose(b - 1, half - 1)
        } else {
            choose(a - 1, half - 1) * choose(b - 1, half)
                + choose(a - 1, half) * choose(b - 1, half - 1)
        }
    };
    let sum: f64 = (2..=stretches).map(exactly).sum();
    (sum / choose(a + b, a)).min(1.0)
}

fn of_run(found: &CampaignFit, plain: &Plain, joint: Option<&Joint>, run: usize) -> RunGoodness {
    let estimate = joint.map_or(&plain.all, |joint| &joint.estimate);
    let result = &found.runs[run];
    let row = |q: usize| QUANTITIES * run + q;
    let scale = |q: usize| plain.data.scales[q];
    let there = |q: usize, value: f64| {
        if plain.data.is_there(row(q)) {
            value
        } else {
            f64::NAN
        }
    };
    let data = &plain.data;
    // Predicted less measured of this run by itself.
    let left = |residuals: &[f64], q: usize| {
        let row = row(q);
        (residuals[row] + data.values[row] - data.own[row]) * scale(q)
    };
    let value = |q: usize| there(q, data.own[row(q)] * scale(q));
    let error = |q: usize| {
        let within = data.own_within[row(q)];
        if within.is_known() {
            within.value.sqrt() * scale(q)
        } else {
            f64::NAN
        }
    };
    let chance = |q: usize| {
        let freedom = data.own_within[row(q)].freedom.max(1.0);
        let t = there(q, left(&plain.all.residuals, q) / error(q)).abs();
        if !t.is_finite() {
            // Missing, or of one cycle, which shows no scatter.
            return f64::NAN;
        }
        student::two_sided(freedom, t)
    };
    let beyond = |q: usize| there(q, -left(&estimate.residuals, q) / result.cycles.period_s);
    let [x, .., turn] = measured(&result.cycles).map(|statistics| statistics.mean);
    RunGoodness {
        y_over_x: [value(3) / x, (error(3) / x).abs()],
        y_chance: chance(3),
        turn_rad: [turn, error(4)],
        turn_chance: chance(4),
        drift_m_per_s: [beyond(0), beyond(3)],
        scale: joint.and_then(|joint| length_scale(joint, run)),
    }
}

/// Ratio of a run's X and ΔY to those predicted from the other runs.
fn length_scale(joint: &Joint, run: usize) -> Option<[f64; 2]> {
    let rows: Vec<usize> = [0, 1].map(|q| QUANTITIES * run + q).into();
    let rows: Vec<usize> = rows
        .into_iter()
        .filter(|row| joint.data.used[*row])
        .collect();
    let without = joint
        .data
        .without(|row| row / QUANTITIES == run && row % QUANTITIES < 2);
    let weights = without.weights(|row| joint.estimate.components.variance(row));
    let rest = Estimate::of_weighted(&joint.tangent, &without, &joint.estimate.at, weights)?;
    let covariance = rest.components.covariance();
    let (mut product, mut square) = (0.0, 0.0);
    for row in rows {
        let gradient = rest.jacobian.row(row);
        let of_prediction = (gradient * &covariance * gradient.transpose())[(0, 0)];
        let weight = 1.0 / (of_prediction + rest.components.variance(row));
        let measured = joint.data.values[row];
        let predicted = measured + rest.residuals[row];
        product += weight * measured * predicted;
        square += weight * predicted * predicted;
    }
    (square > 0.0).then(|| [product / square, 1.0 / square.sqrt()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_of_signs() {
        // All orders of three and three, counted by hand: 20, of which 2 have two stretches and 4 three.
        assert!((chance_of_stretches(3, 3, 2) - 0.1).abs() < 1e-12);
        assert!((chance_of_stretches(3, 3, 3) - 0.3).abs() < 1e-12);
        assert!((chance_of_stretches(3, 3, 6) - 1.0).abs() < 1e-12);
        assert!((chance_of_stretches(6, 0, 1) - 2.0 / 64.0).abs() < 1e-12);
        let found = signs("X", [1.0, 2.0, -1.0, -3.0].into_iter());
        assert_eq!((found.stretches, found.signs), (2, vec![1, 1, -1, -1]));
    }
}
