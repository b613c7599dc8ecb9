//! Best waveform of the one servo of a swimmer with a passive joint.

use std::path::PathBuf;

use passive_joint::{
    LimitCycle, Objective, Optima, Optimum, Problem, SpringChoice, optimize, over_viscosity,
};
use serde::Serialize;
use swimmer_files::{AnyGait, Bounds, GaitFile, JointName, Spring, SwimmerFile};
use swimmer_model::{CrossingShare, Tolerance, crossing_share, swim};

use crate::passive::SAMPLES;
use crate::robot_limits::PERIOD_S;
use crate::{Context, Error, SwimmerSource, model};

/// Number of odd harmonics, unless the user sets one.
pub const HARMONICS: usize = 3;

/// Search for the best waveform. Missing values come from the swimmer file: `[passive]` and `[servo]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The swimmer.
    pub swimmer: SwimmerSource,
    /// The passive joint.
    pub joint: Option<JointName>,
    /// Its spring.
    pub spring: Option<RequestedSpring>,
    /// Quantity to maximise.
    pub objective: Objective,
    /// Period \[s\]; `None` if it is part of the search.
    pub period_s: Option<f64>,
    /// Largest angle of the driven joint \[rad\].
    pub max_angle: Option<f64>,
    /// Largest rate of the driven joint \[rad/s\].
    pub max_rate: Option<f64>,
    /// Odd harmonics of the waveform.
    pub harmonics: usize,
}

/// Spring of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RequestedSpring {
    /// This one.
    Given(Spring),
    /// The best one.
    Free,
}

/// Best waveform. The JSON document of `swimmer optimize passive`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "PassiveOutput")
)]
pub struct Output {
    /// Name of the swimmer, for text output.
    #[serde(skip)]
    pub name: String,
    /// Share of the cycle in which links cross, for text output.
    #[serde(skip)]
    pub crossing: CrossingShare<f64>,
    /// The gait: the waveform, and the response of the passive joint.
    #[serde(skip)]
    pub file: GaitFile,
    /// Quantity that is maximised.
    pub objective: &'static str,
    /// The passive joint, `front` or `back`.
    pub passive: String,
    /// The best waveform.
    #[serde(flatten)]
    pub best: Cycle,
    /// Share by which its objective exceeds that of the best sinusoid.
    pub gain_over_sine: f64,
    /// The best sinusoid under the same bounds.
    pub sine: Cycle,
    /// Share of the cycle in which links cross.
    pub links_cross: f64,
    /// First-order (KKT) conditions and second variation.
    pub conditions: Conditions,
    /// The gait file, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gait: Option<PathBuf>,
}

/// One cycle.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "WaveformCycle")
)]
pub struct Cycle {
    /// Displacement over the total length.
    pub displacement_over_length: f64,
    /// Displacement \[m\].
    pub displacement_m: f64,
    /// Displacement per second \[m/s\].
    pub speed_m_per_s: f64,
    /// Lighthill's efficiency as parametrised: that of the motor, since the spring does no work over a cycle.
    pub efficiency: f64,
    /// Motor work per cycle \[J\], if the swimmer file names a fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub work_j: Option<f64>,
    /// Period \[s\].
    pub period_s: f64,
    /// Relaxation time of the passive joint \[s\].
    pub relaxation_s: f64,
    /// Stiffness of the spring \[N m/rad\], if the swimmer file names a fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness_n_m: Option<f64>,
    /// Passive angle at the start of the cycle \[rad\].
    pub passive_start_rad: f64,
    /// Largest angle of the driven joint \[rad\].
    pub largest_angle_rad: f64,
    /// Largest rate of the driven joint \[rad/s\].
    pub largest_rate_rad_per_s: f64,
    /// Harmonics of the waveform: order, coefficients of cosine and sine \[rad\].
    pub waveform: Vec<WaveformHarmonic>,
}

/// Harmonic of a waveform.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WaveformHarmonic {
    /// Order.
    pub order: usize,
    /// Coefficient of the cosine \[rad\].
    pub cos_rad: f64,
    /// Coefficient of the sine \[rad\].
    pub sin_rad: f64,
}

/// Optimality conditions of the logarithm of the objective, in the coefficients \[rad\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "WaveformConditions")
)]
pub struct Conditions {
    /// Largest component of the gradient of the Lagrangian.
    pub stationarity: f64,
    /// Largest product of a multiplier and the slack of its bound.
    pub complementarity: f64,
    /// The second variation is negative along the active bounds.
    pub second_variation_negative: bool,
}

/// Finds the best waveform.
///
/// # Errors
/// The request is incomplete or has no optimum, or the search does not converge.
pub fn run(request: &Request, context: &mut Context) -> Result<Output, Error> {
    let file = request.swimmer.load(context)?;
    let model = model(&file)?;
    let in_file = file.passive;
    let joint = request
        .joint
        .or(in_file.map(|passive| passive.joint))
        .ok_or_else(|| {
            Error::refused("name the passive joint by --passive front or --passive back")
        })?;
    let in_file = in_file.filter(|passive| passive.joint == joint);
    let spring = request
        .spring
        .or(in_file.map(|passive| RequestedSpring::Given(passive.spring)))
        .ok_or_else(|| {
            Error::refused("give the spring by --stiffness or --relaxation, or --relaxation free for the best one")
        })?;
    let max_angle = request
        .max_angle
        .or(file.servo.map(|servo| servo.max_angle))
        .ok_or_else(|| {
            Error::refused(
                "the swimmer file names no servos: bound the driven joint by --max-angle",
            )
        })?;
    let fluid = file.fluid.as_ref();
    let spring = match spring {
        RequestedSpring::Given(spring) => {
            SpringChoice::OverViscosity(over_viscosity(spring, &model, joint.0, fluid)?)
        }
        RequestedSpring::Free => SpringChoice::Free,
    };
    // With a free spring only its relaxation over the period matters, except for the speed.
    let is_indifferent = spring == SpringChoice::Free && request.objective != Objective::Speed;
    let problem = Problem {
        model: &model,
        joint: joint.0,
        objective: request.objective,
        spring,
        period: request.period_s.or(is_indifferent.then_some(PERIOD_S)),
        max_angle,
        max_rate: request.max_rate.or(file.servo.map(|servo| servo.max_rate)),
        harmonics: request.harmonics,
    };
    let Optima { best, sine } = optimize(&problem)?;
    let drive = best.waveform.driving(best.passive.driven());
    let cycle = LimitCycle::new(&model, &drive, best.passive)?;
    let samples = GaitFile {
        swimmer_name: Some(file.name.clone()),
        swimmer_hash: Some(file.hash()),
        bounds: Bounds::within(max_angle),
        ..cycle.gait_file(SAMPLES)
    };
    let curve = AnyGait::from_file(&samples).map_err(|why| Error::bad_input(&why))?;
    let crossing = crossing_share(&file.swimmer.links, &curve);
    // An independent integration of the limit cycle.
    let stroke = swim(&model, &cycle, &Tolerance::default());
    let reached = stroke.displacement.norm();
    if (reached / best.values.displacement - 1.0).abs() > AGREEMENT {
        return Err(Error::unsuccessful(format!(
            "the search found {} m a cycle, but the integrated limit cycle swims {reached} m; use fewer harmonics",
            best.values.displacement
        )));
    }
    Ok(Output {
        name: file.name.clone(),
        objective: request.objective.word(),
        passive: joint.to_string(),
        gain_over_sine: (best.value - sine.value).exp() - 1.0,
        links_cross: crossing.of_cycle,
        crossing,
        conditions: Conditions {
            stationarity: best.conditions.stationarity,
            complementarity: best.conditions.complementarity,
            second_variation_negative: best.conditions.is_strict,
        },
        best: described(&file, &model, &best),
        sine: described(&file, &model, &sine),
        file: samples,
        gait: None,
    })
}

/// Relative agreement of the search with the integrated limit cycle.
const AGREEMENT: f64 = 1e-6;

fn described(file: &SwimmerFile, model: &swimmer_model::Model<f64>, optimum: &Optimum) -> Cycle {
    let length = file.swimmer.total_length();
    let (values, period) = (&optimum.values, optimum.period);
    let viscosity = file.fluid.map(|fluid| fluid.viscosity());
    let harmonics = optimum
        .waveform
        .harmonics()
        .map(|harmonic| WaveformHarmonic {
            order: harmonic.order,
            cos_rad: harmonic.cos,
            sin_rad: harmonic.sin,
        });
    Cycle {
        displacement_over_length: values.displacement / length,
        displacement_m: values.displacement,
        speed_m_per_s: values.displacement / period,
        efficiency: model.side_drag() * length * values.displacement.powi(2) / values.energy,
        work_j: viscosity.map(|viscosity| values.energy * viscosity / period),
        period_s: period,
        relaxation_s: optimum.passive.relaxation_share(model) * period,
        stiffness_n_m: viscosity.map(|viscosity| optimum.passive.kappa * viscosity / period),
        passive_start_rad: values.start,
        largest_angle_rad: optimum.largest_angle,
        largest_rate_rad_per_s: optimum.largest_rate,
        waveform: harmonics.collect(),
    }
}
