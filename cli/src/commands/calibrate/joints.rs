//! Table of the joint angles as measured, and of the servos' response to their commands.

use calibrate::Measured;
use operations::calibrate::JointsOutput;

use super::beyond_fit::ResultTable;
use crate::quantity::Table;

/// Table for people.
pub(crate) fn table(servos: &JointsOutput) -> ResultTable {
    let mut table = Table::new(["measured joint", "gain", "dead band", "offset", "lag"]);
    let with = |measured: Measured, unit: f64, digits: usize, sign: &str| {
        let (value, error) = (measured.value * unit, measured.error * unit);
        if error.is_nan() {
            format!("{value:.digits$}{sign}")
        } else {
            format!("{value:.digits$} ± {error:.digits$}{sign}")
        }
    };
    let degree = 1.0_f64.to_degrees();
    for (name, servo) in [("front", &servos.front), ("back", &servos.back)] {
        table.line([
            name.to_owned(),
            with(servo.gain, 1.0, 4, ""),
            with(servo.dead_band, degree, 2, "°"),
            with(servo.offset, degree, 2, "°"),
            servo
                .lag
                .map_or_else(|| "–".to_owned(), |lag| with(lag, 1e3, 1, " ms")),
        ]);
    }
    ResultTable {
        title: "What the servos made of their commands, by the reflectors on the side links",
        table,
        notes: vec![
            "measured, not fitted: the model swims the angles that were seen; an offset’s error holds that of the reflector’s place. \
             A lag shows only where a flash or the robot’s log says when cycles began"
                .to_owned(),
        ],
    }
}
