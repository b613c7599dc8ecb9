//! Estimate of r_s and χ in which parameters with a prior vary within it: one likelihood of the runs and of the priors of gains,
//! places and scales. If the runs determine a parameter better than its prior, they prevail; the contradiction is given in standard
//! deviations of the prior.

use serde::Serialize;

use super::Plain;
use super::known::Known;
use super::modes::{JointProblem, Mode, evidence};
use crate::evidence::Pair;
use crate::fit::Intervals;
use crate::fit::intervals::half_width;
use crate::fit::likelihood::Estimate;
use crate::fit::parameter::Parameter;
use crate::fit::prior::Prior;
use crate::fit::run_values::RunValues;
use crate::fit::tangent::Tangent;
use crate::least_squares::{Model as _, minimise};
use crate::quantities::{NAMES, QUANTITIES};

/// Errors without a prior, with their plausible sizes (rad, ln, s), tried in addition to the priors. One is included if it makes
/// the runs twenty times likelier (ln of odds), as such errors are rare, and if it is at least [`TELLING_DEVIATIONS`] standard
/// deviations from zero. Above higher odds it counts as certain.
const UNFORESEEN: [(Parameter, f64); 5] = [
    (Parameter::DeadBand, 5.0 * std::f64::consts::PI / 180.0),
    (Parameter::TangentialDrag, 0.3),
    (Parameter::FrontLag, 0.1),
    (
        Parameter::DeadBandDifference,
        3.0 * std::f64::consts::PI / 180.0,
    ),
    (Parameter::FloatTurning, 0.4),
];
const LEAST_ODDS: f64 = 3.0;
pub(super) const CERTAIN_ODDS: f64 = 7.0;
const TELLING_DEVIATIONS: f64 = 3.0;
/// Tolerance of the odds along the model's tangent.
const TANGENTS_ERROR: f64 = 7.0;
/// Least share of what is known that the runs must add before their pull means anything.
const LEAST_SAID: f64 = 0.02;

/// Estimate of a parameter with a prior.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Nuisance {
    /// Its name.
    pub name: &'static str,
    /// m, rad, or nothing.
    pub unit: &'static str,
    /// Prior: value and standard deviation.
    pub known: [f64; 2],
    /// `true` if the campaign states the prior.
    pub stated: bool,
    /// Estimate and its standard deviation.
    pub found: [f64; 2],
    /// Contradiction of the prior by the runs alone, in standard deviations of the difference.
    pub pull: f64,
}

/// Error without a prior that the runs require.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Unforeseen {
    /// Its name.
    pub name: &'static str,
    /// m, rad, or nothing.
    pub unit: &'static str,
    /// Estimate.
    pub value: f64,
    /// Growth of the log-likelihood.
    pub gain: f64,
    /// ln of the odds of the runs with and without it, each optimum with its neighbourhood.
    pub log_odds: f64,
    /// Remedy.
    pub remedy: &'static str,
}

/// The estimate with systematic errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Systematics {
    /// r_s and χ.
    pub estimate: Pair,
    /// Their intervals.
    pub intervals: Intervals,
    /// Estimates of the parameters with a prior.
    pub nuisances: Vec<Nuisance>,
    /// A better explanation of the runs.
    pub unforeseen: Vec<Unforeseen>,
    /// Values that were left out: run, and the quantity's name.
    pub outliers: Vec<(usize, &'static str)>,
    /// χ² of the runs' values and of what is known, against the cycles' own scatter, over the degrees of freedom.
    pub reduced_chi2: Option<f64>,
}

/// The joint likelihood's optimum.
pub(super) struct Joint {
    known: Vec<Known>,
    /// r_s, χ, the parameters with a prior, and errors without one.
    pub(super) parameters: Vec<Parameter>,
    /// Index of the first prior among the values.
    first: usize,
    pub(super) data: RunValues,
    pub(super) estimate: Estimate,
    pub(super) tangent: Tangent,
    outliers: Vec<usize>,
    /// Error without a prior, last among the parameters.
    unforeseen: Option<Unforeseen>,
}

/// Remedy for an error without a prior.
fn remedy(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::DeadBand => {
            "fit it by --fit-also deadband, then say so by [servo] dead_band in the swimmer file"
        }
        Parameter::FrontLag => {
            "command both servos at once, or let reflectors on the side links show the angles ([reflectors] front_link)"
        }
        Parameter::DeadBandDifference => {
            "exchange a servo, or let reflectors on the side links show the angles ([reflectors] front_link)"
        }
        Parameter::FloatTurning => {
            "a float that is no sphere, or walls near by; fit it by --fit-also float, then state float_turning under [known]"
        }
        _ => "fit it by --fit-also ct, then say so in the swimmer file",
    }
}

impl Joint {
    /// The likeliest modes with all priors, and with one error without a prior if the runs require it; then without outliers.
    pub(super) fn of(plain: &Plain, known: &[Known]) -> Option<Self> {
        let problem = JointProblem::new(plain, known, None);
        let tangent = problem.tangent()?;
        let foreseen = problem.mode(f64::NEG_INFINITY, &tangent)?;
        let least = evidence(&foreseen.estimate) + LEAST_ODDS;
        let enough = |mode: &Mode| evidence(&mode.estimate) > least;
        let has_no_prior = |parameter: Parameter| {
            let knows = |known: &Known| known.prior.parameter == parameter;
            plain.model.has_use_for(parameter) && !known.iter().any(knows)
        };
        let more = UNFORESEEN
            .iter()
            .filter(|(parameter, _)| has_no_prior(*parameter));
        let more = more.filter_map(|(parameter, width)| {
            let prior = Prior {
                parameter: *parameter,
                value: plain.value_in_files(*parameter),
                width: *width,
            };
            let problem = JointProblem::new(plain, known, Some(prior));
            let tangent = problem.tangent_beyond(&tangent)?;
            let mode = problem
                .mode(least - TANGENTS_ERROR, &tangent)
                .filter(enough)?;
            let place = mode.estimate.at.len() - 1;
            let deviation = mode.estimate.components.covariance()[(place, place)].sqrt();
            let value = mode.estimate.at[place];
            let is_significant = (value - prior.value).abs() > TELLING_DEVIATIONS * deviation;
            let unforeseen = Unforeseen {
                name: parameter.name(),
                unit: parameter.unit(),
                value: plain.model.natural(*parameter, value),
                gain: mode.estimate.log_likelihood - foreseen.estimate.log_likelihood,
                log_odds: evidence(&mode.estimate) - evidence(&foreseen.estimate),
                remedy: remedy(*parameter),
            };
            is_significant.then_some((problem, mode, unforeseen))
        });
        let best = more.max_by(|a, b| evidence(&a.1.estimate).total_cmp(&evidence(&b.1.estimate)));
        let (problem, mode, unforeseen) = match best {
            Some((problem, mode, unforeseen)) => (problem, mode, Some(unforeseen)),
            None => (problem, foreseen, None),
        };
        let (mode, outliers) = problem.without_outliers(mode)?;
        Some(Self {
            known: known.to_vec(),
            parameters: problem.parameters().to_vec(),
            first: problem.first,
            data: mode.data,
            estimate: mode.estimate,
            tangent: mode.tangent,
            outliers,
            unforeseen,
        })
    }

    /// Estimate, intervals at this level, and nuisance parameters.
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
            // Separates the estimate of the runs alone from the estimate of runs and prior together.
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
            unforeseen: self.unforeseen.into_iter().collect(),
            outliers: self
                .outliers
                .iter()
                .map(|row| (row / QUANTITIES, NAMES[row % QUANTITIES]))
                .collect(),
            reduced_chi2: self.reduced_chi2(plain.data.values.len()),
        })
    }

    fn reduced_chi2(&self, measured: usize) -> Option<f64> {
        let Self { data, tangent, .. } = self;
        let weights = data.weights(|row| data.within[row].value);
        let has_errors = data.has_errors();
        let end = minimise(
            tangent,
            &data.values,
            &weights,
            &self.estimate.at,
            &tangent.bounds(),
        )?;
        let count = data.used[..measured].iter().filter(|used| **used).count();
        (has_errors && count > 2).then(|| end.cost / (count - 2) as f64)
    }
}
