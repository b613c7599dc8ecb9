//! A fit, as `swimmer calibrate` leaves it: what later commands need of it.

use std::path::Path;

use gait_optimizer::Uncertainty;
use serde::Deserialize;

use crate::failure::{Failure, Outcome};

/// What is read of a fit.
#[derive(Debug, Deserialize)]
struct Fit {
    sphere_radius_m: f64,
    chi: f64,
    intervals: Intervals,
    correlation: Option<f64>,
}

#[derive(Debug, Deserialize)]
struct Intervals {
    sphere_radius_m: [f64; 2],
    chi: [f64; 2],
    level: f64,
}

/// Reads what a fit leaves open of `r_s` and χ.
///
/// # Errors
/// [`Failure::BadInput`] with the place in the file.
pub(crate) fn load_fit(path: &Path) -> Outcome<Uncertainty> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        Failure::BadInput(format!("cannot read the fit {}: {error}", path.display()))
    })?;
    let fit: Fit = serde_json::from_str(&text).map_err(|error| {
        Failure::BadInput(format!(
            "{}:{}:{}: {error}; a fit is what swimmer calibrate --json prints",
            path.display(),
            error.line(),
            error.column()
        ))
    })?;
    let uncertainty = Uncertainty {
        sphere_radius: fit.sphere_radius_m,
        chi: fit.chi,
        sphere_radius_interval: fit.intervals.sphere_radius_m,
        chi_interval: fit.intervals.chi,
        level: fit.intervals.level,
        correlation: fit.correlation,
    };
    uncertainty.validate()?;
    Ok(uncertainty)
}
