//! Net motion of one cycle of a gait.

use std::path::PathBuf;

use forecast::{NetMotion, Played, Servos, forecast, forecast_passive};
use serde::{Deserialize, Serialize};
use swimmer_model::{CrossingShare, Tolerance, crossing_share, swim};

use crate::fluid::FluidLoad;
use crate::played::PlayedCycle;
use crate::{Context, Error, Subject, robot_limits};

/// Options of a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default)]
pub struct Options {
    /// Duration of a cycle \[s\].
    pub period_s: f64,
    /// Also forecast the cycle as the robot plays it.
    pub played: Option<PlayedOptions>,
}

/// Settings of the play on the robot.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct PlayedOptions {
    /// Knots of the robot's table.
    pub knots: usize,
    /// Step of the timer that makes the pulses \[ns\]; 0 for none.
    pub pulse_step_ns: u32,
}

impl Default for PlayedOptions {
    /// The robot's largest table, and its timer.
    fn default() -> Self {
        Self {
            knots: link_protocol::MAX_KNOTS,
            pulse_step_ns: Servos::ROBOT_PULSE_STEP_NS,
        }
    }
}

impl Default for Options {
    /// The paper's cycle of 30 s, in the model alone.
    fn default() -> Self {
        Self {
            period_s: robot_limits::PERIOD_S,
            played: None,
        }
    }
}

/// One cycle. The JSON document of `swimmer simulate`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SimulateOutput")
)]
pub struct Output {
    /// Share of the cycle in which links cross, for text output.
    #[serde(skip)]
    pub crossing: CrossingShare<f64>,
    /// Share of the cycle in which links cross.
    pub links_cross: f64,
    /// Net motion, over the total length and in SI units.
    #[serde(flatten)]
    pub net: NetMotion,
    /// Angle of the passive joint at the start of its limit cycle \[rad\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub passive_start_rad: Option<f64>,
    /// The cycle as the robot plays it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub played: Option<PlayedCycle>,
    /// Torque, power and Reynolds number, if the swimmer file names a fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fluid: Option<FluidLoad>,
    /// Table of the trajectory, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trajectory: Option<PathBuf>,
    /// Picture, if the front end drew one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<PathBuf>,
    /// Gait file of the limit cycle, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gait: Option<PathBuf>,
}

/// Simulates one cycle. Warns if the gait is beyond the servos or the fluid of the swimmer file.
///
/// # Errors
/// The robot cannot play the gait, and [`Options::played`] is given.
pub fn run(subject: &Subject, options: &Options, context: &mut Context) -> Result<Output, Error> {
    let Subject {
        file,
        model,
        gait,
        response,
        ..
    } = subject;
    if let Some(shape) = file.swimmer.singular_shape(gait) {
        return Err(Error::refused(format!(
            "the gait passes the shape ({}, {}), at which the axles of the wheels of `{}` meet in one point or are parallel: A is \
             infinite there; keep the gait on one side of such shapes (phi1 = phi2 if the side links are alike)",
            crate::text::degrees(shape.x),
            crate::text::degrees(shape.y),
            file.name
        )));
    }
    if options.played.is_some() && !file.swimmer.is_viscous() {
        return Err(Error::refused(format!(
            "`{}` is not in a viscous fluid, where the robot swims: leave out the forecast of its play",
            file.name
        )));
    }
    let crossing = crossing_share(&file.swimmer.links, gait);
    let stroke = swim(model, gait, &Tolerance::default());
    let played = options
        .played
        .map(|played| {
            let played = Played {
                servos: Servos {
                    file: file.servo.unwrap_or_default(),
                    pulse_step_ns: played.pulse_step_ns,
                },
                period: options.period_s,
                knots: played.knots,
            };
            match response {
                Some(response) => forecast_passive(model, gait, &played, response.passive),
                None => forecast(model, gait, &played),
            }
        })
        .transpose()?;
    let output = Output {
        crossing,
        links_cross: crossing.of_cycle,
        net: (&stroke).into(),
        passive_start_rad: response.map(|response| response.start),
        played: played.as_ref().map(PlayedCycle::new),
        fluid: FluidLoad::new(file, model, gait, options.period_s),
        trajectory: None,
        picture: None,
        gait: None,
    };
    let passive = response.map(|response| response.passive.joint);
    // The limits are those of servos, which a passive joint does not have.
    if passive.is_none() {
        context
            .warnings
            .extend(robot_limits::warning(file, gait, options.period_s));
    }
    let load = output.fluid.iter();
    context
        .warnings
        .extend(load.flat_map(|load| load.warnings(passive)));
    Ok(output)
}
