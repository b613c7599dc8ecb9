//! `net`, `simulate`, `gait-file` and `tank`: motion of one cycle, its gait file, and the number of cycles up to a wall of a tank.

use forecast::{NetMotion, Tank, shortest_period, until_wall};
use operations::bounds::BoundsRequest;
use operations::{Files, GaitSource};
use serde::{Deserialize, Serialize};
use swimmer_files::{AnyGait, Objective};
use swimmer_model::{Gait, Model, Pose, Tolerance, crossing_share, swim};

use super::objective;
use crate::calls::{Answer, Lab, Outcome, json, parsed};
use crate::input::SwimmerText;

#[derive(Deserialize)]
struct Asked {
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
struct Swum {
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
const LOOKS: usize = 1920;

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
    let asked: Asked = parsed(bytes)?;
    let (_, model) = asked.swimmer.model()?;
    json(&Net::of(
        &model,
        &asked.gait.read(Files::Unavailable)?,
        asked.period,
    ))
}

/// Simulates a gait and evaluates all quantities.
pub(super) fn simulate(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: Asked = parsed(bytes)?;
    let (file, model) = asked.swimmer.model()?;
    let gait = asked.gait.read(Files::Unavailable)?;
    let mut peaks = [0.0_f64; 2];
    for look in 0..LOOKS {
        let rate = gait.at(look as f64 / LOOKS as f64).rate;
        for (peak, rate) in peaks.iter_mut().zip(rate.iter()) {
            *peak = peak.max(rate.abs());
        }
    }
    let servo = file.servo.unwrap_or_default();
    json(&Swum {
        net: Net::of(&model, &gait, asked.period),
        links_cross: crossing_share(&file.swimmer.links, &gait).of_cycle,
        peak_rates_rad_s: peaks.map(|peak| peak / asked.period),
        reach_rad: forecast::reach(&gait).angle.abs(),
        shortest_period_s: shortest_period(&gait, [servo.max_rate; 2]).ok(),
    })
}

#[derive(Deserialize)]
struct FileAsked {
    swimmer: SwimmerText,
    gait: GaitSource,
    objective: Option<String>,
    #[serde(default)]
    bounds: BoundsRequest,
}

/// Text of a gait file: unchanged for an optimal gait, otherwise with the swimmer of the page.
pub(super) fn gait_file(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: FileAsked = parsed(bytes)?;
    let swimmer = asked.swimmer.read()?;
    let mut file = asked.gait.file(Files::Unavailable)?;
    if file.objective == Objective::Unspecified {
        file.objective = objective::parse(asked.objective.as_deref())?.unwrap_or_default();
        file.bounds = asked.bounds.of(&swimmer);
        file.swimmer_hash = Some(swimmer.hash());
        file.swimmer_name = Some(swimmer.name);
    }
    Ok(Answer::Bytes(file.to_text().into_bytes()))
}

#[derive(Deserialize)]
struct TankAsked {
    swimmer: SwimmerText,
    gait: GaitSource,
    length_m: f64,
    width_m: f64,
}

#[derive(Serialize)]
struct TankAnswer {
    /// Number of cycles; `None` if the swimmer never reaches a wall.
    cycles: Option<f64>,
    part: Option<&'static str>,
}

/// Number of cycles from the middle of a tank to a wall, heading along the tank.
pub(super) fn tank(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: TankAsked = parsed(bytes)?;
    let (_, model) = asked.swimmer.model()?;
    let tank = Tank {
        length: asked.length_m,
        width: asked.width_m,
    };
    let meeting = until_wall(
        &model,
        &asked.gait.read(Files::Unavailable)?,
        &tank,
        &Pose::identity(),
    );
    json(&TankAnswer {
        cycles: meeting.map(|meeting| meeting.cycles),
        part: meeting.map(|meeting| meeting.part.word()),
    })
}
