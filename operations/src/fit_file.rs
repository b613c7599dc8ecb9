//! Uncertainty that a fit leaves, from the document of `swimmer calibrate`.

use std::path::{Path, PathBuf};

use gait_optimizer::Uncertainty;
use serde::Deserialize;
use serde_json::Value;

use crate::{Context, Error, Files};

/// A fit: its file, or its document.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(from = "PathBuf")]
pub enum FitSource {
    /// Path of the JSON document.
    File(PathBuf),
    /// The JSON document itself.
    Document(Value),
}

impl From<PathBuf> for FitSource {
    fn from(path: PathBuf) -> Self {
        Self::File(path)
    }
}

impl FitSource {
    /// The uncertainty that the fit leaves.
    ///
    /// # Errors
    /// As [`load`]; or the document is no fit.
    pub fn uncertainty(&self, context: &mut Context) -> Result<Uncertainty, Error> {
        match self {
            Self::File(path) => load(path, context),
            Self::Document(document) => {
                let fit = Fit::deserialize(document).map_err(|error| {
                    Error::refused(format!(
                        "{error}; a fit is the result of calibrating a campaign"
                    ))
                })?;
                of_fit(&fit, context)
            }
        }
    }
}

/// Part of a fit that is read.
#[derive(Debug, Deserialize)]
struct Fit {
    sphere_radius_m: f64,
    chi: f64,
    intervals: Intervals,
    correlation: Option<f64>,
    further: Option<FittedParameters>,
}

/// Nuisance parameters of the fit.
#[derive(Debug, Deserialize)]
struct FittedParameters {
    parameters: Vec<Parameter>,
    level: f64,
    correlations: Vec<Vec<f64>>,
}

#[derive(Debug, Deserialize)]
struct Parameter {
    name: String,
    value: f64,
    interval: [f64; 2],
}

impl FittedParameters {
    /// The uncertainty of the fit, if it includes the servos' gain. The estimate of the gain belongs into the servo map; its
    /// uncertainty remains.
    fn uncertainty(&self, context: &mut Context) -> Option<Uncertainty> {
        let of = |name: &str| self.parameters.iter().find(|one| one.name == name);
        let (radius, chi, gain) = (of("r_s")?, of("chi")?, of("gain")?);
        let place = |name: &str| self.parameters.iter().position(|one| one.name == name);
        let row = self.correlations.get(place("r_s")?)?;
        if (gain.value - 1.0).abs() > 1e-3 {
            context.warn(format!(
                "warning: the fit says that the servos turn {:.4} times the commanded angle; the design assumes that slope_rad_per_us of the \
                 swimmer file was corrected by this factor",
                gain.value
            ));
        }
        Some(Uncertainty {
            sphere_radius: radius.value,
            chi: chi.value,
            sphere_radius_interval: radius.interval,
            chi_interval: chi.interval,
            gain_interval: gain.interval.map(|end| end / gain.value),
            level: self.level,
            correlation: row.get(place("chi")?).copied(),
        })
    }
}

#[derive(Debug, Deserialize)]
struct Intervals {
    sphere_radius_m: [f64; 2],
    chi: [f64; 2],
    level: f64,
}

/// Reads the uncertainty that a fit leaves of `r_s` and χ, and of the servos' gain if it was fitted too.
///
/// # Errors
/// The file cannot be read or is invalid; the place in the file is named.
pub fn load(path: &Path, context: &mut Context) -> Result<Uncertainty, Error> {
    let cannot = |why: &dyn std::fmt::Display| {
        Error::refused(format!("cannot read the fit {}: {why}", path.display()))
    };
    if context.files == Files::Unavailable {
        return Err(cannot(&"there is no file system"));
    }
    let text = std::fs::read_to_string(path).map_err(|error| cannot(&error))?;
    let fit: Fit = serde_json::from_str(&text).map_err(|error| {
        Error::refused(format!(
            "{}:{}:{}: {error}; a fit is what swimmer calibrate --json prints",
            path.display(),
            error.line(),
            error.column()
        ))
    })?;
    of_fit(&fit, context)
}

fn of_fit(fit: &Fit, context: &mut Context) -> Result<Uncertainty, Error> {
    let further = fit.further.as_ref();
    let further = further.and_then(|further| further.uncertainty(context));
    let uncertainty = further.unwrap_or(Uncertainty {
        sphere_radius_interval: fit.intervals.sphere_radius_m,
        chi_interval: fit.intervals.chi,
        level: fit.intervals.level,
        correlation: fit.correlation,
        ..Uncertainty::none(fit.sphere_radius_m, fit.chi)
    });
    uncertainty.validate()?;
    Ok(uncertainty)
}
