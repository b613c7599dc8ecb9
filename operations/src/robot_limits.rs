//! Limits of the robot of a swimmer file: whether it plays a gait, in the words of `robot upload`.

use forecast::{Played, Servos, forecast};
use link_protocol::MAX_KNOTS;
use swimmer_files::{AnyGait, ServoFile, SwimmerFile};
use swimmer_model::Model;

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
