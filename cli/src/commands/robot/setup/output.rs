//! Output of a set-up, for people and for scripts.

use std::fmt;

use serde::Serialize;

use super::super::servo::Set;
use crate::quantity;

/// Results of a set-up, found and saved.
#[derive(Debug, Serialize)]
pub(super) struct Done {
    pub(super) swimmer: String,
    pub(super) front: Servo,
    pub(super) back: Servo,
    /// The larger of both: what the swimmer file says.
    pub(super) dead_band_rad: f64,
    pub(super) max_angle_rad: f64,
    pub(super) file: Option<String>,
}

#[derive(Debug, Serialize)]
pub(super) struct Servo {
    #[serde(flatten)]
    pub(super) set: Set,
    pub(super) dead_band_rad: f64,
}

impl fmt::Display for Done {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Saved on the robot, as `{}`:", self.swimmer)?;
        for servo in [&self.front, &self.back] {
            let [right, left] = servo.set.reach_rad.map(quantity::angle);
            writeln!(
                f,
                "  {:<5}  sign {}, centre {} µs, slope {} a µs, dead band ±{}, from {right} to {left}",
                servo.set.joint,
                servo.set.sign,
                servo.set.centre_us,
                quantity::angle(servo.set.slope_rad_per_us),
                quantity::angle(servo.dead_band_rad),
            )?;
        }
        match &self.file {
            Some(file) => write!(
                f,
                "{file} holds the swimmer with these servos: name it with --swimmer for predictions of a gait."
            ),
            None => write!(
                f,
                "No swimmer file was written: forecasts will take a dead band of their own."
            ),
        }
    }
}
