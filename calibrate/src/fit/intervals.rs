//! Confidence intervals from the curvature at the optimum.

use super::components::Components;
use super::errors::Variance;
use super::outliers::{self, Unlike};
use super::run_values::RunValues;
use crate::least_squares::{Minimum, weighted};
use crate::student;

/// Intervals of both parameters.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Intervals {
    /// r_s \[m\], from and to; never below 0.
    #[serde(rename = "sphere_radius_m")]
    pub sphere_radius: [f64; 2],
    /// χ, from and to.
    pub chi: [f64; 2],
    /// Their level.
    pub level: f64,
}

impl Intervals {
    /// About (r_s/L, ln χ), with half widths in these.
    pub(crate) fn about(at: [f64; 2], half: [f64; 2], length: f64, level: f64) -> Self {
        Self {
            sphere_radius: [
                (at[0] - half[0]).max(0.0) * length,
                (at[0] + half[0]) * length,
            ],
            chi: [(at[1] - half[1]).exp(), (at[1] + half[1]).exp()],
            level,
        }
    }
}

/// Half width of an interval of this level.
pub(crate) fn half_width(variance: Variance, level: f64) -> Option<f64> {
    Some(student::quantile(variance.freedom, level)? * variance.value.sqrt())
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

pub(super) fn spread(
    optimum: &Minimum,
    data: &RunValues,
    weights: &[f64],
    length: f64,
    level: f64,
) -> Option<Spread> {
    let Minimum {
        residuals,
        jacobian,
        ..
    } = optimum;
    let at = [optimum.at[0], optimum.at[1]];
    let within = data.within.clone();
    let outlier = outliers::worst(jacobian, weights, residuals, &within);
    let mut components = Components::of(jacobian, weights, residuals, within)?;
    let errors = |components: &Components| [0, 1].map(|i| components.of_parameter(i));
    let [radius, chi] = errors(&components);
    let half = [half_width(radius, level)?, half_width(chi, level)?];
    let correlation = components.correlation(0, 1);
    components.between = Default::default();
    let [radius_within, chi_within] = errors(&components);
    let ratio = |all: Variance, within: Variance| (all.value / within.value).sqrt();
    let ratio = ratio(radius, radius_within).max(ratio(chi, chi_within));
    let roots: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
    let singular = weighted(jacobian, &roots).svd(false, false).singular_values;
    Some(Spread {
        intervals: Intervals::about(at, half, length, level),
        condition: singular.max() / singular.min(),
        correlation,
        outlier,
        misfit: if ratio.is_finite() && data.has_errors() {
            ratio
        } else {
            0.0
        },
    })
}
