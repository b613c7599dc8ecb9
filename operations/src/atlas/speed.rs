//! All locally fastest gaits that the starts lead to.

use std::path::PathBuf;

use gait_optimizer::{Arc, Bounds, Certificate, Fastest, OptimalGait, SpeedProblem};
use serde::Serialize;
use swimmer_files::SwimmerFile;

use super::Request;
use crate::context::{Stage, Timed};
use crate::{Context, Error};

/// Optima for speed.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "FastestOptimaOutput")
)]
pub struct Output {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Optima, the fastest first.
    pub optima: Vec<FastestOutput>,
    /// Number of starts.
    pub starts: usize,
    /// Number of certified cycles with more corners than the search admits.
    pub longer: usize,
    /// Number of chains of arcs that failed their certificate.
    pub uncertified: usize,
    /// Speed of the fastest of these, over the total length \[1/s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best_uncertified: Option<f64>,
    /// Duration of the search \[s\], if the front end has a clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// Picture of the gaits, if the front end drew one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<PathBuf>,
}

/// One of the optima.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FastestOutput {
    /// Displacement over the period, over the total length \[1/s\].
    pub speed_over_length_per_s: f64,
    /// Displacement over the period \[m/s\].
    pub speed_m_per_s: f64,
    /// Displacement per cycle over the total length.
    pub displacement_over_length: f64,
    /// Period \[s\].
    pub period_s: f64,
    /// Direction of the displacement relative to the mean heading \[rad\].
    pub heading_rad: f64,
    /// Arcs in order.
    pub arcs: Vec<Arc>,
    /// Fractions of the period at which a servo reverses or stops.
    pub corners: Vec<f64>,
    /// Share of the cycle in which links cross.
    pub links_cross: f64,
    /// Certificate.
    pub certificate: Certificate,
    /// Number of starts that led to this gait.
    pub found: usize,
    /// Gait file, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gait: Option<PathBuf>,
    /// The gait, for files and pictures.
    #[serde(skip)]
    pub optimal: OptimalGait,
}

impl From<&Fastest> for FastestOutput {
    fn from(fastest: &Fastest) -> Self {
        let gait = &fastest.gait;
        Self {
            speed_over_length_per_s: fastest.speed_over_length,
            speed_m_per_s: fastest.speed_over_length * gait.swimmer.total_length(),
            displacement_over_length: fastest.distance_over_length,
            period_s: fastest.period,
            heading_rad: fastest.heading,
            arcs: gait.arcs.clone(),
            corners: gait.corners().to_vec(),
            links_cross: gait.links_cross,
            certificate: gait.certificate.clone(),
            found: fastest.found,
            gait: None,
            optimal: gait.clone(),
        }
    }
}

/// Finds the gaits.
///
/// # Errors
/// No rate is given, gaits shall be followed, or the problem is invalid.
pub(super) fn run(
    request: &Request,
    file: &SwimmerFile,
    bounds: Bounds,
    rates: Option<[f64; 2]>,
    context: &Context,
) -> Result<Output, Error> {
    let rates = rates.ok_or_else(|| {
        Error::refused(
            "the fastest gait depends on how fast servos turn: give --max-rate, or --playable for the robot's own",
        )
    })?;
    if request.continuation.is_some() {
        return Err(Error::refused(
            "--continue follows gaits for displacement and efficiency, none for speed: leave it out",
        ));
    }
    let problem = SpeedProblem {
        bounds,
        starts: request.starts,
        seed: request.seed,
        threads: context.threads,
        ..SpeedProblem::new(file.swimmer, rates)
    };
    let Timed { result, seconds } = context.timed(Stage::Optima, |watch| problem.atlas(watch));
    let found = result?;
    Ok(Output {
        name: file.name.clone(),
        optima: found.optima.iter().map(Into::into).collect(),
        starts: request.starts,
        longer: found.longer,
        uncertified: found.uncertified,
        best_uncertified: found.best_uncertified,
        seconds,
        picture: None,
    })
}
