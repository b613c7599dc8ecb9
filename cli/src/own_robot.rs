//! Whether the robot of a swimmer file can play a gait, in the words of `robot upload`.

use forecast::{Played, Servos, forecast};
use link_protocol::MAX_KNOTS;
use swimmer_files::{AnyGait, SwimmerFile};
use swimmer_model::Model;

use crate::output::aside;

/// Says where a gait goes beyond the `[servo]` of the file: angle, clearance of the links, rate at this period.
pub(crate) fn say_if_beyond(file: &SwimmerFile, gait: &AnyGait, period: f64) {
    let (Some(servo), Ok(model)) = (file.servo, Model::new(&file.swimmer)) else {
        return;
    };
    let played = Played {
        servos: Servos::on_the_robot(servo),
        period,
        knots: MAX_KNOTS,
    };
    let reason = match forecast(&model, gait, &played) {
        Err(error) => error.to_string(),
        Ok(foretold) => match foretold.verdict.refused {
            Some(refused) => format!("the robot would refuse: {refused}"),
            None if foretold.verdict.min_period > period => format!(
                "at {period} s a cycle the gait turns the joints faster than the servos' {:.1}°/s; the robot plays it in {:.2} s at least",
                servo.max_rate.to_degrees(),
                foretold.verdict.min_period
            ),
            None => return,
        },
    };
    aside(&format!(
        "warning: {}: {reason} (`swimmer optimize … --playable` keeps a gait within angle and clearance)",
        file.name
    ));
}
