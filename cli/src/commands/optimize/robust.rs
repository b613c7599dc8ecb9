//! `--robust FIT.json`: the gait for a swimmer that is known as well as a calibration knows it.

use std::fmt;
use std::path::PathBuf;

use clap::ValueEnum;
use gait_optimizer::{OptimalGait, Over, RobustError, RobustGait, Uncertainty, Values};
use serde::Serialize;
use swimmer_model::{Gait as _, Model};

use super::answer::{Closing, Figures, Quarter};
use super::timing::TimingAnswer;
use crate::failure::{Failure, Outcome};
use crate::fit_file::load_fit;
use crate::quantity::Rows;

/// Evenly spaced instants of a cycle at which the power is looked at.
const INSTANTS: u32 = 1024;

/// What is uncertain, and what is made of it.
#[derive(Debug, clap::Args)]
pub(super) struct Robustly {
    /// Design for all that this fit (of swimmer calibrate: fit.json, or its --json) leaves open of the sphere's radius and χ
    #[arg(long, value_name = "FIT.json")]
    robust: Option<PathBuf>,
    /// Maximise the worst case over the intervals (their ellipse, where the fit tells the correlation) or the mean
    #[arg(
        long,
        value_name = "WHAT",
        default_value = "worst",
        requires = "robust"
    )]
    over: Which,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Which {
    Worst,
    Mean,
}

impl Robustly {
    /// What the fit leaves open and what shall be maximised, if that was asked for.
    pub(super) fn load(&self) -> Outcome<Option<(Uncertainty, Over)>> {
        let Some(path) = &self.robust else {
            return Ok(None);
        };
        let over = match self.over {
            Which::Worst => Over::Worst,
            Which::Mean => Over::Mean,
        };
        Ok(Some((load_fit(path)?, over)))
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
    robust: Robustness,
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

#[derive(Debug, Serialize)]
struct Robustness {
    over: &'static str,
    quantity: &'static str,
    /// What the robust gait brings.
    robust: Brings,
    /// What the nominal optimum of the same family brings.
    nominal_optimum: Brings,
    /// The swimmers that hold the worst case.
    held_by: Vec<Holder>,
    worst_among: usize,
    mean_of: usize,
    /// The robust gait is better for the estimates, too: the nominal branch does not reach it.
    off_branch: bool,
}

#[derive(Debug, Serialize)]
struct Brings {
    nominal: f64,
    worst: f64,
    mean: f64,
}

impl From<Values> for Brings {
    fn from(values: Values) -> Self {
        Self {
            nominal: values.nominal,
            worst: values.worst,
            mean: values.mean,
        }
    }
}

#[derive(Debug, Serialize)]
struct Holder {
    sphere_radius_m: f64,
    chi: f64,
    multiplier: f64,
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
            figures: Figures::of(gait, "robust_gradient", power_variation),
            robust: Robustness {
                over: match found.over {
                    Over::Worst => "worst",
                    Over::Mean => "mean",
                },
                quantity,
                robust: found.values.into(),
                nominal_optimum: found.nominal.into(),
                held_by: found
                    .held_by
                    .iter()
                    .map(|&[sphere_radius_m, chi, multiplier]| Holder {
                        sphere_radius_m,
                        chi,
                        multiplier,
                    })
                    .collect(),
                worst_among: found.members.0,
                mean_of: found.members.1,
                off_branch: found.off_branch(),
            },
            closing: Closing::new(gait, timing, seconds, file),
        }
    }
}

impl fmt::Display for RobustAnswer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        self.quarter.rows(&mut rows);
        let Robustness {
            robust,
            nominal_optimum,
            quantity,
            ..
        } = &self.robust;
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
        for holder in &self.robust.held_by {
            rows.row(
                "held by",
                format!(
                    "r_s = {:.3} mm, χ = {:.4} (multiplier {:.3})",
                    holder.sphere_radius_m * 1e3,
                    holder.chi,
                    holder.multiplier
                ),
            );
        }
        if self.robust.off_branch {
            rows.row(
                "note",
                "this gait is better for the estimates, too: it lies on another branch than the nominal optimum",
            );
        }
        self.closing.rows(&mut rows);
        write!(f, "{}\n{rows}", self.title)
    }
}

impl From<RobustError> for Failure {
    /// A problem that makes no sense is bad input; one that does not come out was tried.
    fn from(error: RobustError) -> Self {
        match error {
            RobustError::Nominal(error) => error.into(),
            RobustError::Swimmer(_)
            | RobustError::Uncertainty { .. }
            | RobustError::Order { .. }
            | RobustError::Structure { .. } => Self::bad_input(&error),
            _ => Self::tried(&error),
        }
    }
}
