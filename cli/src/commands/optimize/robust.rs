//! `--robust FIT.json` and `--gain LOW HIGH`: the gait for a robot that is known as well as it is.

use std::path::PathBuf;

use clap::ValueEnum;
use gait_optimizer::{
    Condition, Objective, OptimalGait, Over, RobustError, RobustGait, Robustness, Uncertainty,
    Values, WorstCaseMember,
};
use swimmer_files::{ArcKind, SwimmerFile};
use swimmer_model::{Gait as _, Model};

use super::output::{add_figures, add_quarter, say_if_beyond};
use super::timing::ServoTiming;
use super::{SearchResult, Task};
use crate::arguments::gain;
use crate::bounds::Given;
use crate::document::{Document, object};
use crate::failure::{Failure, Outcome};
use crate::fit_file::load_fit;

/// Evenly spaced instants of a cycle at which the power is looked at.
const INSTANTS: u32 = 1024;

/// Uncertainty, and the statistic to maximise.
#[derive(Debug, clap::Args)]
pub(super) struct Robustly {
    /// Design for all that this fit (of swimmer calibrate: fit.json, or its --json) leaves open of the sphere's radius and χ, and
    /// of the servos' gain where it was fitted along
    #[arg(long, value_name = "FIT.json")]
    robust: Option<PathBuf>,
    /// Design for servos with a gain (actual over commanded angle) in this interval, as 0.98 1.02; bounds and rates apply to the
    /// command
    #[arg(long, value_names = ["LOW", "HIGH"], value_parser = gain, num_args = 2)]
    gain: Vec<f64>,
    /// Of --robust or --gain: maximise the worst case over the intervals (of radius and χ their ellipse, if the fit has the
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
    /// The uncertainty and the statistic. Returns `None` without `--robust` and `--gain`.
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

/// Failure of a robust design, with the options that caused it.
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
        answered @ Failure::AlreadyPrinted(_) => answered,
    }
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

/// A robust gait with the paper's symmetries, best in this quantity of this name.
pub(super) fn robust_gait(
    task: &Task,
    (objective, quantity): (&str, &'static str),
    found: RobustGait,
    timing: &ServoTiming,
) -> Outcome<SearchResult> {
    let RobustGait {
        gait, robustness, ..
    } = found;
    let written = as_written(&gait);
    say_if_beyond(task, &gait);
    let timed = timing.of(task, &written)?;
    let mut document = Document::new(format!("{}, most {objective}, robust", task.file.name));
    // Of the estimates' swimmer.
    let efficiency = match &timed {
        Some(timed) if gait.objective == Objective::Efficiency => timed.efficiency,
        _ => gait.efficiency,
    };
    document.key("efficiency", efficiency);
    add_quarter(&mut document, &gait);
    add_robustness(&mut document, &robustness, quantity);
    // The gradient of ln ξ̄ [1/rad] for the members as they are weighed: no single swimmer's shooting conditions hold. The power is
    // that of the estimates' swimmer: one timing for all members is at constant power for none.
    add_figures(
        &mut document,
        &gait,
        Condition::RobustGradient,
        power_variation,
    );
    Ok(SearchResult::gait(document, task, &written, timed))
}

/// Adds cost and benefit of robustness, the members of the worst case, and the differences from the nominal optimum.
pub(super) fn add_robustness(document: &mut Document, found: &Robustness, quantity: &'static str) {
    let (robust, nominal) = (&found.values, &found.nominal);
    let [crossing, nominal_crossing] = found.links_cross;
    let values = |values: &Values| object! {"nominal": values.nominal, "worst": values.worst, "mean": values.mean};
    let holder = |holder: &WorstCaseMember| {
        object! {
            "sphere_radius_m": holder.sphere_radius,
            "chi": holder.chi,
            "gain": holder.gain,
            "multiplier": holder.multiplier,
        }
    };
    document.key(
        "robust",
        object! {
            "over": match found.over {
                Over::Worst => "worst",
                Over::Mean => "mean",
            },
            "quantity": quantity,
            "robust": values(robust),
            "nominal_optimum": values(nominal),
            "held_by": found.held_by.iter().map(holder).collect::<Vec<_>>(),
            "worst_among": found.members.0,
            "mean_of": found.members.1,
            "off_branch": found.off_branch,
            "largest_links_cross": crossing,
            "nominal_optimum_links_cross": nominal_crossing,
        },
    );
    for (name, ours, theirs) in [
        ("as estimated", robust.nominal, nominal.nominal),
        ("worst case", robust.worst, nominal.worst),
        ("mean", robust.mean, nominal.mean),
    ] {
        document.row(
            name,
            format!(
                "{quantity} = {ours:.8}, the nominal optimum {theirs:.8} ({:+.3} %)",
                (ours / theirs - 1.0) * 100.0 + 0.0
            ),
        );
    }
    for holder in &found.held_by {
        let gain = if (holder.gain - 1.0).abs() < 1e-12 {
            String::new()
        } else {
            format!(", gain {:.4}", holder.gain)
        };
        document.row(
            "held by",
            format!(
                "r_s = {:.3} mm, χ = {:.4}{gain} (multiplier {:.3})",
                holder.sphere_radius * 1e3,
                holder.chi,
                holder.multiplier
            ),
        );
    }
    if found.off_branch {
        document.row(
            "note",
            "this gait lies on another branch than the nominal optimum, which is not the best gait near it",
        );
    }
    if crossing > nominal_crossing + 1e-6 {
        document.row(
            "note",
            format!(
                "its links cross on {:.1} % of the cycle at most, those of the nominal optimum on {:.1} %",
                crossing * 100.0,
                nominal_crossing * 100.0
            ),
        );
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
