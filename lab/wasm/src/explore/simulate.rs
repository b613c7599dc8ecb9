//! `net`, `simulate`, `gait-file` and `tank`: what one cycle brings, the file that says so anywhere, and how many cycles there is room for.

use forecast::{NetMotion, Tank, shortest_period, until_wall};
use serde::{Deserialize, Serialize};
use swimmer_files::{AnyGait, Objective};
use swimmer_model::{Gait, Model, Pose, Tolerance, crossing_share, swim};

use super::bounds::{BoundsAsked, objective};
use crate::calls::{Answer, Lab, Outcome, json, parsed};
use crate::input::{GaitText, SwimmerText};

#[derive(Deserialize)]
struct Asked {
    swimmer: SwimmerText,
    gait: GaitText,
    /// Duration of a cycle, for rates \[s\].
    #[serde(default = "one_second")]
    period: f64,
}

const fn one_second() -> f64 {
    1.0
}

/// What follows a hand.
#[derive(Serialize)]
struct Net {
    #[serde(flatten)]
    motion: NetMotion,
    /// In the period asked for.
    speed_m_per_s: f64,
    speed_over_length_per_s: f64,
}

/// One cycle, under the keys of `swimmer simulate --json`, and what the page tells beside it.
#[derive(Serialize)]
struct Swum {
    #[serde(flatten)]
    net: Net,
    links_cross: f64,
    /// Largest |φ̇ᵢ| of each joint in the period asked for.
    peak_rates_rad_s: [f64; 2],
    /// Largest |φᵢ|.
    reach_rad: f64,
    /// Fastest cycle that the swimmer's servos follow as parametrised, in seconds.
    shortest_period_s: Option<f64>,
}

/// Looks per cycle for the peak rates; a spline of 192 knots turns on ten of them.
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

/// The net motion of a gait, at once.
pub(super) fn net(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: Asked = parsed(bytes)?;
    let (_, model) = asked.swimmer.model()?;
    json(&Net::of(&model, &asked.gait.read()?, asked.period))
}

/// Swims a gait, and looks at all of it.
pub(super) fn simulate(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: Asked = parsed(bytes)?;
    let (file, model) = asked.swimmer.model()?;
    let gait = asked.gait.read()?;
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
    gait: GaitText,
    objective: Option<String>,
    #[serde(default)]
    bounds: BoundsAsked,
}

/// The text of a gait file: of an optimiser's as it is, of any other with the swimmer that the page shows.
pub(super) fn gait_file(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: FileAsked = parsed(bytes)?;
    let swimmer = asked.swimmer.read()?;
    let mut file = asked.gait.file()?;
    if file.objective == Objective::Unspecified {
        file.objective = objective(asked.objective.as_deref())?.unwrap_or_default();
        file.bounds = asked.bounds.into();
        file.swimmer_hash = Some(swimmer.hash());
        file.swimmer_name = Some(swimmer.name);
    }
    Ok(Answer::Bytes(file.to_text().into_bytes()))
}

#[derive(Deserialize)]
struct TankAsked {
    swimmer: SwimmerText,
    gait: GaitText,
    length_m: f64,
    width_m: f64,
}

#[derive(Serialize)]
struct TankAnswer {
    /// None: it never meets a wall.
    cycles: Option<f64>,
    part: Option<&'static str>,
}

/// How many cycles from the middle of a tank, heading along it.
pub(super) fn tank(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: TankAsked = parsed(bytes)?;
    let (_, model) = asked.swimmer.model()?;
    let tank = Tank {
        length: asked.length_m,
        width: asked.width_m,
    };
    let meeting = until_wall(&model, &asked.gait.read()?, &tank, &Pose::identity());
    json(&TankAnswer {
        cycles: meeting.map(|meeting| meeting.cycles),
        part: meeting.map(|meeting| meeting.part.word()),
    })
}
