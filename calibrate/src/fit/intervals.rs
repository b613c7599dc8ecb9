//! How sure is it? Intervals from the curvature at the optimum.

use nalgebra::{DMatrix, Dyn, OMatrix, OVector, U2};
use statrs::distribution::{ContinuousCDF, StudentsT};
use swimmer_model::Swimmer;

use super::components::Components;
use super::errors::{self, Variance};
use super::outliers::{self, Unlike};
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
    /// The value that stands out most, if one does.
    pub(super) outlier: Option<Unlike>,
    /// Standard error by residuals over that by cycles, the larger of both parameters; 0 where cycles say nothing.
    pub(super) misfit: f64,
}

/// Step in r_s/L and in ln χ.
const STEP: f64 = 1e-3;

pub(super) fn spread(problem: &Problem<'_>, r_s: f64, chi: f64, level: f64) -> Option<Spread> {
    let length = problem.start.total_length();
    let jacobian = jacobian(problem, r_s / length, chi.ln())?;
    let swimmer = Swimmer {
        sphere_radius: r_s,
        chi,
        ..*problem.start
    };
    let residuals = problem.residuals(&swimmer)?;
    let measured: Vec<_> = problem.runs.iter().map(|run| run.measured).collect();
    let within: Vec<Variance> = errors::within_runs(&measured)
        .into_iter()
        .zip(problem.factors)
        .flat_map(|(run, factors)| {
            let scaled = |(v, factor): (Variance, &f64)| Variance {
                value: v.value * factor.powi(2),
                ..v
            };
            run.into_iter().zip(factors).map(scaled).collect::<Vec<_>>()
        })
        .collect();
    let dynamic = DMatrix::from_fn(jacobian.nrows(), 2, |i, j| jacobian[(i, j)]);
    let outlier = outliers::worst(&dynamic, &residuals, &within);
    let mut components = Components::of(&dynamic, &vec![1.0; residuals.len()], &residuals, within)?;
    let error = |components: &Components, i: usize| -> Option<(f64, f64)> {
        let Variance { value, freedom } = components.of_parameter(i);
        let quantile = StudentsT::new(0.0, 1.0, freedom)
            .ok()?
            .inverse_cdf(0.5 + level / 2.0);
        Some((value.sqrt(), quantile))
    };
    let ((sr, tr), (sk, tk)) = (error(&components, 0)?, error(&components, 1)?);
    let (dr, dk) = (tr * sr * length, tk * sk);
    let covariance = components.covariance();
    components.between = [0.0; 3];
    let ratio = (sr / error(&components, 0)?.0).max(sk / error(&components, 1)?.0);
    let singular = jacobian.clone().svd(false, false).singular_values;
    Some(Spread {
        intervals: Intervals {
            sphere_radius: [(r_s - dr).max(0.0), r_s + dr],
            chi: [chi * (-dk).exp(), chi * dk.exp()],
            level,
        },
        condition: singular.max() / singular.min(),
        correlation: covariance[(0, 1)] / (covariance[(0, 0)] * covariance[(1, 1)]).sqrt(),
        outlier,
        misfit: if ratio.is_finite() { ratio } else { 0.0 },
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
