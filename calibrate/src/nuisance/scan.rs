//! Scan for a dead band or a servo gain that the swimmer file does not state, after every fit: first by one difference, and only
//! if that favours another value by refitting. Both reduce the larger gaits, so the warning also names the explanation that is
//! nearly as good.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::begin;
use crate::fit::parameter::Parameter;
use crate::fit::run_model::RunModel;
use crate::fit::run_values::RunValues;
use crate::fit::{CampaignFit, FitWarning};
use crate::golden::golden;
use crate::least_squares::{Model as _, weighted};
use crate::quantities::QUANTITIES;

/// Range and grid of the scan for one parameter. The golden section then refines the best value (dead bands to a twentieth of a
/// degree).
struct Scan {
    parameter: Parameter,
    first_look: f64,
    tried: &'static [f64],
}

const SCANS: [Scan; 2] = [
    Scan {
        parameter: Parameter::DeadBand,
        first_look: 0.03,
        tried: &[0.0, 0.02, 0.05, 0.09, 0.14, 0.21],
    },
    Scan {
        parameter: Parameter::Gain,
        first_look: -0.01,
        tried: &[-0.12, -0.07, -0.035, -0.015, 0.0, 0.015, 0.035, 0.07],
    },
];

/// Significance at which refitting is worth while, and at which the result is reported. The test weighs all values equally,
/// which they are not: at a nominal 1e-3 one of 98 faultless campaigns was suspected.
const WORTH_WHILE: f64 = 0.05;
const CHANCE: f64 = 1e-4;
/// Looks of the golden section.
const REFINEMENTS: usize = 9;
/// Corrections of r_s and χ at each value.
const CORRECTIONS: usize = 2;
/// Log-likelihoods that differ by less than this do not distinguish two explanations.
pub(crate) const ALIKE: f64 = 2.0;

/// A better explanation of the runs.
struct Find {
    parameter: Parameter,
    known: f64,
    value: f64,
    /// Growth of the log-likelihood.
    gain: f64,
}

/// The warning, if there is reason for one.
pub(crate) fn noticed(found: &CampaignFit) -> Option<FitWarning> {
    // Three parameters leave nothing of one run.
    if found.runs.len() < 3 {
        return None;
    }
    let values = found.values().ok()?;
    let plain = vec![Parameter::SphereRadius, Parameter::Chi];
    let plain = found.model(&values, plain).ok()?;
    let mut finds: Vec<Find> = SCANS
        .iter()
        .filter(|scan| plain.has_use_for(scan.parameter))
        .filter_map(|scan| scan.find(&plain, &values, found))
        .collect();
    finds.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let best = finds.first()?;
    let rival = finds.get(1).filter(|other| best.gain - other.gain < ALIKE);
    let rival = rival.map(|other| (other.parameter.name(), other.gain));
    let (known, found, gain) = (best.known, best.value, best.gain);
    Some(if best.parameter == Parameter::DeadBand {
        FitWarning::DeadBand {
            known,
            found,
            gain,
            rival,
        }
    } else {
        FitWarning::Gain {
            found: 1.0 + found,
            gain,
            rival,
        }
    })
}

impl Scan {
    fn find(&self, plain: &RunModel, values: &RunValues, found: &CampaignFit) -> Option<Find> {
        let model = plain.with([plain.parameters.as_slice(), &[self.parameter]].concat());
        let begun = begin(&model, found);
        let search = Search {
            model: &model,
            values,
            jacobian: plain.jacobian(&begun[..2])?,
            begun: &begun,
        };
        let known = search.at(begun[2])?;
        let ahead = search.at(begun[2] + self.first_look)?;
        let slopes = ahead.iter().zip(&known);
        let line: Vec<f64> = slopes.map(|(a, k)| (a - k) / self.first_look).collect();
        if search.chance(&known, &search.along(&known, &line)) > WORTH_WHILE {
            return None;
        }
        let score = |value: f64| -> f64 {
            let residuals = search.at(value);
            residuals.map_or(f64::INFINITY, |residuals| search.misfit(&residuals))
        };
        let scores: Vec<f64> = self.tried.iter().map(|value| score(*value)).collect();
        let best = (0..scores.len()).min_by(|a, b| scores[*a].total_cmp(&scores[*b]))?;
        let from = self.tried[best.saturating_sub(1)];
        let to = self.tried[(best + 1).min(self.tried.len() - 1)];
        let value = golden(from, to, REFINEMENTS, score).0;
        let residuals = search.at(value)?;
        (search.chance(&known, &residuals) < CHANCE).then(|| Find {
            parameter: self.parameter,
            known: begun[2],
            value,
            gain: (search.misfit(&known) - search.misfit(&residuals)) / 2.0,
        })
    }
}

struct Search<'a> {
    model: &'a RunModel,
    values: &'a RunValues,
    /// By r_s/L and ln χ.
    jacobian: DMatrix<f64>,
    begun: &'a [f64],
}

impl Search<'_> {
    /// Residuals with the parameter at this value and r_s and χ refitted.
    fn at(&self, value: f64) -> Option<Vec<f64>> {
        let mut z = self.begun.to_vec();
        z[2] = value;
        let look = |z: &[f64]| -> Option<Vec<f64>> {
            let values = self.model.values(z)?;
            let left = values.iter().zip(&self.values.values);
            Some(left.map(|(a, b)| a - b).collect())
        };
        let mut residuals = look(&z)?;
        for _ in 0..CORRECTIONS {
            let squares = self.squares(&residuals);
            let weights = self.values.weights(|row| squares[row % QUANTITIES]);
            let weighted = weighted(&self.jacobian, &weights);
            let slope = weighted.tr_mul(&DVector::from_column_slice(&residuals));
            let step = weighted.tr_mul(&self.jacobian).lu().solve(&slope)?;
            z[0] = (z[0] - step[0]).max(0.0);
            z[1] -= step[1];
            residuals = look(&z)?;
        }
        Some(residuals)
    }

    /// The rows that count.
    fn rows(&self) -> impl Iterator<Item = usize> {
        let used = self.values.used.iter().enumerate();
        used.filter_map(|(row, used)| used.then_some(row))
    }

    /// Sum of squares of each quantity, never below what cycles explain; 0 of what does not count.
    fn squares(&self, residuals: &[f64]) -> [f64; QUANTITIES] {
        let mut sums = [0.0; QUANTITIES];
        for row in self.rows() {
            sums[row % QUANTITIES] += residuals[row].powi(2) + self.values.within[row].value;
        }
        sums
    }

    /// Minus twice the log-likelihood where each quantity has a variance of its own.
    fn misfit(&self, residuals: &[f64]) -> f64 {
        let mut counts = [0.0; QUANTITIES];
        for row in self.rows() {
            counts[row % QUANTITIES] += 1.0;
        }
        let sums = self.squares(residuals).into_iter().zip(counts);
        let counted = sums.filter(|(sum, _)| *sum > 0.0);
        counted.map(|(sum, count)| count * sum.ln()).sum()
    }

    /// Chance that one parameter more explains so much, if there is nothing to explain.
    fn chance(&self, known: &[f64], other: &[f64]) -> f64 {
        let values = self.values.count() as f64;
        let ratio = ((self.misfit(known) - self.misfit(other)) / values).exp();
        let freedom = values - 3.0;
        FisherSnedecor::new(1.0, freedom).map_or(1.0, |f| f.sf(((ratio - 1.0) * freedom).max(0.0)))
    }

    /// `residuals` at their minimum along a direction, with equal weight for each quantity.
    fn along(&self, residuals: &[f64], line: &[f64]) -> Vec<f64> {
        let mut squares = [0.0; QUANTITIES];
        for row in self.rows() {
            squares[row % QUANTITIES] += residuals[row].powi(2);
        }
        let (mut product, mut square) = (0.0, 0.0);
        for row in self.rows() {
            let weight = 1.0 / squares[row % QUANTITIES].max(1e-300);
            product += weight * residuals[row] * line[row];
            square += weight * line[row] * line[row];
        }
        let step = if square > 0.0 { product / square } else { 0.0 };
        let pairs = residuals.iter().zip(line);
        pairs.map(|(r, l)| r - step * l).collect()
    }
}
