//! The paper's fit (eq. RMSE): r_s and χ that minimise √Σ(w_x q_x + w_y q_y + w_θ q_θ) over runs, with
//! q = ((simulated − measured)/max measured)², w_x = 0.5 and w_y = w_θ = 0.25.
//!
//! It is the least squares (`least_squares.rs`) of a model of the runs (`run_model.rs`) with two parameters, r_s/L ≥ 0 and ln χ,
//! and fixed weights. Nuisance parameters are further parameters of the same model; the likelihood has the same squares with
//! weights estimated from the data (`likelihood.rs`).
//!
//! Intervals are Student's t, with the variances of what goes into the fit: between the cycles of a run (`errors.rs`) and
//! from run to run (`components.rs`), and Satterthwaite's degrees of freedom. They are the ones that were chosen by counting:
//! `tests/coverage.rs` has three hundred campaigns of a twin in which everything goes wrong by chance.

pub(crate) mod components;
pub(crate) mod errors;
pub(crate) mod intervals;
pub(crate) mod likelihood;
pub(crate) mod outliers;
pub(crate) mod parameter;
pub(crate) mod prior;
pub(crate) mod run_model;
pub(crate) mod run_values;
mod search;
pub(crate) mod tangent;

use std::path::{Path, PathBuf};

use swimmer_files::{Known, SwimmerFile};
use swimmer_model::{InvalidSwimmer, Links, Swimmer, TangentialDrag};

use crate::error::FitError;
use crate::joints::{Measured, MeasuredServo, combined};
use crate::least_squares::{Minimum, cost};
use crate::median::median;
use crate::prediction::{Played, PredictedCycle, first_of_repeats};
use crate::quantities::{NAMES, QUANTITIES};
use crate::run::RunResult;
pub use intervals::Intervals;
use parameter::Parameter;
use run_model::RunModel;
use run_values::RunValues;
pub(crate) use search::search;

/// Weights of X, ΔY and Δθ in the paper's criterion, which leaves out Y and net turn.
pub(crate) const WEIGHTS: [f64; QUANTITIES] = [0.5, 0.25, 0.25, 0.0, 0.0];

/// Usual error of a reflector's place, if the campaign states none \[m\].
pub(crate) const REFLECTOR: f64 = 5e-4;

/// Options of a fit.
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

/// Residual of one run: simulated less measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunResidual {
    /// Cycle by the fitted model.
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
    /// Relation of c_t to the viscosity, on which the result depends.
    pub c_t_form: TangentialDrag<f64>,
    /// Residuals, run by run.
    pub residuals: Vec<RunResidual>,
    /// Condition number of the Jacobian in (r_s/L, ln χ): how narrow the valley is.
    pub condition: f64,
    /// Correlation between r_s and ln χ.
    pub correlation: f64,
    /// Warnings.
    pub warnings: Vec<FitWarning>,
}

/// Warning about a fit.
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
        /// Number of runs.
        runs: usize,
    },
    /// The optimum has no sphere.
    NoSphere,
    /// One value deviates from those of the other runs.
    Outlier {
        /// Index of the run, in the campaign's order.
        run: usize,
        /// Quantity of the run.
        quantity: &'static str,
        /// Deviation in standard errors.
        standard_errors: f64,
    },
    /// Another dead band would explain the runs much better.
    DeadBand {
        /// Value of the swimmer file \[rad\].
        known: f64,
        /// Estimate of the runs \[rad\].
        found: f64,
        /// Gain in log-likelihood.
        gain: f64,
        /// Explanation that fits nearly as well, and its deviation.
        rival: Option<(&'static str, f64)>,
    },
    /// Another servo gain would explain the runs much better.
    Gain {
        /// Estimate of the runs.
        found: f64,
        /// Gain in log-likelihood.
        gain: f64,
        /// Explanation that fits nearly as well, and its deviation.
        rival: Option<(&'static str, f64)>,
    },
    /// Two runs hold the same cycles.
    SameRecording {
        /// Their files.
        files: [PathBuf; 2],
    },
    /// Some values come without an error: intervals rest on the residuals alone.
    NoErrors,
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
            Self::DeadBand {
                known,
                found,
                gain,
                rival,
            } => {
                write!(
                    f,
                    "the runs look as if the servos had a dead band of {:.1}°, where the swimmer file says {:.1}° (log-likelihood \
                     +{gain:.1}): r_s and chi are off if it is so; see --fit-also deadband, then [servo] dead_band in the swimmer file",
                    found.to_degrees(),
                    known.to_degrees()
                )?;
                alike(f, *rival)
            }
            Self::Gain { found, gain, rival } => {
                write!(
                    f,
                    "the runs look as if the servos turned {found:.4} times the commanded angle (log-likelihood +{gain:.1}): r_s and \
                     chi are off if it is so; see --fit-also gain, then slope_rad_per_us in the swimmer file or gain under [known] in \
                     the campaign"
                )?;
                alike(f, *rival)
            }
            Self::SameRecording { files: [a, b] } => write!(
                f,
                "{} and {} hold the same recording: one of them names the wrong file, or is there twice (leave one out by `exclude`)",
                short_name(a),
                short_name(b)
            ),
            Self::NoErrors => f.write_str(
                "values without an error (none stated, or runs of a single cycle): the intervals rest on the residuals of the fit, \
                 and nothing tests the model; state x_sd_mm with cycles, or x_se_mm (likewise delta_y and delta_theta), or record \
                 more cycles",
            ),
            Self::NoSphere => f.write_str("the best fit has no sphere: r_s = 0 is at its bound"),
            Self::ModelMisfit { ratio } => write!(
                f,
                "the runs miss the model by {ratio:.0} times what cycles deviate: something besides r_s and chi is not as assumed"
            ),
        }
    }
}

/// A file's name without its folder.
pub(crate) fn short_name(file: &Path) -> String {
    let name = file.file_name().unwrap_or(file.as_os_str());
    name.to_string_lossy().into_owned()
}

/// Writes the explanation that fits equally well.
fn alike(f: &mut std::fmt::Formatter<'_>, rival: Option<(&str, f64)>) -> std::fmt::Result {
    rival.map_or(Ok(()), |(name, gain)| {
        write!(
            f,
            "; a {name} explains them as well (+{gain:.1}), and these runs do not tell which"
        )
    })
}

/// The c_t form in words, as `c_t_form` reports it.
///
/// ```
/// use swimmer_model::TangentialDrag;
///
/// assert_eq!(calibrate::c_t_form(&TangentialDrag::LogAspect(4.543)), "log_aspect = 4.543");
/// ```
pub fn c_t_form(drag: &TangentialDrag<f64>) -> String {
    match drag {
        TangentialDrag::LogAspect(value) => format!("log_aspect = {value}"),
        TangentialDrag::HalfThickness(value) => format!("half_thickness = {value}"),
        TangentialDrag::OverViscosity(value) => format!("over_viscosity = {value}"),
        TangentialDrag::PerLink(Links {
            middle,
            front,
            back,
        }) => format!("over_viscosity = {{ middle = {middle}, front = {front}, back = {back} }}"),
    }
}

/// A run that is not in the fit.
#[derive(Debug, Clone)]
pub struct ExcludedRun {
    /// Its place in the campaign.
    pub index: usize,
    /// Its tracking file.
    pub file: PathBuf,
    /// Why: as the campaign says, or because of its sign.
    pub reason: String,
    /// `true` if the run was left out because it swims against the model.
    pub by_sign: bool,
    /// Its result, if it was evaluated.
    pub result: Option<RunResult>,
}

/// A campaign's outcome.
#[derive(Debug, Clone)]
pub struct CampaignFit {
    /// The swimmer that the fit started from.
    pub start: SwimmerFile,
    /// Prior knowledge that the campaign states.
    pub known: Known,
    /// The runs that were fitted, in the campaign's order.
    pub runs: Vec<RunResult>,
    /// Those that were not.
    pub excluded: Vec<ExcludedRun>,
    /// The fit.
    pub fit: Fit,
    /// The swimmer with the fitted parameters, ready to be saved.
    pub swimmer: SwimmerFile,
}

impl CampaignFit {
    /// L \[m\].
    pub(crate) fn length(&self) -> f64 {
        self.start.swimmer.total_length()
    }

    /// The paper's optimum, (r_s/L, ln χ).
    pub(crate) fn optimum(&self) -> [f64; 2] {
        [self.fit.sphere_radius / self.length(), self.fit.chi.ln()]
    }

    /// Responses of the servos by reflectors on the side links: the mean of the runs, front and back.
    /// An offset's error holds what half a millimetre (or what the campaign states) of the reflector's place makes of it.
    pub fn servos(&self) -> Option<[MeasuredServo; 2]> {
        let measured = |run: &RunResult| run.joints.as_ref()?.servos;
        let of_runs: Vec<[MeasuredServo; 2]> = self.runs.iter().filter_map(measured).collect();
        let reach = self.runs.iter().find_map(|run| run.played.sides)?.reach;
        let place = self.known.reflector.map_or(REFLECTOR, |known| known.width);
        let servo = |joint: usize| {
            let mean = |value: fn(&MeasuredServo) -> Option<Measured>| {
                let values = of_runs.iter().filter_map(|servos| value(&servos[joint]));
                combined(&values.collect::<Vec<_>>())
            };
            let offset = mean(|servo| Some(servo.offset))?;
            Some(MeasuredServo {
                gain: mean(|servo| Some(servo.gain))?,
                dead_band: mean(|servo| Some(servo.dead_band))?,
                offset: Measured {
                    error: offset.error.hypot(place / reach[joint]),
                    ..offset
                },
                lag: mean(|servo| servo.lag),
            })
        };
        Some([servo(0)?, servo(1)?])
    }

    /// Measured values of its runs.
    pub(crate) fn values(&self) -> Result<RunValues, FitError> {
        let played: Vec<&Played> = self.runs.iter().map(|run| &run.played).collect();
        RunValues::of(
            self.runs.iter().map(|run| (&run.cycles, run.errors)),
            &first_of_repeats(&played),
        )
    }

    /// The model of its runs with these parameters; cycles stay cut as they are.
    pub(crate) fn model(
        &self,
        data: &RunValues,
        parameters: Vec<Parameter>,
    ) -> Result<RunModel, FitError> {
        let Self {
            start,
            runs,
            swimmer,
            known,
            ..
        } = self;
        Ok(RunModel::of_runs(
            start,
            runs,
            (swimmer, known.tank.as_ref()),
            data.scales,
            parameters,
        )?)
    }

    /// The median of the runs' commanded periods \[s\], for a gait that no run swam.
    pub(crate) fn usual_period_s(&self) -> f64 {
        median(self.runs.iter().map(|run| run.played.period_s)).unwrap_or(1.0)
    }
}

/// The paper's fit of these runs, from this swimmer.
pub(crate) fn fit(
    start: &SwimmerFile,
    runs: Vec<Played>,
    data: &RunValues,
    level: f64,
) -> Result<Fit, FitError> {
    start.swimmer.validate()?;
    start
        .swimmer
        .common_drag()
        .map_err(InvalidSwimmer::Uncommon)?;
    if !(level > 0.0 && level < 1.0) {
        return Err(FitError::Level { level });
    }
    let parameters = vec![Parameter::SphereRadius, Parameter::Chi];
    let model = RunModel::new(start.clone(), runs, data.scales, parameters);
    let weights = data.papers_weights();
    let optimum = search(&model, data, &weights)?;
    summary(&model, data, &weights, &optimum, level).ok_or(FitError::NoConvergence { starts: 1 })
}

fn summary(
    model: &RunModel,
    data: &RunValues,
    weights: &[f64],
    optimum: &Minimum,
    level: f64,
) -> Option<Fit> {
    let start = &model.start.swimmer;
    let Swimmer {
        sphere_radius, chi, ..
    } = model.file(&optimum.at).swimmer;
    let spread = intervals::spread(optimum, data, weights, start.total_length(), level)?;
    let predicted = model.cycles(&optimum.at)?;
    let rows = optimum.residuals.chunks(QUANTITIES);
    let residuals: Vec<RunResidual> = rows
        .zip(weights.chunks(QUANTITIES))
        .zip(predicted)
        .enumerate()
        .map(|(run, ((residuals, weights), predicted))| {
            let left = |q: usize| {
                let row = QUANTITIES * run + q;
                if data.is_there(row) {
                    (residuals[q] + data.values[row] - data.own[row]) * data.scales[q]
                } else {
                    f64::NAN
                }
            };
            RunResidual {
                predicted,
                x_m: left(0),
                delta_y_m: left(1),
                delta_theta_rad: left(2),
                share: cost(residuals, weights),
            }
        })
        .collect();
    let mut warnings = Vec::new();
    if residuals.len() < 3 {
        warnings.push(FitWarning::FewRuns {
            runs: residuals.len(),
        });
    }
    if spread.correlation.abs() > 0.99 || spread.condition > 100.0 {
        warnings.push(FitWarning::Ridge {
            correlation: spread.correlation,
            condition: spread.condition,
        });
    }
    if sphere_radius < 1e-4 * start.total_length() {
        warnings.push(FitWarning::NoSphere);
    }
    if let Some(outlier) = spread.outlier {
        warnings.push(FitWarning::Outlier {
            run: outlier.row / QUANTITIES,
            quantity: NAMES[outlier.row % QUANTITIES],
            standard_errors: outlier.standard_errors,
        });
    }
    if !data.has_errors() {
        warnings.push(FitWarning::NoErrors);
    }
    if spread.misfit > 10.0 {
        warnings.push(FitWarning::ModelMisfit {
            ratio: spread.misfit,
        });
    }
    Some(Fit {
        sphere_radius,
        chi,
        rmse: optimum.cost.sqrt(),
        intervals: spread.intervals,
        c_t_form: start.tangential_drag,
        residuals,
        condition: spread.condition,
        correlation: spread.correlation,
        warnings,
    })
}
