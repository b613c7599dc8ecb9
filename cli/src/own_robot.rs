//! Whether the robot of a swimmer file can play a gait, in the words of `robot upload`.

use forecast::{Played, Servos, forecast};
use gait_optimizer::OptimalGait;
use link_protocol::MAX_KNOTS;
use swimmer_files::{AnyGait, SwimmerFile};
use swimmer_model::Model;

use crate::in_fluid::InFluid;
use crate::output::aside;

/// A cycle's duration where none is named, s: the paper's.
pub(crate) const PERIOD_S: f64 = 30.0;

/// Where a gait goes beyond the `[servo]` of the file: angle, clearance of the links, rate at this period.
fn beyond(file: &SwimmerFile, gait: &AnyGait, period: f64) -> Option<String> {
    let (Some(servo), Ok(model)) = (file.servo, Model::new(&file.swimmer)) else {
        return None;
    };
    let played = Played {
        servos: Servos::on_the_robot(servo),
        period,
        knots: MAX_KNOTS,
    };
    match forecast(&model, gait, &played) {
        Err(error) => Some(error.to_string()),
        Ok(foretold) => match foretold.verdict.refused {
            Some(refused) => Some(format!("the robot would refuse: {refused}")),
            None if foretold.verdict.min_period > period => Some(format!(
                "at {period} s a cycle the gait turns the joints faster than the servos' {:.1}°/s; the robot plays it in {:.2} s at least",
                servo.max_rate.to_degrees(),
                foretold.verdict.min_period
            )),
            None => None,
        },
    }
}

/// What helps.
const ADVICE: &str = "`swimmer optimize … --playable` keeps a gait within angle and clearance; a longer period keeps it within the rate";

/// Says so where the gait goes beyond the robot of the file.
pub(crate) fn say_if_beyond_servos(file: &SwimmerFile, gait: &AnyGait, period: f64) {
    if let Some(reason) = beyond(file, gait, period) {
        aside(&format!(
            "warning: {}, at {period} s a cycle: {reason} ({ADVICE})",
            file.name
        ));
    }
}

/// The same, and where it goes beyond its servos' torque or the model in its fluid.
pub(crate) fn say_if_beyond(file: &SwimmerFile, gait: &AnyGait, period: f64) {
    say_if_beyond_servos(file, gait, period);
    let model = Model::new(&file.swimmer).ok();
    if let Some(fluid) = model.and_then(|model| InFluid::new(file, &model, gait, period)) {
        fluid.warn();
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
        if let Some(reason) = curve.and_then(|curve| beyond(file, &curve, PERIOD_S)) {
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
