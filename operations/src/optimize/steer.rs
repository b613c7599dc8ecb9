//! Fastest gaits to steer by, from one common shape.

use std::path::PathBuf;

use gait_optimizer::{Certificate, Joined, SpeedProblem, SteerProblem, Steering, steer};
use serde::{Deserialize, Serialize};
use swimmer_files::{GaitFile, SwimmerFile};
use swimmer_model::Pose;

use super::split;
use crate::bounds::BoundsRequest;
use crate::context::Stage;
use crate::robot_limits::servo_rates;
use crate::{Context, Error, SwimmerSource};

/// Search for the six gaits.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Request {
    /// The swimmer.
    pub swimmer: SwimmerSource,
    /// Options of the search.
    #[serde(default)]
    pub options: Options,
}

/// Options of the search for the six gaits.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Options {
    /// Largest rate of the servos \[rad/s\]: one for both, or one for each. Empty for those of playable gaits.
    pub max_rate: Vec<f64>,
    /// Bounds on the shapes.
    pub bounds: BoundsRequest,
    /// Shape at which the gaits join; `None` for the best one.
    pub shape: Option<[f64; 2]>,
}

impl Options {
    /// Playable gaits that join at the straight shape.
    pub fn straight() -> Self {
        Self {
            max_rate: Vec::new(),
            bounds: BoundsRequest {
                playable: true,
                ..BoundsRequest::default()
            },
            shape: Some([0.0; 2]),
        }
    }

    /// Rates of the servos \[rad/s\].
    ///
    /// # Errors
    /// No rate is given, and the gaits need not be playable.
    pub fn rates(&self, file: &SwimmerFile) -> Result<[f64; 2], Error> {
        servo_rates(&self.max_rate, self.bounds.playable, file)
            .ok_or_else(|| Error::refused("give --max-rate or --playable"))
    }
}

/// The six gaits. The JSON document of `swimmer optimize steer`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SteerOutput")
)]
pub struct Output {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Shape at which the gaits join \[rad\].
    pub shape_rad: [f64; 2],
    /// Number of shapes that were tried.
    pub shapes: usize,
    /// The gaits.
    pub gaits: Vec<JoinedOutput>,
    /// Duration of the search \[s\], if the front end has a clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
}

/// One of the six gaits.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JoinedOutput {
    /// Name.
    pub name: &'static str,
    /// Displacement along the heading at the common shape \[m\].
    pub x_m: f64,
    /// Displacement across that heading \[m\].
    pub y_m: f64,
    /// Net rotation \[rad\].
    pub rotation_rad: f64,
    /// Period \[s\].
    pub period_s: f64,
    /// Displacement over the period, over the total length \[1/s\]; null for gaits that turn.
    pub speed_over_length_per_s: Option<f64>,
    /// Rotation over the period \[rad/s\]; null for gaits that do not turn.
    pub rotation_rad_per_s: Option<f64>,
    /// Share of the fastest gait's speed that the common shape costs.
    pub joining_costs: f64,
    /// Certificate.
    pub certificate: Certificate,
    /// Gait file, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gait: Option<PathBuf>,
    /// Content of that file.
    #[serde(skip)]
    pub file: GaitFile,
}

/// Finds the gaits.
///
/// # Errors
/// The request is invalid, or no gait of a kind can be certified.
pub fn run(request: &Request, context: &mut Context) -> Result<Output, Error> {
    let file = request.swimmer.load(context)?;
    let (steering, seconds) = find(&file, &request.options, context)?;
    let gaits = named(&steering)
        .map(|(name, joined, backwards)| JoinedOutput::new(name, joined, backwards, &file));
    Ok(Output {
        name: file.name.clone(),
        shape_rad: steering.shape,
        shapes: steering.shapes,
        gaits: gaits.into(),
        seconds,
    })
}

/// Finds the gaits, and returns them with the duration of the search \[s\].
///
/// # Errors
/// As [`run`].
pub fn find(
    file: &SwimmerFile,
    options: &Options,
    context: &Context,
) -> Result<(Steering, Option<f64>), Error> {
    let problem = SteerProblem {
        of: SpeedProblem {
            bounds: options.bounds.of(file),
            threads: context.threads,
            ..SpeedProblem::new(file.swimmer, options.rates(file)?)
        },
        shape: options.shape,
    };
    split(context.timed(Stage::JoiningGaits, |watch| Ok(steer(&problem, watch)?)))
}

/// The gaits with their names: each kind, and the same run backwards.
pub fn named(steering: &Steering) -> [(&'static str, &Joined, bool); 6] {
    let Steering {
        forward,
        left,
        turn,
        ..
    } = steering;
    [
        ("forward", forward, false),
        ("backward", forward, true),
        ("left", left, false),
        ("right", left, true),
        ("turn-left", turn, false),
        ("turn-right", turn, true),
    ]
}

impl JoinedOutput {
    fn new(name: &'static str, joined: &Joined, backwards: bool, file: &SwimmerFile) -> Self {
        let length = file.swimmer.total_length();
        let turns = name.starts_with("turn");
        let [x, y, theta] = joined.net;
        let forth = Pose::new(x, y, theta);
        let net = if backwards { forth.inverse() } else { forth };
        Self {
            name,
            x_m: net.x * length,
            y_m: net.y * length,
            rotation_rad: net.theta,
            period_s: joined.period,
            speed_over_length_per_s: (!turns).then_some(joined.rate),
            rotation_rad_per_s: turns.then_some(joined.rate),
            joining_costs: joined.cost(),
            certificate: joined.gait.certificate.clone(),
            gait: None,
            file: joined.gait_file(&file.name, backwards),
        }
    }
}
