//! `net`, `simulate`, `gait-file` and `tank`: motion of one cycle, its gait file, and the number of cycles up to a wall of a tank.

use forecast::{NetMotion, Tank, shortest_period, until_wall};
use operations::bounds::BoundsRequest;
use operations::{Files, GaitSource};
use serde::{Deserialize, Serialize};
use swimmer_files::{AnyGait, Objective};
use swimmer_model::{Gait, Model, Pose, Tolerance, crossing_share, swim};

use super::objective;
use crate::calls::{CallOutput, Lab, Outcome, json, parsed};
use crate::input::SwimmerText;

#[derive(Deserialize)]
struct GaitRequest {
    swimmer: SwimmerText,
    gait: GaitSource,
    /// Period of a cycle \[s\].
    #[serde(default = "one_second")]
    period: f64,
}

const fn one_second() -> f64 {
    1.0
}

/// Numbers that are updated while a gait is dragged.
#[derive(Serialize)]
struct Net {
    #[serde(flatten)]
    motion: NetMotion,
    /// Mean speed with the given period.
    speed_m_per_s: f64,
    speed_over_length_per_s: f64,
}

/// Motion of one cycle, with the keys of `swimmer simulate --json`, and additional numbers of the page.
#[derive(Serialize)]
struct SimulateOutput {
    #[serde(flatten)]
    net: Net,
    links_cross: f64,
    /// Largest |φ̇ᵢ| of each joint with the given period.
    peak_rates_rad_s: [f64; 2],
    /// Largest |φᵢ|.
    reach_rad: f64,
    /// Shortest period \[s\] in which the servos can follow the gait as parametrised.
    shortest_period_s: Option<f64>,
}

/// Samples per cycle for the peak rates: ten for each knot of a spline of 192 knots.
const RATE_SAMPLES: usize = 1920;

impl Net {
    fn of(model: &Model<f64>, gait: &AnyGait, period: f64) -> Self {
        let stroke = swim(model, gait, &Tolerance::default());
        let speed = stroke.displacement.norm() / period;
        Self {
            motion: (&stroke).into(),
            speed_m_per_s: speed,
            speed_over_length_per_s: speed / stroke.total_length,
        }
    }
}

/// Net motion of a gait, computed quickly.
pub(super) fn net(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: GaitRequest = parsed(bytes)?;
    let (_, model) = request.swimmer.model()?;
    json(&Net::of(
        &model,
        &request.gait.read(Files::Unavailable)?,
        request.period,
    ))
}

/// Simulates a gait and evaluates all quantities.
pub(super) fn simulate(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: GaitRequest = parsed(bytes)?;
    let (file, model) = request.swimmer.model()?;
    let gait = request.gait.read(Files::Unavailable)?;
    let mut peaks = [0.0_f64; 2];
    for sample in 0..RATE_SAMPLES {
        let rate = gait.at(sample as f64 / RATE_SAMPLES as f64).rate;
        for (peak, rate) in peaks.iter_mut().zip(rate.iter()) {
            *peak = peak.max(rate.abs());
        }
    }
    let servo = file.servo.unwrap_or_default();
    json(&SimulateOutput {
        net: Net::of(&model, &gait, request.period),
        links_cross: crossing_share(&file.swimmer.links, &gait).of_cycle,
        peak_rates_rad_s: peaks.map(|peak| peak / request.period),
        reach_rad: forecast::reach(&gait).angle.abs(),
        shortest_period_s: shortest_period(&gait, [servo.max_rate; 2]).ok(),
    })
}

#[derive(Deserialize)]
struct GaitFileRequest {
    swimmer: SwimmerText,
    gait: GaitSource,
    objective: Option<String>,
    #[serde(default)]
    bounds: BoundsRequest,
}

/// Text of a gait file: unchanged for an optimal gait, otherwise with the swimmer of the page.
pub(super) fn gait_file(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: GaitFileRequest = parsed(bytes)?;
    let swimmer = request.swimmer.read()?;
    let mut file = request.gait.file(Files::Unavailable)?;
    if file.objective == Objective::Unspecified {
        file.objective = objective::parse(request.objective.as_deref())?.unwrap_or_default();
        file.bounds = request.bounds.of(&swimmer);
        file.swimmer_hash = Some(swimmer.hash());
        file.swimmer_name = Some(swimmer.name);
    }
    Ok(CallOutput::Bytes(file.to_text().into_bytes()))
}

#[derive(Deserialize)]
struct TankRequest {
    swimmer: SwimmerText,
    gait: GaitSource,
    length_m: f64,
    width_m: f64,
}

#[derive(Serialize)]
struct TankOutput {
    /// Number of cycles; `None` if the swimmer never reaches a wall.
    cycles: Option<f64>,
    part: Option<&'static str>,
}

/// Number of cycles from the middle of a tank to a wall, heading along the tank.
pub(super) fn tank(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: TankRequest = parsed(bytes)?;
    let (_, model) = request.swimmer.model()?;
    let tank = Tank {
        length: request.length_m,
        width: request.width_m,
    };
    let meeting = until_wall(
        &model,
        &request.gait.read(Files::Unavailable)?,
        &tank,
        &Pose::identity(),
    );
    json(&TankOutput {
        cycles: meeting.map(|meeting| meeting.cycles),
        part: meeting.map(|meeting| meeting.part.word()),
    })
}
