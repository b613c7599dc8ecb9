//! Agreement of the estimates: the paper's and that of largest likelihood against the one with systematic errors.
//!
//! All of them are linear in the errors of the runs and of what is taken for granted, so the variance of their difference follows
//! from the same errors for each: scatter, what differs from run to run, and what is known beforehand, as far as it is believed.

use nalgebra::{DMatrix, DVector};

use super::Plain;
use super::systematics::Joint;
use crate::fit::CampaignFit;
use crate::least_squares::weighted;

/// Largest difference from the estimate with systematic errors, of either parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Agreement {
    /// In standard deviations of that difference.
    pub(super) deviations: f64,
}

/// Least standard deviation of a difference, in r_s/L and ln χ: estimates that are nearer agree for every use.
const LEAST: f64 = 1e-4;

pub(super) fn agreement(found: &CampaignFit, plain: &Plain, joint: &Joint) -> Option<Agreement> {
    let paper = plain.data.papers_weights();
    let estimates = [
        (paper, found.optimum()),
        (
            plain.telling.weights.clone(),
            [plain.telling.at[0], plain.telling.at[1]],
        ),
    ];
    let apart = estimates
        .iter()
        .map(|(weights, at)| apart(plain, joint, weights, *at))
        .collect::<Option<Vec<f64>>>()?;
    Some(Agreement {
        deviations: apart.into_iter().fold(0.0, f64::max),
    })
}

/// Difference between a least-squares estimate and the joint one, in standard deviations.
fn apart(plain: &Plain, joint: &Joint, weights: &[f64], at: [f64; 2]) -> Option<f64> {
    let rows = plain.data.values.len();
    let jacobian = joint.estimate.jacobian.rows(0, rows);
    let plain_jacobian: DMatrix<f64> = jacobian.columns(0, 2).into_owned();
    let moving = weighted(&plain_jacobian, weights);
    let gain = moving.tr_mul(&plain_jacobian).try_inverse()? * moving.transpose();
    let components = &joint.estimate.components;
    let of_joint = components.gain.rows(0, 2);
    let mut variance = [0.0; 2];
    for row in 0..rows {
        for (i, variance) in variance.iter_mut().enumerate() {
            let moves = gain[(i, row)] - of_joint[(i, row)];
            *variance += moves.powi(2) * components.variance(row);
        }
    }
    for (place, known) in (rows..joint.data.within.len()).enumerate() {
        let change: DVector<f64> = jacobian.column(2 + place).into_owned();
        let shift = &gain * change;
        for (i, variance) in variance.iter_mut().enumerate() {
            let moves = shift[i] + of_joint[(i, known)];
            *variance += moves.powi(2) * joint.data.within[known].value;
        }
    }
    let off = [0, 1].map(|i| {
        let difference = (at[i] - joint.estimate.at[i]).abs();
        difference / (variance[i].sqrt() + LEAST)
    });
    Some(off[0].max(off[1]))
}
