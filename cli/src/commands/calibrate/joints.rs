//! The joint angles as they were measured, and what the servos made of their commands.

use calibrate::{CampaignFit, Measured, MeasuredServo, RunResult};
use serde::Serialize;

use super::beyond_fit::ResultTable;
use crate::quantity::Table;

/// Servos of one run, or the mean of all runs: front and back.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct JointsOutput {
    front: MeasuredServo,
    back: MeasuredServo,
}

/// One run's angles.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct RunJoints {
    /// Share of the samples of cycles that count in which each angle was seen.
    seen: [f64; 2],
    /// Scatter of samples about the mean course, each \[rad\].
    scatter_rad: [f64; 2],
    /// Response of the servos to the command; null if the gait does not determine it.
    servos: Option<JointsOutput>,
}

impl From<[MeasuredServo; 2]> for JointsOutput {
    fn from([front, back]: [MeasuredServo; 2]) -> Self {
        Self { front, back }
    }
}

impl RunJoints {
    pub(super) fn of(run: &RunResult) -> Option<Self> {
        let joints = run.joints.as_ref()?;
        Some(Self {
            seen: joints.seen,
            scatter_rad: joints.scatter,
            servos: joints.servos.map(Into::into),
        })
    }
}

impl JointsOutput {
    pub(super) fn of(found: &CampaignFit) -> Option<Self> {
        found.servos().map(Into::into)
    }

    /// Table for people.
    pub(crate) fn shown(&self) -> ResultTable {
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
        for (name, servo) in [("front", &self.front), ("back", &self.back)] {
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
}
