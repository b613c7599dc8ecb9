//! Likelihood, profiles and bootstrap of r_s and χ, computed on demand from a finished fit.
//!
//! In addition to the paper's criterion, which weighs all runs alike, a likelihood is maximised: each X, ΔY and Δθ has a variance
//! of its own, from the cycles of its run and from the scatter between runs (`fit/components.rs`). From the likelihood follow a
//! second estimate, profile likelihoods, the ridge between r_s and χ, and outliers; from the paper's criterion the cycle
//! bootstrap; from both the influence of single runs.
//!
//! All of it is computed from polynomials in (r_s, ln χ) that interpolate the model (`surface.rs`) with a known error.

mod bootstrap;
mod curves;
mod document;
mod leave_one_out;
mod likelihood_problem;
mod profile;
mod surface;

use crate::error::FitError;
use crate::fit::parameter::Parameter;
use crate::fit::run_model::RunModel;
use crate::fit::{CampaignFit, Intervals};
use crate::quantities::{NAMES, QUANTITIES, TELLING};
pub use curves::{CurvePoint, circle_curve};
pub use document::EvidenceDocument;
use likelihood_problem::{LikelihoodProblem, RECTANGLES};
use profile::Scale;
use surface::Surface;

/// Extent of the computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EvidenceOptions {
    /// Draws of the bootstrap.
    pub draws: usize,
    /// Seed of their random numbers.
    pub seed: u64,
}

impl Default for EvidenceOptions {
    /// 2000 draws.
    fn default() -> Self {
        Self {
            draws: 2000,
            seed: 1,
        }
    }
}

/// r_s and χ by one way of fitting.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Pair {
    /// r_s \[m\].
    #[serde(rename = "sphere_radius_m")]
    pub sphere_radius: f64,
    /// χ.
    pub chi: f64,
}

/// X, ΔY or Δθ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// X \[m\].
    X,
    /// ΔY \[m\].
    DeltaY,
    /// Δθ \[rad\].
    DeltaTheta,
}

impl Quantity {
    /// In the order of all arrays here.
    pub const ALL: [Self; 3] = [Self::X, Self::DeltaY, Self::DeltaTheta];
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(NAMES[*self as usize])
    }
}

/// The estimate of greatest likelihood.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Likelihood {
    /// The estimate, outliers left out.
    #[serde(flatten)]
    pub estimate: Pair,
    /// Ends of the profile likelihoods at Student's threshold.
    pub intervals: Intervals,
    /// Standard deviation from run to run of X \[m\], ΔY \[m\] and Δθ \[rad\], beyond what cycles explain.
    #[serde(skip)]
    pub between_runs: [f64; 3],
    /// Correlation between r_s and ln χ.
    #[serde(skip)]
    pub correlation: f64,
}

/// Residual of one quantity of one run at the estimate of greatest likelihood; m or rad.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunError {
    /// Measured mean.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub measured: f64,
    /// By the model.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub predicted: f64,
    /// Standard error of the mean from the run's cycles.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub within: f64,
    /// The same with what differs from run to run.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub standard_error: f64,
    /// (Predicted − measured) / standard error.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub standardised: f64,
}

impl RunError {
    /// Error of a value that was neither measured nor stated.
    pub(crate) const NONE: Self = Self {
        measured: f64::NAN,
        predicted: f64::NAN,
        within: f64::NAN,
        standard_error: f64::NAN,
        standardised: f64::NAN,
    };
}

/// A profile likelihood.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Profile {
    /// The parameter (m, or χ) and log-likelihood less its largest value, the other parameter set free.
    pub points: Vec<(f64, f64)>,
    /// Threshold at the ends of the interval: −t²/2 of Student's t.
    pub threshold: f64,
    /// The interval.
    #[cfg_attr(feature = "schema", schemars(with = "[Option<f64>; 2]"))]
    pub interval: [f64; 2],
    /// `true` if the profile did not fall to the threshold within its range: then that end is no bound.
    pub open: [bool; 2],
    /// Degrees of freedom of Student's t.
    pub freedom: f64,
}

/// The log-likelihood over both parameters, for drawing.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Ridge {
    /// r_s \[m\] of the grid's columns.
    #[serde(rename = "sphere_radius_m")]
    pub sphere_radius: Vec<f64>,
    /// χ of its rows.
    pub chi: Vec<f64>,
    /// Log-likelihood less its largest value: a row for each χ.
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<Option<f64>>>"))]
    pub log_ratio: Vec<Vec<f64>>,
    /// Regions of both parameters together.
    pub contours: Vec<Contour>,
}

/// The border of a joint region.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Contour {
    /// Its level.
    pub level: f64,
    /// The log-likelihood on it, less the largest: minus Fisher's F of two parameters.
    pub threshold: f64,
    /// Corners (r_s \[m\], χ), once round.
    pub corners: Vec<(f64, f64)>,
}

/// The bootstrap of the paper's fit, by runs and cycles.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleBootstrap {
    /// Seed of the draws.
    pub seed: u64,
    /// Number.
    pub draws: usize,
    /// Draws whose fit ended at the border of what was looked at: intervals mean little where they are many.
    pub at_border: usize,
    /// Bias-corrected and accelerated intervals.
    pub intervals: Intervals,
    /// The draws' fits.
    pub points: Vec<Pair>,
}

/// Both fits without one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WithoutRun {
    /// Index of the run, in the campaign's order.
    pub run: usize,
    /// By the paper's criterion.
    pub paper: Pair,
    /// By likelihood; `None` where the other runs do not determine it.
    pub likelihood: Option<Pair>,
}

/// A value that the other ones do not expect. It is left out of the likelihood, never of the paper's criterion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Index of the run, in the campaign's order.
    pub run: usize,
    /// Quantity of the run.
    pub quantity: Quantity,
    /// Measured less what all others predict \[m or rad\].
    pub deviation: f64,
    /// The same in standard errors of that difference.
    pub standard_errors: f64,
    /// Chance that any value of a faultless campaign stands out so far.
    pub chance: f64,
}

/// Everything beyond the paper's fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// The estimate of greatest likelihood.
    pub likelihood: Likelihood,
    /// X, ΔY and Δθ of each run against it.
    pub run_errors: Vec<[RunError; TELLING]>,
    /// Profiles of r_s and of χ.
    pub profiles: [Profile; 2],
    /// Both together.
    pub ridge: Ridge,
    /// The bootstrap of the paper's fit; `None` of fewer than five runs, which draw nothing worth the name.
    pub bootstrap: Option<CycleBootstrap>,
    /// Both fits without each run.
    pub without_run: Vec<WithoutRun>,
    /// Outliers.
    pub outliers: Vec<Outlier>,
    /// Circles by the starting swimmer.
    pub start_curve: Vec<CurvePoint>,
    /// Circles by the swimmer of the paper's fit.
    pub fitted_curve: Vec<CurvePoint>,
    /// Error of the polynomials through the model's values, as a share of the largest X, ΔY, Δθ.
    pub surface_error: f64,
}

/// Optima that are further apart, in r_s/L and ln χ, are two.
const ELSEWHERE: f64 = 1e-3;

/// Weighs what a campaign's runs say about its fit.
///
/// # Errors
/// [`FitError`]: the data do not determine the parameters.
pub fn weigh_evidence(found: &CampaignFit, options: EvidenceOptions) -> Result<Evidence, FitError> {
    let problem = LikelihoodProblem::of(found)?;
    let scales = problem.data.scales;
    let plain = vec![Parameter::SphereRadius, Parameter::Chi];
    let played = found.runs.iter().map(|run| run.played.clone()).collect();
    let model = RunModel::new(found.start.clone(), played, scales, plain);
    let nothing = || FitError::NoConvergence { starts: RECTANGLES };
    let ask = |rectangle| Surface::new(&model, rectangle);
    let mut settled = problem.settle(problem.paper, ask).ok_or_else(nothing)?;
    let far = |a: [f64; 2], b: &[f64]| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() > ELSEWHERE;
    let best = problem.multi_start_optimum(&model, &settled.2);
    if let Some(best) = best.filter(|best| far(*best, &settled.2.at)) {
        settled = problem.settle(best, ask).ok_or_else(nothing)?;
    }
    let (surface, data_used, estimate, unexpected) = settled;
    let scale = Scale {
        length: found.length(),
    };
    let level = found.fit.intervals.level;
    let profile =
        |parameter| profile::profile(&surface, &data_used, &estimate, &scale, parameter, level);
    let profiles = [
        profile(0).ok_or_else(nothing)?,
        profile(1).ok_or_else(nothing)?,
    ];
    let pair = |at: [f64; 2]| Pair {
        sphere_radius: scale.natural(0, at[0]),
        chi: scale.natural(1, at[1]),
    };
    let drawn: Vec<bootstrap::RunDeviations> = found
        .runs
        .iter()
        .enumerate()
        .map(|(run, result)| problem.drawn(run, &result.cycles))
        .collect();
    let drawn = bootstrap::bootstrap(&surface, &drawn, problem.paper, level, options);
    let natural = |parameter: usize, ends: [f64; 2]| ends.map(|end| scale.natural(parameter, end));
    let period_s = found.usual_period_s();
    Ok(Evidence {
        likelihood: Likelihood {
            estimate: pair([estimate.at[0], estimate.at[1]]),
            intervals: Intervals {
                sphere_radius: profiles[0].interval,
                chi: profiles[1].interval,
                level,
            },
            between_runs: std::array::from_fn(|q| {
                estimate.components.between[q].sqrt() * scales[q]
            }),
            correlation: estimate.components.correlation(0, 1),
        },
        run_errors: problem.run_errors(&estimate),
        ridge: profile::ridge(&surface, &data_used, &estimate, &scale).ok_or_else(nothing)?,
        profiles,
        bootstrap: drawn.map(|drawn| CycleBootstrap {
            seed: drawn.seed,
            draws: drawn.draws,
            at_border: drawn.at_border,
            intervals: Intervals {
                sphere_radius: natural(0, drawn.intervals[0]),
                chi: natural(1, drawn.intervals[1]),
                level,
            },
            points: drawn.points.into_iter().map(pair).collect(),
        }),
        without_run: problem.without_runs(
            &surface,
            &data_used,
            [estimate.at[0], estimate.at[1]],
            pair,
        ),
        outliers: unexpected
            .into_iter()
            .map(|value| Outlier {
                run: value.row / QUANTITIES,
                quantity: Quantity::ALL[value.row % QUANTITIES],
                deviation: value.deviation * scales[value.row % QUANTITIES],
                standard_errors: value.standard_errors,
                chance: value.chance,
            })
            .collect(),
        start_curve: circle_curve(&found.start, period_s),
        fitted_curve: circle_curve(&found.swimmer, period_s),
        surface_error: surface.error,
    })
}
