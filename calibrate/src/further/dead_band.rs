//! Is there a dead band that the swimmer file does not know? Looked for after every fit: first by one difference, and only
//! where that speaks for another dead band, by following it.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::Slot;
use super::setting::Setting;
use crate::campaign::{CampaignData, CampaignFit};
use crate::fit::FitWarning;
use crate::fit::measured::RunValues;
use crate::golden::golden;
use swimmer_files::Campaign;

/// How far the first look goes \[rad\].
const FIRST_LOOK: f64 = 0.03;
/// Chance at which following is worth while, and at which the find is told. The test takes all values for equally telling,
/// which they are not: at a nominal 1e-3 one of 98 faultless campaigns was suspected.
const WORTH_WHILE: f64 = 0.05;
const CHANCE: f64 = 1e-4;
/// Dead bands that are tried \[rad\].
const TRIED: [f64; 6] = [0.0, 0.02, 0.05, 0.09, 0.14, 0.21];
/// Looks of the golden section that refines the best: to a twentieth of a degree.
const REFINEMENTS: usize = 9;
/// Corrections of r_s and χ at each dead band.
const CORRECTIONS: usize = 2;

/// The warning, where there is reason for one.
pub(crate) fn noticed(
    campaign: &Campaign,
    data: &CampaignData,
    found: &CampaignFit,
) -> Option<FitWarning> {
    // Three parameters leave nothing of one run.
    if data.runs.len() < 3 {
        return None;
    }
    let slots = vec![Slot::SphereRadius, Slot::Chi, Slot::DeadBand];
    let values = RunValues::of(&found.runs);
    let setting = Setting::new(&campaign.swimmer, data, found, slots, values.scales).ok()?;
    let begun = setting.begin(found);
    let jacobian = setting.with_slots(vec![Slot::SphereRadius, Slot::Chi]);
    let jacobian = jacobian.jacobian(&begun[..2])?;
    let search = Search {
        setting: &setting,
        values: &values,
        jacobian,
        begun: &begun,
    };
    let known = search.at(begun[2])?;
    let ahead = search.at(begun[2] + FIRST_LOOK)?;
    let line: Vec<f64> = ahead
        .iter()
        .zip(&known)
        .map(|(a, k)| (a - k) / FIRST_LOOK)
        .collect();
    if search.chance(&known, &along(&known, &line)) > WORTH_WHILE {
        return None;
    }
    let score = |dead_band: f64| -> f64 {
        let residuals = search.at(dead_band);
        residuals.map_or(f64::INFINITY, |residuals| search.misfit(&residuals))
    };
    let scores = TRIED.map(score);
    let best = (0..TRIED.len()).min_by(|a, b| scores[*a].total_cmp(&scores[*b]))?;
    let from = TRIED[best.saturating_sub(1)];
    let to = TRIED[(best + 1).min(TRIED.len() - 1)];
    let dead_band = golden(from, to, REFINEMENTS, score).0;
    let residuals = search.at(dead_band)?;
    let chance = search.chance(&known, &residuals);
    (chance < CHANCE).then(|| FitWarning::DeadBand {
        known: begun[2],
        found: dead_band,
        gain: (search.misfit(&known) - search.misfit(&residuals)) / 2.0,
    })
}

struct Search<'a> {
    setting: &'a Setting<'a>,
    values: &'a RunValues,
    /// By r_s/L and ln χ.
    jacobian: DMatrix<f64>,
    begun: &'a [f64],
}

impl Search<'_> {
    /// What is left where the servos have this dead band and r_s and χ follow it.
    fn at(&self, dead_band: f64) -> Option<Vec<f64>> {
        let mut z = self.begun.to_vec();
        z[2] = dead_band;
        let look = |z: &[f64]| -> Option<Vec<f64>> {
            let values = self.setting.predict(z)?;
            Some(
                values
                    .iter()
                    .zip(&self.values.values)
                    .map(|(a, b)| a - b)
                    .collect(),
            )
        };
        let mut residuals = look(&z)?;
        for _ in 0..CORRECTIONS {
            let weights = self.weights(&residuals);
            let mut weighted = self.jacobian.clone();
            for (mut row, weight) in weighted.row_iter_mut().zip(&weights) {
                row *= *weight;
            }
            let slope = weighted.tr_mul(&DVector::from_column_slice(&residuals));
            let step = weighted.tr_mul(&self.jacobian).lu().solve(&slope)?;
            z[0] = (z[0] - step[0]).max(0.0);
            z[1] -= step[1];
            residuals = look(&z)?;
        }
        Some(residuals)
    }

    /// Sum of squares of each quantity, never below what cycles explain.
    fn squares(&self, residuals: &[f64]) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for (row, (residual, within)) in residuals.iter().zip(&self.values.within).enumerate() {
            sums[row % 3] += residual * residual + within.value;
        }
        sums
    }

    fn weights(&self, residuals: &[f64]) -> Vec<f64> {
        let squares = self.squares(residuals);
        (0..residuals.len())
            .map(|row| 1.0 / squares[row % 3])
            .collect()
    }

    /// Minus twice the log-likelihood where each quantity has a variance of its own.
    fn misfit(&self, residuals: &[f64]) -> f64 {
        let runs = (residuals.len() / 3) as f64;
        self.squares(residuals)
            .iter()
            .map(|sum| runs * sum.ln())
            .sum()
    }

    /// Chance that one parameter more explains so much, if there is nothing to explain.
    fn chance(&self, known: &[f64], other: &[f64]) -> f64 {
        let values = known.len() as f64;
        let ratio = ((self.misfit(known) - self.misfit(other)) / values).exp();
        let freedom = values - 3.0;
        FisherSnedecor::new(1.0, freedom).map_or(1.0, |f| f.sf(((ratio - 1.0) * freedom).max(0.0)))
    }
}

/// What is left of `residuals` along a line of them where each quantity is explained best, all weighing alike.
fn along(residuals: &[f64], line: &[f64]) -> Vec<f64> {
    let mut squares = [0.0; 3];
    for (row, residual) in residuals.iter().enumerate() {
        squares[row % 3] += residual * residual;
    }
    let weigh = |row: usize| 1.0 / squares[row % 3].max(1e-300);
    let rows = residuals.iter().zip(line).enumerate();
    let (mut product, mut square) = (0.0, 0.0);
    for (row, (residual, slope)) in rows {
        product += weigh(row) * residual * slope;
        square += weigh(row) * slope * slope;
    }
    let step = if square > 0.0 { product / square } else { 0.0 };
    residuals
        .iter()
        .zip(line)
        .map(|(r, l)| r - step * l)
        .collect()
}
