//! Gaits for an uncertain swimmer: best in the worst case, or in the mean.

use gait_optimizer::{
    Condition, Objective, OptimalGait, Over, RobustError, RobustGait, Robustness, Uncertainty,
    Values, WorstCaseMember,
};
use serde::{Deserialize, Serialize};
use swimmer_files::{ArcKind, SwimmerFile};
use swimmer_model::{Gait as _, Model};

use super::timing::{self, TimedGait};
use super::{EfficiencyFigures, GaitOutput, Quarter, warn_if_beyond};
use crate::bounds::BoundsRequest;
use crate::fit_file::FitSource;
use crate::{Context, Error};

/// Evenly spaced instants of a cycle at which the power is evaluated.
const INSTANTS: u32 = 1024;

/// Statistic that a robust design maximises.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Statistic {
    /// The worst case over the intervals.
    #[default]
    Worst,
    /// The mean.
    Mean,
}

impl From<Statistic> for Over {
    fn from(statistic: Statistic) -> Self {
        match statistic {
            Statistic::Worst => Self::Worst,
            Statistic::Mean => Self::Mean,
        }
    }
}

impl From<Over> for Statistic {
    fn from(over: Over) -> Self {
        match over {
            Over::Worst => Self::Worst,
            Over::Mean => Self::Mean,
        }
    }
}

/// Uncertainty of a swimmer.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Request {
    /// A fit, whose intervals of the sphere's radius, χ and the servos' gain count.
    pub fit: Option<FitSource>,
    /// Interval of the servos' gain, actual over commanded angle, in place of that of the fit.
    pub gain: Option<[f64; 2]>,
    /// Statistic to maximise.
    pub over: Statistic,
}

impl Request {
    /// The uncertainty.
    ///
    /// # Errors
    /// The fit cannot be read, or a number is invalid.
    pub(super) fn uncertainty(
        &self,
        file: &SwimmerFile,
        context: &mut Context,
    ) -> Result<Uncertainty, Error> {
        let mut uncertainty = match &self.fit {
            Some(fit) => fit.uncertainty(context)?,
            None => Uncertainty::none(file.swimmer.sphere_radius, file.swimmer.chi),
        };
        uncertainty.gain_interval = self.gain.unwrap_or(uncertainty.gain_interval);
        uncertainty.validate()?;
        Ok(uncertainty)
    }
}

/// A robust gait with the paper's symmetries. The JSON document of `swimmer optimize … --robust`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "RobustOutput")
)]
pub struct Output {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Objective, for text output.
    #[serde(skip)]
    pub objective: Objective,
    /// Efficiency of the estimated swimmer.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub efficiency: f64,
    /// Displacement and arcs.
    #[serde(flatten)]
    pub quarter: Quarter,
    /// Cost and benefit of robustness.
    pub robust: RobustnessOutput,
    /// Numerical quality of an efficiency gait. The residual is that of the gradient over all members, and the power that of the
    /// estimated swimmer: one timing for all members is at constant power for none.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub figures: Option<EfficiencyFigures>,
    /// Certificate, timing and file.
    #[serde(flatten)]
    pub gait: GaitOutput,
}

/// Cost and benefit of robustness.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobustnessOutput {
    /// Statistic that was maximised.
    pub over: Statistic,
    /// Symbol of the quantity.
    pub quantity: &'static str,
    /// Values of the robust gait.
    pub robust: Values,
    /// Values of the optimum of the estimated swimmer.
    pub nominal_optimum: Values,
    /// Swimmers that hold the worst case.
    pub held_by: Vec<MemberOutput>,
    /// Number of swimmers among which the search for the worst case starts.
    pub worst_among: usize,
    /// Number of swimmers in the mean.
    pub mean_of: usize,
    /// The gait lies on another branch of optima than that of the estimated swimmer.
    pub off_branch: bool,
    /// Largest share of the cycle in which links cross, over all gains.
    pub largest_links_cross: f64,
    /// The same of the optimum of the estimated swimmer, with exact servos.
    pub nominal_optimum_links_cross: f64,
}

/// Swimmer that holds the worst case.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MemberOutput {
    /// Radius of the sphere \[m\].
    pub sphere_radius_m: f64,
    /// Drag ratio.
    pub chi: f64,
    /// Gain of the servos: actual over commanded angle.
    pub gain: f64,
    /// Its share of the first-order condition.
    pub multiplier: f64,
}

impl From<&WorstCaseMember> for MemberOutput {
    fn from(member: &WorstCaseMember) -> Self {
        Self {
            sphere_radius_m: member.sphere_radius,
            chi: member.chi,
            gain: member.gain,
            multiplier: member.multiplier,
        }
    }
}

impl RobustnessOutput {
    /// Describes the robustness of a gait in this quantity.
    pub(super) fn new(found: &Robustness, quantity: &'static str) -> Self {
        let [crossing, nominal_crossing] = found.links_cross;
        let (worst_among, mean_of) = found.members;
        Self {
            over: found.over.into(),
            quantity,
            robust: found.values,
            nominal_optimum: found.nominal,
            held_by: found.held_by.iter().map(Into::into).collect(),
            worst_among,
            mean_of,
            off_branch: found.off_branch,
            largest_links_cross: crossing,
            nominal_optimum_links_cross: nominal_crossing,
        }
    }
}

/// The gait as its file states it: the best gait of many swimmers is no optimum of one, and the file claims none.
pub(super) fn as_written(gait: &OptimalGait) -> OptimalGait {
    let mut gait = gait.clone();
    gait.objective = Objective::Unspecified;
    gait
}

/// Failure of a robust design, with the options that caused it.
pub(super) fn refused(error: RobustError, bounds: &BoundsRequest) -> Error {
    let options = match &error {
        RobustError::Arc { kind } => bounds.options(Some(*kind)),
        RobustError::Clearance => bounds.options(Some(ArcKind::Clearance)),
        RobustError::Bound { .. } => bounds.options(None),
        _ => Vec::new(),
    };
    let mut error = Error::from(error);
    if !options.is_empty() {
        let leave = format!("; leave out {}", options.join(" and "));
        error.message.push_str(&leave);
    }
    error
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

/// Describes a robust gait with the paper's symmetries. Warns if it exceeds a limit of the robot.
pub(super) fn describe(
    file: &SwimmerFile,
    (found, seconds): (RobustGait, Option<f64>),
    timing: Option<timing::Request>,
    context: &mut Context,
) -> Result<Output, Error> {
    let RobustGait {
        gait, robustness, ..
    } = found;
    let written = as_written(&gait);
    warn_if_beyond(file, &gait, context);
    let timed = TimedGait::new(timing, &file.name, &written)?;
    let is_efficiency = gait.objective == Objective::Efficiency;
    let efficiency = match &timed {
        Some(timed) if is_efficiency => timed.efficiency,
        _ => gait.efficiency,
    };
    let quantity = if is_efficiency { "ξ" } else { "X/L" };
    Ok(Output {
        name: file.name.clone(),
        objective: gait.objective,
        efficiency,
        quarter: Quarter::new(&gait),
        robust: RobustnessOutput::new(&robustness, quantity),
        figures: EfficiencyFigures::of_certificate(
            &gait,
            Condition::RobustGradient,
            power_variation,
        ),
        gait: GaitOutput::new(&file.name, &written, timed, seconds),
    })
}

impl From<RobustError> for Error {
    /// An invalid problem is bad input; one that does not converge is a failure.
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
            _ => Self::failed(&error),
        }
    }
}
