//! Output of `swimmer robot go`.

use std::fmt;

use experiment::{Controller, Ending};
use serde::Serialize;

use super::super::playing::duration;
use crate::quantity;

/// End of a run.
#[derive(Debug, Serialize)]
pub(super) struct GoOutput {
    /// The goal is reached: the last target within the tolerance, or the heading held.
    reached: bool,
    /// Reason for the end.
    reason: String,
    /// Pose at the last rest; `null` if the robot was not seen at rest.
    pose: Option<RestPose>,
    /// Distance of that pose from the present target; `null` without a target.
    off_m: Option<f64>,
    off_rad: Option<f64>,
    /// Largest angle from the heading to hold, at rests; `null` with a target.
    held_within_rad: Option<f64>,
    cycles: u32,
    duration_s: f64,
    /// Tracked over predicted motion of the gaits forward, left and turn-left.
    gains: [f64; 3],
    /// Drift of the tank, x and y.
    drift_m_per_s: [f64; 2],
    /// Delay of the cameras beyond the one that they state, as the plays show it; `null` if they do not.
    camera_delay_s: Option<f64>,
    /// Departures of cycles from the prediction, in words.
    departures: Vec<String>,
}

/// Properties of the run that the controller does not know.
pub(super) struct RunOf {
    pub(super) duration_s: f64,
    pub(super) camera_delay_s: Option<f64>,
}

/// Pose of the middle link at rest, with half widths of 95 % intervals.
#[derive(Debug, Serialize)]
struct RestPose {
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
    interval_m: f64,
    interval_rad: f64,
}

/// Normal deviate of a 95 % interval.
const NORMAL_95: f64 = 1.96;

impl GoOutput {
    pub(super) fn new(controller: &Controller, run: &RunOf) -> Self {
        let (gains, drift) = controller.learned();
        let departures = controller
            .reports()
            .iter()
            .filter_map(|report| report.departure.as_ref())
            .map(|departure| {
                format!(
                    "since cycle {}: {}",
                    departure.since + 1,
                    departure.likeness
                )
            });
        let ending = controller.ending();
        let off = controller.off();
        Self {
            reached: ending.is_some_and(Ending::is_success),
            reason: ending.map(ToString::to_string).unwrap_or_default(),
            pose: controller.last_rest().map(|rest| RestPose {
                x_m: rest.x_m,
                y_m: rest.y_m,
                heading_rad: rest.heading_rad,
                interval_m: NORMAL_95 * rest.sigma_position_m,
                interval_rad: NORMAL_95 * rest.sigma_heading_rad,
            }),
            off_m: off.map(|[metres, _]| metres),
            off_rad: off.map(|[_, radians]| radians),
            held_within_rad: match ending {
                Some(Ending::Held { worst_rad }) => Some(*worst_rad),
                _ => None,
            },
            cycles: controller.cycles(),
            duration_s: run.duration_s,
            gains,
            drift_m_per_s: drift.into(),
            camera_delay_s: run.camera_delay_s,
            departures: departures.collect(),
        }
    }
}

impl fmt::Display for GoOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "After {} cycles and {}: {}.",
            self.cycles,
            duration(self.duration_s),
            self.reason
        )?;
        if let Some(pose) = &self.pose {
            write!(
                f,
                "\nThe robot is at ({:.4} m, {:.4} m), heading {}",
                pose.x_m,
                pose.y_m,
                quantity::angle(pose.heading_rad)
            )?;
            if let (Some(metres), Some(radians)) = (self.off_m, self.off_rad) {
                write!(
                    f,
                    ": {} and {} from the target",
                    quantity::length(metres),
                    quantity::angle(radians)
                )?;
            }
            f.write_str(".")?;
        }
        write!(
            f,
            "\nTracked over predicted motion: forward {:.3}, left {:.3}, turn {:.3}; drift ({:.2}, {:.2}) mm/s.",
            self.gains[0],
            self.gains[1],
            self.gains[2],
            self.drift_m_per_s[0] * 1e3,
            self.drift_m_per_s[1] * 1e3
        )?;
        if let Some(delay_s) = self.camera_delay_s {
            write!(
                f,
                "\nThe poses came {:.0} ms later than the cameras state.",
                delay_s * 1e3
            )?;
        }
        for departure in &self.departures {
            write!(f, "\n  note: {departure}")?;
        }
        Ok(())
    }
}
