//! Fastest gaits that servos of a given rate can play.

use std::path::PathBuf;

use gait_optimizer::{
    Arc, Fastest, Front, HeadingRule, SpeedError, SpeedProblem, fastest, front, robust_speed,
};
use serde::{Deserialize, Serialize};
use swimmer_files::{AnyGait, ServoFile, SwimmerFile};

use super::robust::{self, RobustnessOutput};
use super::{ALL_SEARCHES, GaitOutput, left_out, split};
use crate::bounds::BoundsRequest;
use crate::context::Stage;
use crate::robot_limits::{self, PlayedSpeed, servo_rates};
use crate::{Context, Error, SwimmerSource};

/// Direction of the displacement, relative to the mean heading.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Heading {
    /// Any.
    #[default]
    Any,
    /// Along the mean heading.
    Forward,
    /// Across it.
    Sideways,
}

/// Search for the fastest gait.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Request {
    /// The swimmer.
    pub swimmer: SwimmerSource,
    /// Largest rate of the servos \[rad/s\]: one for both, or one for each. Empty for those of a playable gait.
    #[serde(default)]
    pub max_rate: Vec<f64>,
    /// Direction of the displacement.
    #[serde(default)]
    pub heading: Heading,
    /// Period \[s\] of the farthest gait, in place of the fastest gait of any period.
    #[serde(default)]
    pub period: Option<f64>,
    /// Bounds on the shapes.
    #[serde(default)]
    pub bounds: BoundsRequest,
    /// Uncertainty to design for.
    #[serde(default)]
    pub robust: Option<robust::Request>,
    /// Also compute the farthest gaits of shorter and longer periods.
    #[serde(default)]
    pub front: bool,
}

/// The gait. The JSON document of `swimmer optimize speed`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SpeedOutput")
)]
pub struct Output {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Total length of the swimmer \[m\], for text output.
    #[serde(skip)]
    pub length: f64,
    /// Displacement over the period, over the total length \[1/s\].
    pub speed_over_length_per_s: f64,
    /// Displacement over the period \[m/s\].
    pub speed_m_per_s: f64,
    /// Displacement per cycle over the total length.
    pub displacement_over_length: f64,
    /// Displacement per cycle \[m\].
    pub displacement_m: f64,
    /// Period \[s\].
    pub period_s: f64,
    /// Direction of the displacement relative to the mean heading \[rad\].
    pub heading_rad: f64,
    /// Net rotation \[rad\].
    pub rotation_rad: f64,
    /// Rest at the end of the period \[s\], if the period is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest_s: Option<f64>,
    /// Duration of the motion before the rest \[s\], for text output.
    #[serde(skip)]
    pub motion_s: Option<f64>,
    /// Arcs in order.
    pub arcs: Vec<Arc>,
    /// Fractions of the period at which a servo reverses or stops.
    pub corners: Vec<f64>,
    /// Largest number of corners of a cycle.
    pub max_corners: usize,
    /// Number of closed curves from which the search starts.
    pub starts: usize,
    /// Number of starts that led to this gait.
    pub found: usize,
    /// Speed of a certified cycle with more corners, if it is better by more than 1e-6.
    pub longer_speed_over_length_per_s: Option<f64>,
    /// Speed of a faster chain of arcs that failed its certificate.
    pub uncertified_speed_over_length_per_s: Option<f64>,
    /// Cost and benefit of robustness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robust: Option<RobustnessOutput>,
    /// Speed of the fastest gait of any heading, if a heading is prescribed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub any_heading_speed_over_length_per_s: Option<f64>,
    /// Speed as the robot plays the gait.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub played: Option<PlayedSpeed>,
    /// File of the farthest gaits, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub front: Option<FrontOutput>,
    /// Farthest gaits, for the figure or table.
    #[serde(skip)]
    pub farthest: Option<Front>,
    /// Certificate and file.
    #[serde(flatten)]
    pub gait: GaitOutput,
}

/// File of the farthest gaits in shorter and longer periods.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FrontOutput {
    /// Path.
    pub file: PathBuf,
    /// Number of periods.
    pub periods: usize,
    /// Number of periods with a farthest gait.
    #[serde(rename = "told")]
    pub periods_with_gait: usize,
}

impl FrontOutput {
    /// Describes a file of these gaits.
    pub fn new(file: PathBuf, front: &Front) -> Self {
        Self {
            file,
            periods: front.periods.len(),
            periods_with_gait: front.farthest.iter().flatten().count(),
        }
    }
}

/// Finds the gait. Warns if it exceeds a limit of the robot.
///
/// # Errors
/// The request is invalid, or the search finds no certified gait.
pub fn run(request: &Request, context: &mut Context) -> Result<Output, Error> {
    let file = request.swimmer.load(context)?;
    let is_playable = request.bounds.playable;
    let rates = servo_rates(&request.max_rate, is_playable, &file)
        .ok_or_else(|| Error::refused("give --max-rate or --playable"))?;
    let heading = match request.heading {
        Heading::Any => HeadingRule::Any,
        Heading::Forward => HeadingRule::Forward,
        Heading::Sideways => HeadingRule::Sideways,
    };
    let problem = SpeedProblem {
        bounds: request.bounds.of(&file),
        period: request.period,
        threads: context.threads,
        ..SpeedProblem::new(file.swimmer, rates).led(heading)
    };
    let uncertainty = match &request.robust {
        Some(robust) => Some((robust.uncertainty(&file, context)?, robust.over.into())),
        None => None,
    };
    if !ALL_SEARCHES && (uncertainty.is_some() || request.front) {
        return Err(left_out(
            "the design for an uncertain swimmer, and the front of farthest gaits,",
        ));
    }
    let (mut farthest, mut robustness) = (None, None);
    let found = context.timed(Stage::FastestGait, |watch| -> Result<Fastest, Error> {
        if let Some((uncertainty, over)) = uncertainty.as_ref().filter(|_| ALL_SEARCHES) {
            let found = robust_speed(&problem, uncertainty, *over, watch)
                .map_err(|error| robust::refused(error, &request.bounds))?;
            robustness = Some(found.robustness);
            Ok(found.fastest)
        } else if ALL_SEARCHES && request.front {
            let front = farthest.insert(front(&problem, watch)?);
            Ok(front.fastest.clone())
        } else {
            Ok(problem.watched(watch)?)
        }
    });
    let (found, seconds) = split(found)?;
    let gait = if robustness.is_some() {
        robust::as_written(&found.gait)
    } else {
        found.gait.clone()
    };
    let any_heading =
        if robustness.is_none() && request.period.is_none() && heading != HeadingRule::Any {
            Some(fastest(&problem.led(HeadingRule::Any))?.speed_over_length)
        } else {
            None
        };
    let servo = file.servo.or(is_playable.then(ServoFile::default));
    let curve = AnyGait::from_file(&gait.gait_file(&file.name)).ok();
    let played =
        curve.and_then(|curve| played(&file, servo, &curve, found.period - found.rest, context));
    let (speed, distance) = (found.speed_over_length, found.distance_over_length);
    let length = file.swimmer.total_length();
    Ok(Output {
        name: file.name.clone(),
        length,
        speed_over_length_per_s: speed,
        speed_m_per_s: speed * length,
        displacement_over_length: distance,
        displacement_m: distance * length,
        period_s: found.period,
        heading_rad: found.heading,
        rotation_rad: found.gait.rotation,
        rest_s: found.gait.optimal_period.map(|_| found.rest),
        motion_s: found.gait.optimal_period,
        arcs: found.gait.arcs.clone(),
        corners: found.gait.corners().to_vec(),
        max_corners: SpeedProblem::MAX_CORNERS,
        starts: found.starts,
        found: found.found,
        longer_speed_over_length_per_s: found.longer,
        uncertified_speed_over_length_per_s: found.uncertified,
        robust: robustness.map(|robustness| RobustnessOutput::new(&robustness, "|d|/(L T)")),
        any_heading_speed_over_length_per_s: any_heading,
        played,
        front: None,
        farthest,
        gait: GaitOutput::new(&file.name, &gait, None, seconds),
    })
}

/// The gait of this period as these servos play it. Warns if it exceeds a limit of the robot at the period that is played.
fn played(
    file: &SwimmerFile,
    servo: Option<ServoFile>,
    curve: &AnyGait,
    period: f64,
    context: &mut Context,
) -> Option<PlayedSpeed> {
    let played = servo.and_then(|servo| PlayedSpeed::new(file, servo, curve, period));
    let period = played.as_ref().map_or(period, |played| played.period_s);
    robot_limits::warn_if_beyond(file, curve, (period * 1e3).ceil() / 1e3, context);
    played
}

impl From<SpeedError> for Error {
    /// An invalid problem is bad input; one without a certified gait is a failure.
    fn from(error: SpeedError) -> Self {
        match error {
            SpeedError::NoGait { .. } | SpeedError::Immobile(_) => Self::failed(&error),
            _ => Self::bad_input(&error),
        }
    }
}
