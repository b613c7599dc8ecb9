//! Limits of the robot of a swimmer file: whether it plays a gait, in the words of `robot upload`.

use forecast::{Played, Servos, forecast};
use gait_optimizer::OptimalGait;
use link_protocol::MAX_KNOTS;
use serde::Serialize;
use swimmer_files::{AnyGait, ServoFile, SwimmerFile};
use swimmer_model::Model;

use crate::Context;
use crate::fluid::FluidLoad;

/// Duration of the paper's cycle \[s\], used if none is given.
pub const PERIOD_S: f64 = 30.0;

/// The gait as the robot plays it, with a full table and its own timer.
pub fn played(servo: ServoFile, period: f64) -> Played {
    Played {
        servos: Servos::on_the_robot(servo),
        period,
        knots: MAX_KNOTS,
    }
}

/// The first limit of the file's `[servo]` that a gait exceeds: angle, clearance of the links, or rate at this period \[s\]. Returns
/// `None` if the robot plays the gait, or if the file has no `[servo]`.
pub fn exceeded(file: &SwimmerFile, gait: &AnyGait, period: f64) -> Option<String> {
    let (Some(servo), Ok(model)) = (file.servo, Model::new(&file.swimmer)) else {
        return None;
    };
    match forecast(&model, gait, &played(servo, period)) {
        Err(error) => Some(error.to_string()),
        Ok(predicted) => match predicted.verdict.refused {
            Some(refused) => Some(format!("the robot would refuse: {refused}")),
            None if predicted.verdict.min_period > period => Some(format!(
                "at {period} s a cycle the gait turns the joints faster than the servos' {:.1}°/s; the robot plays it in {:.2} s at least",
                servo.max_rate.to_degrees(),
                predicted.verdict.min_period
            )),
            None => None,
        },
    }
}

/// Advice at the end of such a warning.
pub const ADVICE: &str = "`swimmer optimize … --playable` keeps a gait within angle and clearance; a longer period keeps it within the rate";

/// Warning if the gait exceeds a limit of the robot of the file.
pub fn warning(file: &SwimmerFile, gait: &AnyGait, period: f64) -> Option<String> {
    let reason = exceeded(file, gait, period)?;
    Some(format!(
        "warning: {}, at {period} s a cycle: {reason} ({ADVICE})",
        file.name
    ))
}

/// Warns if the gait exceeds a limit of the robot of the file, the torque of its servos, or the model in its fluid.
pub fn warn_if_beyond(file: &SwimmerFile, gait: &AnyGait, period: f64, context: &mut Context) {
    context.warnings.extend(warning(file, gait, period));
    let model = Model::new(&file.swimmer).ok();
    let load = model.and_then(|model| FluidLoad::new(file, &model, gait, period));
    let warnings = load.iter().flat_map(|load| load.warnings(None));
    context.warnings.extend(warnings);
}

/// Warns of the number of gaits that exceed a limit of the robot of the file, with the reason of the first.
pub(crate) fn warn_of_those_beyond<'a>(
    file: &SwimmerFile,
    gaits: impl Iterator<Item = &'a OptimalGait>,
    context: &mut Context,
) {
    if file.servo.is_none() {
        return;
    }
    let (mut count, mut beyond, mut first) = (0, 0, None);
    for (number, gait) in gaits.enumerate() {
        count += 1;
        let curve = AnyGait::from_file(&gait.gait_file(&file.name)).ok();
        if let Some(reason) = curve.and_then(|curve| exceeded(file, &curve, PERIOD_S)) {
            beyond += 1;
            first.get_or_insert((number + 1, reason));
        }
    }
    if let Some((number, reason)) = first {
        context.warn(format!(
            "warning: {}, at {PERIOD_S} s a cycle: {beyond} of these {count} gaits go beyond the robot, first no {number}: {reason} ({ADVICE})",
            file.name
        ));
    }
}

/// Rate limit of each servo \[rad/s\]: the given one (a single one is that of both), or the robot's own for playable gaits.
/// Returns `None` without either.
pub fn servo_rates(rates: &[f64], playable: bool, file: &SwimmerFile) -> Option<[f64; 2]> {
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
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlayedSpeed {
    /// Period of the gait, or the shortest that the robot allows for its table, to the next millisecond \[s\].
    pub period_s: f64,
    /// Displacement over that period \[m/s\].
    pub speed_m_per_s: f64,
    /// Share of the designed speed that table, ticks, pulses and servos cost.
    pub lost_share: f64,
}

impl PlayedSpeed {
    /// The check for a gait that is designed for this period \[s\]. Returns `None` if these servos cannot play it.
    pub fn new(file: &SwimmerFile, servo: ServoFile, gait: &AnyGait, period: f64) -> Option<Self> {
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
