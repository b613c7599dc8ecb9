//! Evidence as the document that reports keep: `evidence.json` of the command, and what the lab page shows.

use serde::Serialize;

use super::{Evidence, Pair, Profile, Ridge, RunError};
use crate::fit::Intervals;

/// All that is known beyond the fit, with runs by the names of their files; its keys are those of `evidence.json`.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EvidenceDocument<'a> {
    /// Estimate of greatest likelihood.
    likelihood: LikelihoodPart<'a>,
    /// Residuals, run by run.
    run_errors: Vec<RunErrors<'a>>,
    /// Profile likelihoods.
    profiles: Profiles<'a>,
    /// Likelihood over both parameters.
    ridge: &'a Ridge,
    /// Bootstrap of the fit with the paper's weights; null for fewer than five runs.
    bootstrap: Option<Bootstrap<'a>>,
    /// Fits without one run.
    without_run: Vec<Without<'a>>,
    /// Values that the likelihood leaves out.
    outliers: Vec<OutlierPart<'a>>,
    /// Error of the polynomials through the model's values, as a share of the largest X, ΔY, Δθ.
    surface_error: f64,
}

/// Estimate of greatest likelihood.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct LikelihoodPart<'a> {
    /// r_s \[m\] and χ.
    estimate: &'a Pair,
    /// Ends of the profile likelihoods.
    intervals: &'a Intervals,
    /// Standard deviations from run to run, beyond what cycles explain.
    between_runs: BetweenRuns,
    /// Correlation of r_s and ln χ.
    correlation: f64,
}

/// Standard deviations from run to run.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct BetweenRuns {
    /// Displacement \[m\].
    x_m: f64,
    /// Sway \[m\].
    delta_y_m: f64,
    /// Oscillation of the heading \[rad\].
    delta_theta_rad: f64,
}

/// Residuals of one run.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct RunErrors<'a> {
    /// File of the run.
    file: &'a str,
    /// Displacement \[m\].
    x_m: &'a RunError,
    /// Sway \[m\].
    delta_y_m: &'a RunError,
    /// Oscillation of the heading \[rad\].
    delta_theta_rad: &'a RunError,
}

/// Profile likelihoods.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Profiles<'a> {
    /// Radius of the sphere \[m\].
    sphere_radius_m: &'a Profile,
    /// Drag ratio.
    chi: &'a Profile,
}

/// Bootstrap by runs and cycles.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Bootstrap<'a> {
    /// Seed of the draws.
    seed: u64,
    /// Number of draws.
    draws: usize,
    /// Whole runs are drawn, not only cycles.
    runs_drawn: bool,
    /// Number of draws whose fit ended at the border of the search.
    at_border: usize,
    /// Bias-corrected and accelerated intervals.
    intervals: &'a Intervals,
}

/// Both fits without one run.
#[derive(Debug, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "WithoutRun")
)]
struct Without<'a> {
    /// File of the run.
    file: &'a str,
    /// Fit with the paper's weights.
    paper: &'a Pair,
    /// Estimate of greatest likelihood; null if it has none.
    likelihood: Option<&'a Pair>,
}

/// Value that stands out.
#[derive(Debug, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "EvidenceOutlier")
)]
struct OutlierPart<'a> {
    /// File of the run.
    file: &'a str,
    /// X, ΔY or Δθ.
    quantity: String,
    /// Measured less what all others predict \[m or rad\].
    deviation: f64,
    /// The same in standard errors of that difference.
    standard_errors: f64,
    /// Chance that any value of a faultless campaign stands out so far.
    chance: f64,
}

impl Evidence {
    /// The document; `names` are the runs' files, in the order of the fit.
    pub fn document<'a>(&'a self, names: &'a [String]) -> EvidenceDocument<'a> {
        let name = |run: usize| names.get(run).map_or("", String::as_str);
        let likelihood = &self.likelihood;
        let [x_m, delta_y_m, delta_theta_rad] = likelihood.between_runs;
        let [sphere_radius_m, chi] = &self.profiles;
        EvidenceDocument {
            likelihood: LikelihoodPart {
                estimate: &likelihood.estimate,
                intervals: &likelihood.intervals,
                between_runs: BetweenRuns {
                    x_m,
                    delta_y_m,
                    delta_theta_rad,
                },
                correlation: likelihood.correlation,
            },
            run_errors: (self.run_errors.iter().enumerate())
                .map(|(run, [x_m, delta_y_m, delta_theta_rad])| RunErrors {
                    file: name(run),
                    x_m,
                    delta_y_m,
                    delta_theta_rad,
                })
                .collect(),
            profiles: Profiles {
                sphere_radius_m,
                chi,
            },
            ridge: &self.ridge,
            bootstrap: self.bootstrap.as_ref().map(|bootstrap| Bootstrap {
                seed: bootstrap.seed,
                draws: bootstrap.draws,
                runs_drawn: true,
                at_border: bootstrap.at_border,
                intervals: &bootstrap.intervals,
            }),
            without_run: (self.without_run.iter())
                .map(|without| Without {
                    file: name(without.run),
                    paper: &without.paper,
                    likelihood: without.likelihood.as_ref(),
                })
                .collect(),
            outliers: (self.outliers.iter())
                .map(|outlier| OutlierPart {
                    file: name(outlier.run),
                    quantity: outlier.quantity.to_string(),
                    deviation: outlier.deviation,
                    standard_errors: outlier.standard_errors,
                    chance: outlier.chance,
                })
                .collect(),
            surface_error: self.surface_error,
        }
    }
}
