//! All locally optimal gaits that a seeded multi-start finds, and gaits that are followed as a parameter changes.

pub mod continuation;
pub mod speed;

use std::path::PathBuf;

use forecast::shortest_period;
use gait_optimizer::{
    Arc, Atlas, AtlasError, AtlasProblem, Bounds, Certificate, Condition, OptimalGait, Optimum,
    atlas_watched,
};
use serde::{Deserialize, Serialize};
use swimmer_files::{Objective, SwimmerFile};

use self::continuation::Order;
use crate::bounds::BoundsRequest;
use crate::context::{Stage, Timed};
use crate::optimize::EfficiencyFigures;
use crate::robot_limits::{servo_rates, warn_of_those_beyond};
use crate::{Context, Error, SwimmerSource};

/// Objective of an atlas.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Aim {
    /// Displacement per cycle, in any direction.
    Displacement,
    /// Lighthill efficiency.
    Efficiency,
    /// Displacement per time.
    Speed,
}

impl Aim {
    fn objective(self) -> Objective {
        match self {
            Self::Displacement => Objective::Displacement,
            Self::Efficiency => Objective::Efficiency,
            Self::Speed => Objective::Speed,
        }
    }
}

/// Search for all optima.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Request {
    /// The swimmer.
    pub swimmer: SwimmerSource,
    /// Objective.
    pub objective: Aim,
    /// Largest rate of the servos \[rad/s\]: one for both, or one for each. Empty for those of playable gaits, or for none.
    #[serde(default)]
    pub max_rate: Vec<f64>,
    /// Bounds on the shapes.
    #[serde(default)]
    pub bounds: BoundsRequest,
    /// Number of random starts.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u64,
    /// Parameter along which gaits are followed.
    #[serde(default)]
    pub continuation: Option<continuation::Request>,
}

/// Number of random starts, unless the user sets one.
pub const STARTS: u32 = 200;
/// Seed of the starts, unless the user sets one.
pub const SEED: u64 = 1;

impl Request {
    /// A search without bounds, rates or continuation, with the usual starts.
    pub fn new(swimmer: SwimmerSource, objective: Aim) -> Self {
        Self {
            swimmer,
            objective,
            max_rate: Vec::new(),
            bounds: BoundsRequest::default(),
            starts: STARTS as usize,
            seed: SEED,
            continuation: None,
        }
    }

    /// `true` if the request is answered without an atlas: it follows gaits that need no search.
    pub fn is_without_atlas(&self) -> bool {
        let from_atlas = |following: &continuation::Request| {
            following.gaits.is_empty() && self.objective == Aim::Efficiency
        };
        let following = self.continuation.as_ref();
        self.objective != Aim::Speed && following.is_some_and(|following| !from_atlas(following))
    }
}

/// The JSON document of `swimmer atlas`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "AtlasOutput")
)]
#[serde(untagged)]
pub enum Output {
    /// Optima for displacement or efficiency.
    Atlas(AtlasOutput),
    /// Optima for speed.
    Speed(speed::Output),
    /// Gaits that are followed without an atlas.
    Followed(FollowedOutput),
}

/// Optima for displacement or efficiency.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "OptimaOutput")
)]
pub struct AtlasOutput {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Objective, for text output.
    #[serde(skip)]
    pub objective: Objective,
    /// Optima, the best first.
    pub optima: Vec<OptimumOutput>,
    /// Number of random starts.
    pub starts: usize,
    /// Number of further starts, from gaits that the quarter solvers find without a guess.
    pub known_starts: usize,
    /// Number of starts that did not converge.
    pub unsettled: usize,
    /// Number of starts that left the region of the search.
    pub left: usize,
    /// Number of starts whose gait could not be certified.
    pub uncertified: usize,
    /// |d|/L or ξ of the best of these, by its curve of low order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best_uncertified: Option<f64>,
    /// Duration of the search \[s\], if the front end has a clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// The best gaits, followed as a parameter changes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub continuation: Option<continuation::Output>,
    /// Picture of the gaits, if the front end drew one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<PathBuf>,
}

/// Gaits that are followed without an atlas.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FollowedOutput {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Objective, for text output.
    #[serde(skip)]
    pub objective: Objective,
    /// The gaits.
    pub continuation: continuation::Output,
    /// Duration \[s\], if the front end has a clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
}

/// One of the optima.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OptimumOutput {
    /// Lighthill efficiency ξ at constant power.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub efficiency: f64,
    /// Displacement along the heading at the first sample, over the total length.
    pub displacement_over_length: f64,
    /// Displacement along that heading \[m\].
    pub displacement_m: f64,
    /// Displacement across that heading, over the total length.
    pub lateral_over_length: f64,
    /// Net displacement in any direction, over the total length.
    pub distance_over_length: f64,
    /// Net rotation \[rad\].
    pub rotation_rad: f64,
    /// φ₁ at the first sample \[rad\].
    pub start_angle_rad: f64,
    /// φ₂ at the end of the first quarter \[rad\].
    pub end_angle_rad: f64,
    /// Arcs: of the quarter if the gait is symmetric, of the cycle otherwise.
    pub arcs: Vec<Arc>,
    /// Share of the cycle in which links cross.
    pub links_cross: f64,
    /// Numerical quality of an efficiency gait.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub figures: Option<EfficiencyFigures>,
    /// Certificate.
    pub certificate: Certificate,
    /// The curve does not cross itself.
    pub simple: bool,
    /// The gait has the paper's symmetries.
    pub symmetric: bool,
    /// Number of starts that led to this gait.
    pub found: usize,
    /// Duration of the whole search \[s\], if the front end has a clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// Pace under the limit on the servos' rates, if there is one.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub pace: Option<Pace>,
    /// Gait file, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gait: Option<PathBuf>,
    /// The gait, for files and pictures.
    #[serde(skip)]
    pub optimal: OptimalGait,
}

/// A gait as fast as servos of the given rates play it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Pace {
    /// Shortest period \[s\].
    pub period_s: f64,
    /// Displacement over that period, over the total length \[1/s\].
    pub speed_over_length_per_s: f64,
}

impl OptimumOutput {
    fn new(
        optimum: &Optimum,
        rates: Option<[f64; 2]>,
        seconds: Option<f64>,
    ) -> Result<Self, Error> {
        let gait = &optimum.gait;
        let pace = |rates| -> Result<Pace, Error> {
            let curve = gait.gait().map_err(|error| Error::failed(&error))?;
            let period = shortest_period(&curve, rates)?;
            Ok(Pace {
                period_s: period,
                speed_over_length_per_s: optimum.distance_over_length / period,
            })
        };
        Ok(Self {
            efficiency: gait.efficiency,
            displacement_over_length: gait.displacement_over_length,
            displacement_m: gait.displacement,
            lateral_over_length: gait.lateral_over_length,
            distance_over_length: optimum.distance_over_length,
            rotation_rad: gait.rotation,
            start_angle_rad: gait.start_angle,
            end_angle_rad: gait.end_angle,
            arcs: gait.arcs.clone(),
            links_cross: gait.links_cross,
            figures: EfficiencyFigures::of_certificate(gait, Condition::ShootingResidual, |gait| {
                gait.certificate.value(Condition::ConstantPower)
            }),
            certificate: gait.certificate.clone(),
            simple: optimum.simple,
            symmetric: gait.symmetric,
            found: optimum.found,
            seconds,
            pace: rates.map(pace).transpose()?,
            gait: None,
            optimal: gait.clone(),
        })
    }
}

/// Finds all optima, or follows gaits. Warns if gaits exceed a limit of the robot.
///
/// # Errors
/// The request is invalid, or there is no gait to follow.
pub fn run(request: &Request, context: &mut Context) -> Result<Output, Error> {
    let file = request.swimmer.load(context)?;
    let bounds = request.bounds.of(&file);
    let rates = servo_rates(&request.max_rate, request.bounds.playable, &file);
    if request.objective == Aim::Speed {
        return speed::run(request, &file, bounds, rates, context).map(Output::Speed);
    }
    let objective = request.objective.objective();
    let order = request.continuation.as_ref().map(|following| Order {
        swimmer: file.swimmer,
        objective,
        bounds,
        request: following,
    });
    match order {
        Some(order) if request.is_without_atlas() => {
            let Timed { result, seconds } =
                context.timed(Stage::Continuation, |watch| order.named(watch));
            Ok(Output::Followed(FollowedOutput {
                name: file.name,
                objective,
                continuation: result?,
                seconds,
            }))
        }
        order => all(request, &file, bounds, rates, order.as_ref(), context).map(Output::Atlas),
    }
}

/// Finds all optima for displacement or efficiency, and follows the best if an order is given.
fn all(
    request: &Request,
    file: &SwimmerFile,
    bounds: Bounds,
    rates: Option<[f64; 2]>,
    order: Option<&Order<'_>>,
    context: &mut Context,
) -> Result<AtlasOutput, Error> {
    let (swimmer, bounds) = order.map_or((file.swimmer, bounds), Order::at_first);
    let objective = request.objective.objective();
    let problem = AtlasProblem {
        bounds,
        starts: request.starts,
        seed: request.seed,
        threads: context.threads,
        ..AtlasProblem::new(swimmer, objective)
    };
    let Timed { result, seconds } =
        context.timed(Stage::Optima, |watch| atlas_watched(&problem, watch));
    let found: Atlas = result?;
    let gaits = found.optima.iter().map(|optimum| &optimum.gait);
    warn_of_those_beyond(file, gaits, context);
    let optima = found
        .optima
        .iter()
        .map(|optimum| OptimumOutput::new(optimum, rates, seconds))
        .collect::<Result<_, _>>()?;
    let follow = |order: &Order<'_>| {
        let followed = context.timed(Stage::Continuation, |watch| order.best(&found, watch));
        followed.result
    };
    Ok(AtlasOutput {
        name: file.name.clone(),
        objective,
        optima,
        starts: request.starts,
        known_starts: found.starts.saturating_sub(request.starts),
        unsettled: found.unsettled,
        left: found.left,
        uncertified: found.uncertified,
        best_uncertified: found.best_uncertified,
        seconds,
        continuation: order.map(follow).transpose()?,
        picture: None,
    })
}

impl From<AtlasError> for Error {
    /// Every failure is an invalid problem.
    fn from(error: AtlasError) -> Self {
        Self::bad_input(&error)
    }
}
