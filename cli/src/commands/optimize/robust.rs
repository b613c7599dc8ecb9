//! `--robust FIT.json` and `--gain LOW HIGH`: the gait for a robot that is known as well as it is.

use std::fmt;
use std::path::PathBuf;

use clap::ValueEnum;
use gait_optimizer::{
    Condition, Holder, Objective, OptimalGait, Over, RobustError, RobustGait, Robustness,
    Uncertainty, Values,
};
use serde::Serialize;
use swimmer_files::{ArcKind, SwimmerFile};
use swimmer_model::{Gait as _, Model};

use super::answer::{Closing, Figures, Quarter};
use super::timing::TimingAnswer;
use crate::arguments::gain;
use crate::bounds::Given;
use crate::failure::{Failure, Outcome};
use crate::fit_file::load_fit;
use crate::quantity::Rows;

/// Evenly spaced instants of a cycle at which the power is looked at.
const INSTANTS: u32 = 1024;

/// What is uncertain, and what is made of it.
#[derive(Debug, clap::Args)]
pub(super) struct Robustly {
    /// Design for all that this fit (of swimmer calibrate: fit.json, or its --json) leaves open of the sphere's radius and χ, and
    /// of the servos' gain where it was fitted along
    #[arg(long, value_name = "FIT.json")]
    robust: Option<PathBuf>,
    /// Design for servos that turn between so many times what they are told, as 0.98 1.02; bounds and rates are about what is told
    #[arg(long, value_names = ["LOW", "HIGH"], value_parser = gain, num_args = 2)]
    gain: Vec<f64>,
    /// Of --robust or --gain: maximise the worst case over the intervals (of radius and χ their ellipse, where the fit tells the
    /// correlation), which is the default, or the mean
    #[arg(long, value_name = "WHAT")]
    over: Option<Which>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Which {
    Worst,
    Mean,
}

impl Robustly {
    /// What is left open and what shall be maximised, if that was asked for.
    pub(super) fn load(&self, file: &SwimmerFile) -> Outcome<Option<(Uncertainty, Over)>> {
        let gain: Option<[f64; 2]> = self.gain.as_slice().try_into().ok();
        let mut uncertainty = match (&self.robust, gain) {
            (Some(path), _) => load_fit(path)?,
            (None, Some(_)) => Uncertainty::none(file.swimmer.sphere_radius, file.swimmer.chi),
            (None, None) if self.over.is_some() => {
                return Err(Failure::BadInput(
                    "--over says what a robust design maximises: give --robust FIT.json or --gain LOW HIGH"
                        .to_owned(),
                ));
            }
            (None, None) => return Ok(None),
        };
        uncertainty.gain_interval = gain.unwrap_or(uncertainty.gain_interval);
        uncertainty.validate()?;
        let over = match self.over {
            None | Some(Which::Worst) => Over::Worst,
            Some(Which::Mean) => Over::Mean,
        };
        Ok(Some((uncertainty, over)))
    }
}

/// The gait as it is written: what is best of many swimmers is no optimum of one, and the file claims none.
pub(super) fn as_written(gait: &OptimalGait) -> OptimalGait {
    let mut gait = gait.clone();
    gait.objective = Objective::Unspecified;
    gait
}

/// Why there is no robust gait, with the options that were in the way.
pub(super) fn refused(error: RobustError, bounds: &impl Given) -> Failure {
    let options = match &error {
        RobustError::Arc { kind } => bounds.given(Some(*kind)),
        RobustError::Clearance => bounds.given(Some(ArcKind::Clearance)),
        RobustError::Bound { .. } => bounds.given(None),
        _ => Vec::new(),
    };
    let failure = Failure::from(error);
    if options.is_empty() {
        return failure;
    }
    let leave = format!("; leave out {}", options.join(" and "));
    match failure {
        Failure::BadInput(text) => Failure::BadInput(text + &leave),
        Failure::Tried(text) => Failure::Tried(text + &leave),
        answered @ Failure::Answered(_) => answered,
    }
}

/// A robust gait and what robustness costs and brings.
#[derive(Debug, Serialize)]
pub(super) struct RobustAnswer {
    #[serde(skip)]
    title: String,
    /// Of the estimates' swimmer.
    efficiency: f64,
    #[serde(flatten)]
    quarter: Quarter,
    robust: Brings,
    #[serde(flatten)]
    figures: Option<Figures>,
    #[serde(flatten)]
    closing: Closing,
}

/// (max − min)/mean of the power along the gait as it is timed.
fn power_variation(gait: &OptimalGait) -> Option<f64> {
    let model = Model::new(&gait.swimmer.of_unit_length()).ok()?;
    let curve = gait.gait().ok()?;
    let powers: Vec<f64> = (0..INSTANTS)
        .map(|instant| {
            let at = curve.at(f64::from(instant) / f64::from(INSTANTS));
            at.rate.dot(&(model.power_matrix(&at.phi) * at.rate))
        })
        .collect();
    let most = powers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = powers.iter().copied().fold(f64::INFINITY, f64::min);
    Some((most - least) * f64::from(INSTANTS) / powers.iter().sum::<f64>())
}

/// What robustness costs and brings, as every objective tells it.
#[derive(Debug, Serialize)]
pub(super) struct Brings {
    over: &'static str,
    quantity: &'static str,
    /// What the robust gait brings.
    robust: Valued,
    /// What the nominal optimum of the same family brings.
    nominal_optimum: Valued,
    /// The swimmers that hold the worst case.
    held_by: Vec<Held>,
    /// Swimmers from which the worst case was looked for downhill.
    worst_among: usize,
    mean_of: usize,
    /// The robust gait lies on another branch of optima than the nominal one.
    off_branch: bool,
    /// Share of the cycle in which links cross: of the robust gait with any of the gains, and of the nominal optimum.
    largest_links_cross: f64,
    nominal_optimum_links_cross: f64,
}

#[derive(Debug, Serialize)]
struct Valued {
    nominal: f64,
    worst: f64,
    mean: f64,
}

impl From<Values> for Valued {
    fn from(values: Values) -> Self {
        Self {
            nominal: values.nominal,
            worst: values.worst,
            mean: values.mean,
        }
    }
}

#[derive(Debug, Serialize)]
struct Held {
    sphere_radius_m: f64,
    chi: f64,
    gain: f64,
    multiplier: f64,
}

impl From<&Holder> for Held {
    fn from(holder: &Holder) -> Self {
        Self {
            sphere_radius_m: holder.sphere_radius,
            chi: holder.chi,
            gain: holder.gain,
            multiplier: holder.multiplier,
        }
    }
}

impl Brings {
    pub(super) fn new(found: &Robustness, quantity: &'static str) -> Self {
        let [largest_links_cross, nominal_optimum_links_cross] = found.links_cross;
        Self {
            over: match found.over {
                Over::Worst => "worst",
                Over::Mean => "mean",
            },
            quantity,
            robust: found.values.into(),
            nominal_optimum: found.nominal.into(),
            held_by: found.held_by.iter().map(Held::from).collect(),
            worst_among: found.members.0,
            mean_of: found.members.1,
            off_branch: found.off_branch,
            largest_links_cross,
            nominal_optimum_links_cross,
        }
    }

    /// Beside the nominal optimum, who holds the worst case, and what is other than of the nominal optimum.
    pub(super) fn rows(&self, rows: &mut Rows) {
        let Self {
            robust,
            nominal_optimum,
            quantity,
            ..
        } = self;
        for (name, ours, theirs) in [
            ("as estimated", robust.nominal, nominal_optimum.nominal),
            ("worst case", robust.worst, nominal_optimum.worst),
            ("mean", robust.mean, nominal_optimum.mean),
        ] {
            rows.row(
                name,
                format!(
                    "{quantity} = {ours:.8}, the nominal optimum {theirs:.8} ({:+.3} %)",
                    (ours / theirs - 1.0) * 100.0 + 0.0
                ),
            );
        }
        for holder in &self.held_by {
            let gain = if (holder.gain - 1.0).abs() < 1e-12 {
                String::new()
            } else {
                format!(", gain {:.4}", holder.gain)
            };
            rows.row(
                "held by",
                format!(
                    "r_s = {:.3} mm, χ = {:.4}{gain} (multiplier {:.3})",
                    holder.sphere_radius_m * 1e3,
                    holder.chi,
                    holder.multiplier
                ),
            );
        }
        if self.off_branch {
            rows.row(
                "note",
                "this gait lies on another branch than the nominal optimum, which is not the best gait near it",
            );
        }
        if self.largest_links_cross > self.nominal_optimum_links_cross + 1e-6 {
            rows.row(
                "note",
                format!(
                    "its links cross on {:.1} % of the cycle at most, those of the nominal optimum on {:.1} %",
                    self.largest_links_cross * 100.0,
                    self.nominal_optimum_links_cross * 100.0
                ),
            );
        }
    }
}

impl RobustAnswer {
    pub(super) fn new(
        title: String,
        quantity: &'static str,
        found: &RobustGait,
        timing: Option<TimingAnswer>,
        (seconds, file): (f64, Option<PathBuf>),
    ) -> Self {
        let gait = &found.gait;
        Self {
            title,
            efficiency: gait.efficiency,
            quarter: gait.into(),
            // The gradient of ln ξ̄ [1/rad] for the members as they are weighed: no single swimmer's shooting conditions hold. The
            // power is that of the estimates' swimmer: one timing for all members is at constant power for none.
            figures: Figures::of(gait, Condition::RobustGradient, power_variation),
            robust: Brings::new(&found.robustness, quantity),
            closing: Closing::new(gait, timing, seconds, file),
        }
    }
}

impl fmt::Display for RobustAnswer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        self.quarter.rows(&mut rows);
        self.robust.rows(&mut rows);
        self.closing.rows(&mut rows);
        write!(f, "{}\n{rows}", self.title)
    }
}

impl From<RobustError> for Failure {
    /// A problem that makes no sense is bad input; one that does not come out was tried.
    fn from(error: RobustError) -> Self {
        match error {
            RobustError::Nominal(error) => error.into(),
            RobustError::NominalSpeed(error) => error.into(),
            RobustError::Swimmer(_)
            | RobustError::Arc { .. }
            | RobustError::Clearance
            | RobustError::Uncertainty { .. }
            | RobustError::Order { .. }
            | RobustError::Structure { .. } => Self::bad_input(&error),
            _ => Self::tried(&error),
        }
    }
}
