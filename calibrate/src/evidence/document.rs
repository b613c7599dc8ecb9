//! Evidence as the document that reports keep: `evidence.json` of the command, and what the lab page shows.

use serde::Serialize;

use super::{Evidence, Pair, Profile, Ridge, RunError};
use crate::fit::Intervals;

/// All that is known beyond the fit, with runs by the names of their files; its keys are those of `evidence.json`.
#[derive(Debug, Serialize)]
pub struct EvidenceDocument<'a> {
    likelihood: LikelihoodPart<'a>,
    run_errors: Vec<RunErrors<'a>>,
    profiles: Profiles<'a>,
    ridge: &'a Ridge,
    bootstrap: Option<Bootstrap<'a>>,
    without_run: Vec<Without<'a>>,
    outliers: Vec<OutlierPart<'a>>,
    surface_error: f64,
}

#[derive(Debug, Serialize)]
struct LikelihoodPart<'a> {
    estimate: &'a Pair,
    intervals: &'a Intervals,
    between_runs: BetweenRuns,
    correlation: f64,
}

/// Standard deviations from run to run.
#[derive(Debug, Serialize)]
struct BetweenRuns {
    x_m: f64,
    delta_y_m: f64,
    delta_theta_rad: f64,
}

#[derive(Debug, Serialize)]
struct RunErrors<'a> {
    file: &'a str,
    x_m: &'a RunError,
    delta_y_m: &'a RunError,
    delta_theta_rad: &'a RunError,
}

#[derive(Debug, Serialize)]
struct Profiles<'a> {
    sphere_radius_m: &'a Profile,
    chi: &'a Profile,
}

#[derive(Debug, Serialize)]
struct Bootstrap<'a> {
    seed: u64,
    draws: usize,
    /// Whole runs are drawn, not only cycles.
    runs_drawn: bool,
    at_border: usize,
    intervals: &'a Intervals,
}

#[derive(Debug, Serialize)]
struct Without<'a> {
    file: &'a str,
    paper: &'a Pair,
    likelihood: Option<&'a Pair>,
}

#[derive(Debug, Serialize)]
struct OutlierPart<'a> {
    file: &'a str,
    quantity: String,
    deviation: f64,
    standard_errors: f64,
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
