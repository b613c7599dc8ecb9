//! Optimal gaits: one module for each objective.
//!
//! Each search returns a gait with its certificate. The outputs are the JSON documents of `swimmer optimize`.

mod closed;
pub mod displacement;
pub mod efficiency;
mod playable;
pub mod robust;
pub mod sideways;
pub mod speed;
pub mod steer;
pub mod timing;
pub mod turning;

use std::path::PathBuf;

use gait_optimizer::{Arc, Certificate, Condition, Method, Objective, OptimalGait};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use swimmer_files::{AnyGait, GaitFile, SwimmerFile};

pub use self::closed::{ClosedCurve, STARTS};
pub use self::playable::searched;
use self::timing::{GaitTiming, TimedGait};
use crate::context::Timed;
use crate::{Context, Error, robot_limits};

/// `true` with the searches that the lab page leaves out. A constant, so that the linker drops what they call.
const ALL_SEARCHES: bool = cfg!(feature = "all-searches");

/// Refusal of a search that the lab page leaves out.
fn left_out(search: &str) -> Error {
    Error::refused(format!(
        "{search} is no part of the lab page: use the command `swimmer optimize`"
    ))
}

/// Search for the best gait of an objective.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "Value")]
pub enum Request {
    /// Most displacement per cycle.
    Displacement(displacement::Request),
    /// Most Lighthill efficiency.
    Efficiency(efficiency::Request),
    /// Most rotation per cycle.
    Turning(turning::Request),
    /// Most displacement across the heading.
    Sideways(sideways::Request),
    /// Most displacement per time.
    Speed(speed::Request),
}

/// Distinguished by the key `objective`. By way of a JSON value: a tagged enum buffers numbers, and how depends on features of
/// `serde_json` that other crates enable.
impl TryFrom<Value> for Request {
    type Error = String;

    fn try_from(value: Value) -> Result<Self, String> {
        let objective = value.get("objective").and_then(Value::as_str);
        let request = match objective {
            Some("displacement") => serde_json::from_value(value).map(Self::Displacement),
            Some("efficiency") => serde_json::from_value(value).map(Self::Efficiency),
            Some("turning") => serde_json::from_value(value).map(Self::Turning),
            Some("sideways") => serde_json::from_value(value).map(Self::Sideways),
            Some("speed") => serde_json::from_value(value).map(Self::Speed),
            _ => {
                return Err(
                    "`objective` is displacement, efficiency, turning, sideways or speed"
                        .to_owned(),
                );
            }
        };
        request.map_err(|error| error.to_string())
    }
}

/// Best gait of an objective.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "OptimizeOutput")
)]
#[serde(untagged)]
pub enum Output {
    /// Most displacement per cycle.
    Displacement(displacement::Output),
    /// Most Lighthill efficiency.
    Efficiency(efficiency::Output),
    /// Most rotation per cycle.
    Turning(turning::Output),
    /// Most displacement across the heading.
    Sideways(sideways::Output),
    /// Most displacement per time.
    Speed(Box<speed::Output>),
}

impl Output {
    /// The gait.
    pub fn gait(&self) -> &GaitOutput {
        match self {
            Self::Displacement(output) => output.gait(),
            Self::Efficiency(output) => output.gait(),
            Self::Turning(output) => &output.gait,
            Self::Sideways(output) => &output.gait,
            Self::Speed(output) => &output.gait,
        }
    }
}

/// Finds the best gait of an objective.
///
/// # Errors
/// As the search of the objective.
pub fn run(request: &Request, context: &mut Context) -> Result<Output, Error> {
    Ok(match request {
        Request::Displacement(request) => {
            Output::Displacement(displacement::run(request, context)?)
        }
        Request::Efficiency(request) => Output::Efficiency(efficiency::run(request, context)?),
        Request::Turning(request) => Output::Turning(turning::run(request, context)?),
        Request::Sideways(request) => Output::Sideways(sideways::run(request, context)?),
        Request::Speed(request) => Output::Speed(Box::new(speed::run(request, context)?)),
    })
}

/// Gait of an output: certificate, timing, file.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GaitOutput {
    /// Share of the cycle in which links cross.
    pub links_cross: f64,
    /// Timing under a limit on the servos' rate, if one was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timing: Option<GaitTiming>,
    /// Certificate.
    pub certificate: Certificate,
    /// Duration of the search \[s\], if the front end has a clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// Gait file, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gait: Option<PathBuf>,
    /// Content of that file.
    #[serde(skip)]
    pub file: GaitFile,
}

impl GaitOutput {
    /// Describes a gait, as it is timed.
    fn new(name: &str, gait: &OptimalGait, timed: Option<TimedGait>, seconds: Option<f64>) -> Self {
        let (timing, file) = match timed {
            Some(TimedGait { timing, file, .. }) => (Some(timing), file),
            None => (None, gait.gait_file(name)),
        };
        Self {
            links_cross: gait.links_cross,
            timing,
            certificate: gait.certificate.clone(),
            seconds,
            gait: None,
            file,
        }
    }
}

/// Displacement and arcs of a gait with the paper's symmetries, from its first quarter.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Quarter {
    /// Displacement per cycle over the total length, with its sign.
    pub displacement_over_length: f64,
    /// Displacement per cycle \[m\].
    pub displacement_m: f64,
    /// φ₁ = φ₂ at the start \[rad\].
    pub start_angle_rad: f64,
    /// φ₂ = −φ₁ at the end of the quarter \[rad\].
    pub end_angle_rad: f64,
    /// The gait runs clockwise, and the quarter is that of the counter-clockwise gait; displacement gaits only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clockwise: Option<bool>,
    /// Arcs in order.
    pub arcs: Vec<Arc>,
}

impl Quarter {
    fn new(gait: &OptimalGait) -> Self {
        Self {
            displacement_over_length: gait.displacement_over_length,
            displacement_m: gait.displacement,
            start_angle_rad: gait.start_angle,
            end_angle_rad: gait.end_angle,
            clockwise: (gait.objective == Objective::Displacement).then(|| gait.is_clockwise()),
            arcs: gait.arcs.clone(),
        }
    }
}

/// Numerical quality of an efficiency gait.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EfficiencyFigures {
    /// Largest residual: of the shooting conditions, or of the gradient of ln ξ for a robust gait.
    pub residual: Option<f64>,
    /// (max − min)/mean of the power.
    pub power_variation: Option<f64>,
    /// Method of the initial guess.
    pub method: &'static str,
    /// Efficiency by that method, if it is a solver of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direct_efficiency: Option<f64>,
}

impl EfficiencyFigures {
    /// Figures that the solver reports.
    fn of_solver(gait: &OptimalGait) -> Option<Self> {
        gait.efficiency_figures.map(|figures| Self {
            residual: Some(figures.residual),
            power_variation: Some(figures.power_variation),
            method: figures.method,
            direct_efficiency: figures.direct_efficiency,
        })
    }

    /// Figures of a gait that was optimised as a Fourier series first, from its certificate; `None` for other objectives.
    pub(crate) fn of_certificate(
        gait: &OptimalGait,
        residual: Condition,
        power_variation: impl FnOnce(&OptimalGait) -> Option<f64>,
    ) -> Option<Self> {
        (gait.objective == Objective::Efficiency).then(|| Self {
            residual: gait.certificate.value(residual),
            power_variation: power_variation(gait),
            method: Method::Fourier.word(),
            direct_efficiency: None,
        })
    }
}

/// Warns if the gait exceeds a limit of the file's robot, or its torque or fluid, at the default period.
fn warn_if_beyond(file: &SwimmerFile, gait: &OptimalGait, context: &mut Context) {
    if let Ok(curve) = AnyGait::from_file(&gait.gait_file(&file.name)) {
        robot_limits::warn_if_beyond(file, &curve, robot_limits::PERIOD_S, context);
    }
}

/// Separates the duration of a stage from its result.
fn split<T>(timed: Timed<Result<T, Error>>) -> Result<(T, Option<f64>), Error> {
    Ok((timed.result?, timed.seconds))
}
