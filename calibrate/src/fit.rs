//! The paper's fit (eq. RMSE): r_s and χ that minimise √Σ(w_x q_x + w_y q_y + w_θ q_θ) over runs, with
//! q = ((simulated − measured)/max measured)², w_x = 0.5 and w_y = w_θ = 0.25.
//!
//! Parameters are r_s = L p² and χ = eᵏ, which keep them where they make sense; the border r_s = 0 is fitted by itself.
//! Levenberg–Marquardt (the MINPACK port) starts from the best of a grid, with ideal servos; its distinct ends then start the
//! fit with the path that the servos really played. Jacobians are central differences of fourth order of a simulation that
//! is smooth to 1e-10.
//!
//! Intervals are Student's t, with the variances of what goes into the fit: between the cycles of a run (`errors.rs`) and
//! from run to run (`components.rs`), and Satterthwaite's degrees of freedom. They are the ones that were chosen by counting:
//! `tests/coverage.rs` has three hundred campaigns of a twin in which everything goes wrong by chance.

pub(crate) mod components;
pub(crate) mod errors;
mod intervals;
pub(crate) mod measured;
pub(crate) mod outliers;
mod problem;
mod search;

use swimmer_model::{InvalidSwimmer, Swimmer, TangentialDrag};

use crate::cycles::{Cycles, Projection, Statistics};
use crate::prediction::{JointPath, PredictedCycle};
pub use intervals::Intervals;
use problem::{Problem, natural};

/// Weights of X, ΔY and Δθ in the paper's criterion.
pub const WEIGHTS: [f64; 3] = [0.5, 0.25, 0.25];

/// Their names.
const QUANTITIES: [&str; 3] = ["X", "ΔY", "Δθ"];

/// What a fit is made from besides the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Level of the intervals.
    pub level: f64,
}

impl Default for FitOptions {
    /// 95 %.
    fn default() -> Self {
        Self { level: 0.95 }
    }
}

/// Why nothing was fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// The starting swimmer is none.
    #[error("{0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// A level that is no share.
    #[error("the level of the intervals is {level}; give a share between 0 and 1, such as 0.95")]
    Level {
        /// The level.
        level: f64,
    },
    /// One of X, ΔY, Δθ is zero in all runs, so the criterion is undefined.
    #[error("{quantity} is zero in all runs, so the criterion cannot be scaled by it")]
    NothingMeasured {
        /// Which one.
        quantity: &'static str,
    },
    /// X has the other sign than the model's in every run.
    #[error(
        "in all {runs} runs the robot swam against the model (X of the first: {measured_m:.5} m, model {predicted_m:.5} m); either the \
         gaits ran clockwise (add :cw to `gait`), or front and back reflectors are exchanged (exchange `at`)"
    )]
    SignOpposes {
        /// How many runs.
        runs: usize,
        /// The first run's X \[m\].
        measured_m: f64,
        /// What the model swims \[m\].
        predicted_m: f64,
    },
    /// The data say nothing about some combination of what was asked.
    #[error(
        "these runs do not determine {parameters} together; fit fewer parameters, or measure other gaits and amplitudes"
    )]
    Undetermined {
        /// Their names.
        parameters: String,
    },
    /// No start led anywhere.
    #[error(
        "the fit did not converge from any of {starts} starts; look at X, ΔY and Δθ of the runs first"
    )]
    NoConvergence {
        /// How many starts.
        starts: usize,
    },
}

/// One run as the fit sees it.
#[derive(Debug, Clone)]
pub(crate) struct Observation {
    pub(crate) path: JointPath,
    /// X, ΔY, Δθ.
    pub(crate) measured: [Statistics; 3],
}

impl Observation {
    pub(crate) fn new(path: JointPath, cycles: &Cycles) -> Self {
        Self {
            path,
            measured: [cycles.x, cycles.delta_y, cycles.delta_theta],
        }
    }

    /// The same run with servos that do as they are told, for the search.
    fn ideal(&self, gait: &swimmer_files::AnyGait) -> Self {
        Self {
            path: JointPath::Ideal(gait.clone()),
            measured: self.measured,
        }
    }
}

/// What is left between one run and the fitted model: simulated less measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunResidual {
    /// What the fitted model does.
    pub predicted: PredictedCycle,
    /// X \[m\].
    pub x_m: f64,
    /// ΔY \[m\].
    pub delta_y_m: f64,
    /// Δθ \[rad\].
    pub delta_theta_rad: f64,
    /// This run's part of the squared criterion.
    pub share: f64,
}

/// The fitted drag.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// r_s \[m\].
    pub sphere_radius: f64,
    /// χ.
    pub chi: f64,
    /// The paper's criterion at the optimum: the root of the weighted sum, no 1/n.
    pub rmse: f64,
    /// Intervals of both.
    pub intervals: Intervals,
    /// How c_t is tied to the viscosity: the result hangs on it.
    pub c_t_form: TangentialDrag<f64>,
    /// What is left, run by run.
    pub residuals: Vec<RunResidual>,
    /// Condition number of the Jacobian in (r_s/L, ln χ): how narrow the valley is.
    pub condition: f64,
    /// Correlation between r_s and ln χ.
    pub correlation: f64,
    /// What to know about it.
    pub warnings: Vec<FitWarning>,
}

/// What to know about a fit.
#[derive(Debug, Clone, PartialEq)]
pub enum FitWarning {
    /// r_s and χ trade against each other.
    Ridge {
        /// Their correlation.
        correlation: f64,
        /// Condition number of the Jacobian.
        condition: f64,
    },
    /// Few data.
    FewRuns {
        /// How many.
        runs: usize,
    },
    /// The optimum has no sphere.
    NoSphere,
    /// One value is unlike what the other runs say.
    Outlier {
        /// Which run, in the campaign's order.
        run: usize,
        /// Which of its values.
        quantity: &'static str,
        /// By how many standard errors.
        standard_errors: f64,
    },
    /// Another dead band would explain the runs much better.
    DeadBand {
        /// As the swimmer file says \[rad\].
        known: f64,
        /// As the runs say \[rad\].
        found: f64,
        /// Gain in log-likelihood.
        gain: f64,
    },
    /// The residuals say more than cycles' deviations: factor between both standard errors.
    ModelMisfit {
        /// Standard error by residuals over that by cycles.
        ratio: f64,
    },
}

impl std::fmt::Display for FitWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Ridge {
                correlation,
                condition,
            } => write!(
                f,
                "r_s and chi trade against each other (correlation {correlation:.4}, condition {condition:.0}): runs at other \
                 amplitudes would tell them apart"
            ),
            Self::FewRuns { runs } => write!(
                f,
                "{runs} run(s) for two parameters: what differs from run to run hardly shows in so few, and the intervals leave it out"
            ),
            Self::Outlier {
                run,
                quantity,
                standard_errors,
            } => write!(
                f,
                "{quantity} of run {} is {:.0} standard errors off what the other runs say: look at that recording; the paper's \
                 criterion does not know outliers",
                run + 1,
                standard_errors.abs()
            ),
            Self::DeadBand { known, found, gain } => write!(
                f,
                "the runs look as if the servos had a dead band of {:.1}°, where the swimmer file says {:.1}° (log-likelihood \
                 +{gain:.1}): r_s and chi are off if it is so; see --fit-also deadband, then [servo] dead_band in the swimmer file",
                found.to_degrees(),
                known.to_degrees()
            ),
            Self::NoSphere => f.write_str("the best fit has no sphere: r_s = 0 is at its bound"),
            Self::ModelMisfit { ratio } => write!(
                f,
                "the runs miss the model by {ratio:.0} times what cycles deviate: something besides r_s and chi is not as assumed"
            ),
        }
    }
}

/// The c_t form in words, as `c_t_form` reports it.
pub fn c_t_form(drag: &TangentialDrag<f64>) -> String {
    match drag {
        TangentialDrag::LogAspect(value) => format!("log_aspect = {value}"),
        TangentialDrag::HalfThickness(value) => format!("half_thickness = {value}"),
        TangentialDrag::OverViscosity(value) => format!("over_viscosity = {value}"),
    }
}

/// The paper's fit. `gaits` belong to `runs`.
pub(crate) fn fit(
    start: &Swimmer<f64>,
    runs: &[Observation],
    gaits: &[swimmer_files::AnyGait],
    level: f64,
) -> Result<Fit, FitError> {
    start.validate()?;
    if !(level > 0.0 && level < 1.0) {
        return Err(FitError::Level { level });
    }
    let scales = scales(runs)?;
    let row = [0, 1, 2].map(|i| WEIGHTS[i].sqrt() / scales[i]);
    let factors = vec![row; runs.len()];
    let projection = Projection::new();
    let problem = Problem::new(start, runs, &factors, &projection);
    let (p, cost) = search::search(&problem, gaits)?;
    summary(&problem, p, cost, level).ok_or(FitError::NoConvergence { starts: 1 })
}

/// The optimum (r_s/L, ln χ) of least squares with other factors of the residuals, sought from as many starts.
pub(crate) fn with_factors(
    start: &Swimmer<f64>,
    runs: &[Observation],
    gaits: &[swimmer_files::AnyGait],
    factors: &[[f64; 3]],
) -> Result<[f64; 2], FitError> {
    let projection = Projection::new();
    let problem = Problem::new(start, runs, factors, &projection);
    let ([p, k], _) = search::search(&problem, gaits)?;
    Ok([p * p, k])
}

/// Whether the model swims the other way in every run.
pub(crate) fn check_signs(start: &Swimmer<f64>, runs: &[Observation]) -> Result<(), FitError> {
    let projection = Projection::new();
    let mut first = None;
    for run in runs {
        let predicted_m = run.path.predict(start, &projection)?.0.x_m;
        let Statistics {
            mean: measured_m,
            se,
            ..
        } = run.measured[0];
        if measured_m * predicted_m >= 0.0 || measured_m.abs() < 3.0 * se {
            return Ok(());
        }
        first.get_or_insert((measured_m, predicted_m));
    }
    match first {
        Some((measured_m, predicted_m)) => Err(FitError::SignOpposes {
            runs: runs.len(),
            measured_m,
            predicted_m,
        }),
        None => Ok(()),
    }
}

/// The largest measured value of each quantity, as the criterion divides by it.
fn scales(runs: &[Observation]) -> Result<[f64; 3], FitError> {
    let largest = |i: usize| {
        runs.iter()
            .map(|run| run.measured[i].mean.abs())
            .fold(0.0, f64::max)
    };
    let scales = [0, 1, 2].map(largest);
    for (scale, quantity) in scales.iter().zip(QUANTITIES) {
        if !(*scale > 0.0 && scale.is_finite()) {
            return Err(FitError::NothingMeasured { quantity });
        }
    }
    Ok(scales)
}

fn summary(problem: &Problem<'_>, p: [f64; 2], cost: f64, level: f64) -> Option<Fit> {
    let swimmer = natural(problem.start, p);
    let (r_s, chi) = (swimmer.sphere_radius, swimmer.chi);
    let spread = intervals::spread(problem, r_s, chi, level)?;
    let mut residuals = Vec::with_capacity(problem.runs.len());
    for (run, parts) in problem
        .runs
        .iter()
        .zip(problem.residuals(&swimmer)?.chunks(3))
    {
        let predicted = run.path.predict(&swimmer, problem.projection).ok()?.0;
        let [x, y, theta] = run.measured.map(|measured| measured.mean);
        residuals.push(RunResidual {
            predicted,
            x_m: predicted.x_m - x,
            delta_y_m: predicted.delta_y_m - y,
            delta_theta_rad: predicted.delta_theta_rad - theta,
            share: parts.iter().map(|r| r * r).sum(),
        });
    }
    let mut warnings = Vec::new();
    if problem.runs.len() < 3 {
        warnings.push(FitWarning::FewRuns {
            runs: problem.runs.len(),
        });
    }
    if spread.correlation.abs() > 0.99 || spread.condition > 100.0 {
        warnings.push(FitWarning::Ridge {
            correlation: spread.correlation,
            condition: spread.condition,
        });
    }
    if r_s < 1e-4 * problem.start.total_length() {
        warnings.push(FitWarning::NoSphere);
    }
    if let Some(outlier) = spread.outlier {
        warnings.push(FitWarning::Outlier {
            run: outlier.row / 3,
            quantity: QUANTITIES[outlier.row % 3],
            standard_errors: outlier.standard_errors,
        });
    }
    if spread.misfit > 10.0 {
        warnings.push(FitWarning::ModelMisfit {
            ratio: spread.misfit,
        });
    }
    Some(Fit {
        sphere_radius: r_s,
        chi,
        rmse: cost.sqrt(),
        intervals: spread.intervals,
        c_t_form: problem.start.tangential_drag,
        residuals,
        condition: spread.condition,
        correlation: spread.correlation,
        warnings,
    })
}
