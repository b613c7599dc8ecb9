//! r_s and χ where everything that is known by halves may move as far as it is known: the runs and what is known of gains, places
//! and scales beforehand, weighed in one likelihood. Where the runs know better, they are believed; how far they then contradict
//! what was known is told in widths.

use serde::Serialize;

use super::Plain;
use super::known::Known;
use crate::evidence::Pair;
use crate::fit::Intervals;
use crate::fit::intervals::half_width;
use crate::fit::least_squares::{Model as _, minimise};
use crate::fit::likelihood::Estimate;
use crate::fit::outliers;
use crate::fit::parameter::Parameter;
use crate::fit::prior::{Prior, WithPriors};
use crate::fit::run_values::{QUANTITIES, RunValues};
use crate::fit::tangent::Tangent;

/// Of how many values one may be left out as unlike the others.
const VALUES_FOR_ONE: usize = 8;
/// What no file knows, and is tried beside all that is known: growth of the log-likelihood from which on it is told, and in how
/// many standard deviations of its own.
const UNFORESEEN: [Parameter; 2] = [Parameter::DeadBand, Parameter::TangentialDrag];
const TELLING_GROWTH: f64 = 10.0;
const TELLING_DEVIATIONS: f64 = 4.0;
/// Least share of what is known that the runs must add before their pull means anything.
const LEAST_SAID: f64 = 0.02;
/// From so many standard deviations on, what contradicts the runs is believed as much less as it is further off, in so many rounds.
const BELIEVED: f64 = 1.5;
const DOUBTS: usize = 3;

/// What the runs make of something that is known by halves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Nuisance {
    /// Its name.
    pub name: &'static str,
    /// m, rad, or nothing.
    pub unit: &'static str,
    /// What is known: the value, and its standard deviation.
    pub known: [f64; 2],
    /// Whether the campaign states it.
    pub stated: bool,
    /// What came out, and its standard deviation.
    pub found: [f64; 2],
    /// How far the runs alone contradict what is known, in standard deviations of that difference.
    pub pull: f64,
}

/// What nobody knew of, and the runs ask for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Unforeseen {
    /// Its name.
    pub name: &'static str,
    /// m, rad, or nothing.
    pub unit: &'static str,
    /// What came out.
    pub value: f64,
    /// Growth of the log-likelihood.
    pub gain: f64,
}

/// The estimate with systematic errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Systematics {
    /// r_s and χ.
    pub estimate: Pair,
    /// Their intervals.
    pub intervals: Intervals,
    /// What else moved.
    pub nuisances: Vec<Nuisance>,
    /// What explains the runs better still.
    pub unforeseen: Vec<Unforeseen>,
    /// Values that were left out: run, and the quantity's name.
    pub outliers: Vec<(usize, &'static str)>,
    /// χ² of the runs' values and of what is known, against the cycles' own scatter, over the degrees of freedom.
    pub reduced_chi2: Option<f64>,
}

/// The joint likelihood's optimum.
pub(super) struct Joint {
    known: Vec<Known>,
    /// Where what is known stands among the values.
    first: usize,
    pub(super) data: RunValues,
    pub(super) estimate: Estimate,
    pub(super) tangent: Tangent,
    outliers: Vec<usize>,
}

impl Joint {
    /// Found from two sides: from the runs alone, and from what is known, where what contradicts it is scatter from run to run.
    pub(super) fn of(plain: &Plain, known: &[Known]) -> Option<Self> {
        let parameters: Vec<Parameter> = known.iter().map(|known| known.prior.parameter).collect();
        let values: Vec<f64> = known.iter().map(|known| known.prior.value).collect();
        let (mut estimate, mut tangent, mut data) = fit(plain, known, &parameters, &values)?;
        let mut left_out = Vec::new();
        while left_out.len() < plain.data.count() / VALUES_FOR_ONE {
            let Estimate {
                jacobian,
                weights,
                residuals,
                ..
            } = &estimate;
            let Some(worst) = outliers::worst(jacobian, weights, residuals, &data.within) else {
                break;
            };
            let without = data.without(|row| row == worst.row);
            let weights = without.weights(|row| estimate.components.variance(row));
            let Some(next) = Estimate::of_weighted(&tangent, &without, &estimate.at, weights)
            else {
                break;
            };
            left_out.push(worst.row);
            (estimate, data) = (next, without);
        }
        let first = plain.data.values.len();
        let (model, _) = plain.with(&parameters, &values);
        let priors: Vec<Prior> = known.iter().map(|known| known.prior).collect();
        let (model, _) = WithPriors::new(&model, &plain.data, &priors);
        for _ in 0..DOUBTS {
            if !doubt(&mut data, &priors, &estimate.at, first) && left_out.is_empty() {
                break;
            }
            let weights = data.weights(|row| estimate.components.variance(row));
            (estimate, tangent) = Tangent::estimate(&model, &data, &estimate.at, &weights)?;
        }
        Some(Self {
            known: known.to_vec(),
            first,
            data,
            estimate,
            tangent,
            outliers: left_out,
        })
    }

    /// What it says.
    pub(super) fn systematics(&self, plain: &Plain, level: f64) -> Option<Systematics> {
        let length = plain.length();
        let Estimate { at, components, .. } = &self.estimate;
        let covariance = components.covariance();
        let half = |i: usize| half_width(components.of_parameter(i), level);
        let centre = [at[0], at[1]];
        let nuisance = |(index, known): (usize, &Known)| {
            let (place, prior) = (2 + index, known.prior);
            let swimmer = &plain.model.start.swimmer;
            let natural = |value: f64| prior.parameter.natural(value, swimmer);
            let per = |width: f64| natural(prior.value + width) - natural(prior.value);
            let variance = covariance[(place, place)];
            // What the runs say by themselves follows from what both say together.
            let believed = self.data.within[self.first + index].value;
            let share = (1.0 - variance / believed).max(LEAST_SAID);
            let by_runs = (at[place] - prior.value) / share;
            let of_runs = believed * (1.0 - share) / share;
            Nuisance {
                name: prior.parameter.name(),
                unit: prior.parameter.unit(),
                known: [natural(prior.value), per(prior.width)],
                stated: known.stated,
                found: [natural(at[place]), per(variance.sqrt())],
                pull: by_runs / (prior.width.powi(2) + of_runs).sqrt(),
            }
        };
        Some(Systematics {
            estimate: Pair {
                sphere_radius: at[0] * length,
                chi: at[1].exp(),
            },
            intervals: Intervals::about(centre, [half(0)?, half(1)?], length, level),
            nuisances: self.known.iter().enumerate().map(nuisance).collect(),
            unforeseen: self.unforeseen(plain),
            outliers: self
                .outliers
                .iter()
                .map(|row| {
                    (
                        row / QUANTITIES,
                        crate::fit::run_values::NAMES[row % QUANTITIES],
                    )
                })
                .collect(),
            reduced_chi2: self.reduced_chi2(plain.data.values.len()),
        })
    }

    fn unforeseen(&self, plain: &Plain) -> Vec<Unforeseen> {
        let try_one = |parameter: &Parameter| -> Option<Unforeseen> {
            if self
                .known
                .iter()
                .any(|known| known.prior.parameter == *parameter)
            {
                return None;
            }
            let mut parameters: Vec<Parameter> = self
                .known
                .iter()
                .map(|known| known.prior.parameter)
                .collect();
            parameters.push(*parameter);
            let values = self.estimate.at[2..].to_vec();
            let values = [values.as_slice(), &[plain.filed(*parameter)]].concat();
            let (model, _) = plain.with(&parameters, &values);
            let priors: Vec<Prior> = self.known.iter().map(|known| known.prior).collect();
            let (model, _) = WithPriors::new(&model, &plain.data, &priors);
            let start = [&self.estimate.at[..2], &values].concat();
            let weights = &self.estimate.weights;
            let (estimate, _) = Tangent::estimate(&model, &self.data, &start, weights)?;
            let place = estimate.at.len() - 1;
            let deviation = estimate.components.covariance()[(place, place)].sqrt();
            let moved = (estimate.at[place] - plain.filed(*parameter)).abs();
            let gain = estimate.log_likelihood - self.estimate.log_likelihood;
            let told = gain > TELLING_GROWTH && moved > TELLING_DEVIATIONS * deviation;
            told.then(|| Unforeseen {
                name: parameter.name(),
                unit: parameter.unit(),
                value: plain.model.natural(*parameter, estimate.at[place]),
                gain,
            })
        };
        UNFORESEEN.iter().filter_map(try_one).collect()
    }

    fn reduced_chi2(&self, measured: usize) -> Option<f64> {
        let Self { data, tangent, .. } = self;
        let weights = data.weights(|row| data.within[row].value);
        let told = data.within[..measured]
            .iter()
            .all(|within| within.freedom > 0.0);
        let end = minimise(
            tangent,
            &data.values,
            &weights,
            &self.estimate.at,
            &tangent.bounds(),
        )?;
        let count = data.used[..measured].iter().filter(|used| **used).count();
        (told && count > 2).then(|| end.cost / (count - 2) as f64)
    }
}

/// Widens what is known by as much as the runs contradict it, so that it does not draw the answer with it; whether anything is.
fn doubt(data: &mut RunValues, priors: &[Prior], at: &[f64], first: usize) -> bool {
    let mut doubted = false;
    for (index, prior) in priors.iter().enumerate() {
        let off = (at[2 + index] - prior.value).abs() / prior.width;
        let wider = (off / BELIEVED).max(1.0);
        doubted |= wider > 1.0;
        data.within[first + index].value = (wider * prior.width).powi(2);
    }
    doubted
}

/// From two sides, the likelier one.
fn fit(
    plain: &Plain,
    known: &[Known],
    parameters: &[Parameter],
    values: &[f64],
) -> Option<(Estimate, Tangent, RunValues)> {
    let (model, start) = plain.with(parameters, values);
    let priors: Vec<Prior> = known.iter().map(|known| known.prior).collect();
    let (model, data) = WithPriors::new(&model, &plain.data, &priors);
    let measured = plain.data.values.len();
    let scattered = data.weights(|row| {
        if row < measured {
            plain.all.components.variance(row)
        } else {
            data.within[row].value
        }
    });
    let even = data.weights(|_| 1.0);
    let sides = [scattered, even];
    let found = sides
        .iter()
        .filter_map(|weights| Tangent::estimate(&model, &data, &start, weights));
    let best = found.max_by(|a, b| a.0.log_likelihood.total_cmp(&b.0.log_likelihood));
    best.map(|(estimate, tangent)| (estimate, tangent, data))
}
