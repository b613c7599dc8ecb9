//! How sure is it? Intervals from the curvature at the optimum.

use nalgebra::{Dyn, Matrix2, OMatrix, OVector, U2};
use statrs::distribution::{ContinuousCDF, StudentsT};
use swimmer_model::Swimmer;

use super::problem::{Problem, difference};

/// Intervals of both parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intervals {
    /// r_s \[m\], from and to; never below 0.
    pub sphere_radius: [f64; 2],
    /// χ, from and to.
    pub chi: [f64; 2],
    /// Their level.
    pub level: f64,
}

pub(super) struct Spread {
    pub(super) intervals: Intervals,
    pub(super) condition: f64,
    pub(super) correlation: f64,
    /// Standard error by residuals over that by cycles, the larger of both parameters; 0 where cycles say nothing.
    pub(super) misfit: f64,
}

/// Step in r_s/L and in ln χ.
const STEP: f64 = 1e-3;

pub(super) fn spread(
    problem: &Problem<'_>,
    r_s: f64,
    chi: f64,
    cost: f64,
    level: f64,
) -> Option<Spread> {
    let length = problem.start.total_length();
    let jacobian = jacobian(problem, r_s / length, chi.ln())?;
    let information: Matrix2<f64> = jacobian.tr_mul(&jacobian);
    let inverse = information.try_inverse()?;
    let freedom = (jacobian.nrows() as f64 - 2.0).max(1.0);
    let by_residuals = inverse * (cost / freedom);
    // The residuals' own variances, from cycle to cycle: J⁺ V J⁺ᵀ.
    let mut inner = Matrix2::zeros();
    for (row, (_, se), factor) in problem
        .runs
        .iter()
        .flat_map(|run| run.measured.into_iter().zip(problem.factors))
        .enumerate()
        .map(|(row, (measured, factor))| (row, measured, factor))
    {
        let gradient = jacobian.row(row);
        inner += gradient.transpose() * gradient * (se * factor).powi(2);
    }
    let by_cycles = inverse * inner * inverse;
    let error = |i: usize| by_residuals[(i, i)].max(by_cycles[(i, i)]).max(0.0).sqrt();
    let quantile = StudentsT::new(0.0, 1.0, freedom)
        .ok()?
        .inverse_cdf(0.5 + level / 2.0);
    let (dr, dk) = (quantile * error(0) * length, quantile * error(1));
    let ratio = |i: usize| {
        let cycles = by_cycles[(i, i)];
        if cycles > 0.0 {
            (by_residuals[(i, i)] / cycles).sqrt()
        } else {
            0.0
        }
    };
    let singular = jacobian.clone().svd(false, false).singular_values;
    Some(Spread {
        intervals: Intervals {
            sphere_radius: [(r_s - dr).max(0.0), r_s + dr],
            chi: [chi * (-dk).exp(), chi * dk.exp()],
            level,
        },
        condition: singular.max() / singular.min(),
        correlation: inverse[(0, 1)] / (inverse[(0, 0)] * inverse[(1, 1)]).sqrt(),
        misfit: ratio(0).max(ratio(1)),
    })
}

/// Derivatives of the weighted residuals by r_s/L and ln χ; one-sided in r_s next to its bound.
fn jacobian(problem: &Problem<'_>, radius: f64, log_chi: f64) -> Option<OMatrix<f64, Dyn, U2>> {
    let length = problem.start.total_length();
    let at = |radius: f64, log_chi: f64| {
        problem.residuals(&Swimmer {
            sphere_radius: length * radius,
            chi: log_chi.exp(),
            ..*problem.start
        })
    };
    let chi = difference(
        &at(radius, log_chi - 2.0 * STEP)?,
        &at(radius, log_chi - STEP)?,
        &at(radius, log_chi + STEP)?,
        &at(radius, log_chi + 2.0 * STEP)?,
        STEP,
    )?;
    let sphere = if radius > 2.0 * STEP {
        difference(
            &at(radius - 2.0 * STEP, log_chi)?,
            &at(radius - STEP, log_chi)?,
            &at(radius + STEP, log_chi)?,
            &at(radius + 2.0 * STEP, log_chi)?,
            STEP,
        )?
    } else {
        let (here, one, two) = (
            at(radius, log_chi)?,
            at(radius + STEP, log_chi)?,
            at(radius + 2.0 * STEP, log_chi)?,
        );
        let rows = here.iter().zip(&one).zip(&two);
        OVector::<f64, Dyn>::from_vec(
            rows.map(|((h, a), b)| (4.0 * a - b - 3.0 * h) / (2.0 * STEP))
                .collect(),
        )
    };
    Some(OMatrix::<f64, Dyn, U2>::from_columns(&[sphere, chi]))
}
