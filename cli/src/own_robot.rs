//! Check that the robot of a swimmer file can play a gait, in the words of `robot upload`.

use forecast::forecast;
use gait_optimizer::OptimalGait;
use operations::fluid::FluidLoad;
use operations::robot_limits::{self, ADVICE, exceeded, played};
use serde::Serialize;
use swimmer_files::{AnyGait, ServoFile, SwimmerFile};
use swimmer_model::Model;

use crate::output::aside;

pub(crate) use operations::robot_limits::PERIOD_S;

/// Rate limit of each servo \[rad/s\]: the given one (a single one is that of both), or the robot's own for playable gaits.
/// Returns `None` without either.
pub(crate) fn servo_rates(rates: &[f64], playable: bool, file: &SwimmerFile) -> Option<[f64; 2]> {
    let own = if playable {
        file.servo.unwrap_or_default().max_rate
    } else {
        f64::INFINITY
    };
    let first = rates.first().copied().unwrap_or(f64::INFINITY);
    let second = rates.get(1).copied().unwrap_or(first);
    let rates = [first.min(own), second.min(own)];
    rates.iter().all(|rate| rate.is_finite()).then_some(rates)
}

/// A gait as fast as the robot of the file plays it.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct PlayedSpeed {
    /// The gait's own period, or the shortest that the robot allows for its table, to the next millisecond.
    pub(crate) period_s: f64,
    pub(crate) speed_m_per_s: f64,
    /// Share of the designed speed that table, ticks, pulses and servos cost.
    pub(crate) lost_share: f64,
}

impl PlayedSpeed {
    /// The check for a gait that is designed for this period \[s\]. Returns `None` if these servos cannot play it.
    pub(crate) fn new(
        file: &SwimmerFile,
        servo: ServoFile,
        gait: &AnyGait,
        period: f64,
    ) -> Option<Self> {
        let model = Model::new(&file.swimmer).ok()?;
        let at = |period| forecast(&model, gait, &played(servo, period)).ok();
        let shortest = at(period)?.verdict.min_period;
        let period_s = if shortest > period {
            (shortest * 1e3).ceil() / 1e3
        } else {
            period
        };
        let rates = at(period_s)?;
        let (designed, as_played) = rates.ends()?;
        let speed_m_per_s = as_played.displacement.norm() / period_s;
        Some(Self {
            period_s,
            speed_m_per_s,
            lost_share: 1.0 - speed_m_per_s * period / designed.displacement.norm(),
        })
    }
}

/// Says so where the gait goes beyond the robot of the file.
pub(crate) fn say_if_beyond_servos(file: &SwimmerFile, gait: &AnyGait, period: f64) {
    if let Some(warning) = robot_limits::warning(file, gait, period) {
        aside(&warning);
    }
}

/// The same, and where it goes beyond its servos' torque or the model in its fluid.
pub(crate) fn say_if_beyond(file: &SwimmerFile, gait: &AnyGait, period: f64) {
    say_if_beyond_servos(file, gait, period);
    let model = Model::new(&file.swimmer).ok();
    let load = model.and_then(|model| FluidLoad::new(file, &model, gait, period));
    for warning in load.iter().flat_map(|load| load.warnings(None)) {
        aside(&warning);
    }
}

/// Says how many of the gaits do, and why the first of them.
pub(crate) fn say_how_many_are_beyond<'a>(
    file: &SwimmerFile,
    gaits: impl Iterator<Item = &'a OptimalGait>,
) {
    if file.servo.is_none() {
        return;
    }
    let (mut count, mut first) = (0, None);
    let mut those = 0;
    for (number, gait) in gaits.enumerate() {
        count += 1;
        let curve = AnyGait::from_file(&gait.gait_file(&file.name)).ok();
        if let Some(reason) = curve.and_then(|curve| exceeded(file, &curve, PERIOD_S)) {
            those += 1;
            first.get_or_insert((number + 1, reason));
        }
    }
    if let Some((number, reason)) = first {
        aside(&format!(
            "warning: {}, at {PERIOD_S} s a cycle: {those} of these {count} gaits go beyond the robot, first no {number}: {reason} ({ADVICE})",
            file.name
        ));
    }
}
