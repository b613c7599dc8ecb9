//! Servo limits on the timing of an optimised gait: `--max-rate` and `--period`.

use std::path::Path;

use forecast::{Timing, TimingError, timing_of_table};
use gait_optimizer::{OptimalGait, SpeedProblem};
use serde::Serialize;
use swimmer_files::{AnyGait, Bounds, GaitFile};
use swimmer_model::{Model, Tolerance, swim};

use super::better::command;
use crate::arguments::{rate, seconds};
use crate::failure::{Failure, Outcome};
use crate::quantity::{self, Rows};
use crate::threads;

/// How fast the servos are, and in which period the gait shall run.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct ServoTiming {
    /// Servos turn no faster than this angle a second: the gait is timed best under that limit instead of at constant power
    #[arg(long, value_name = "ANGLE_PER_S", value_parser = rate, requires = "period")]
    pub(super) max_rate: Option<f64>,
    /// Seconds a cycle shall take with servos of that rate
    #[arg(long, value_name = "SECONDS", value_parser = seconds, requires = "max_rate")]
    pub(super) period: Option<f64>,
}

/// A gait's timing under the limit.
#[derive(Debug)]
struct Timed {
    timing: Timing,
    /// The gait with this timing.
    file: GaitFile,
    /// ξ of that file as it is timed.
    efficiency: f64,
}

/// What the limit costs.
#[derive(Debug, Serialize)]
pub(crate) struct TimingAnswer {
    #[serde(flatten)]
    timing: Timing,
    /// |d| over the period.
    speed_m_per_s: f64,
    /// The gait that is made for speed, where it is faster.
    #[serde(skip_serializing_if = "Option::is_none")]
    known_to_be_faster: Option<Faster>,
    /// ξ of the timed gait; answers that have an efficiency say it there.
    #[serde(skip)]
    pub(super) efficiency: f64,
}

/// The fastest gait within the same bounds on shapes and rate.
#[derive(Debug, Serialize)]
struct Faster {
    command: String,
    speed_m_per_s: f64,
    period_s: f64,
}

impl Faster {
    /// Than a gait of this speed \[m/s\]; none where it is not, or is not found.
    fn than(speed: f64, gait: &OptimalGait, swimmer: &str, rate: f64) -> Option<Self> {
        let bounds = Bounds {
            min_angle: None,
            sector: false,
            ..gait.bounds
        };
        let problem = SpeedProblem {
            bounds,
            threads: threads::available(),
            ..SpeedProblem::new(gait.swimmer, [rate; 2])
        };
        let found = problem.watched(&|_| ()).ok()?;
        let speed_m_per_s = found.speed_over_length * gait.swimmer.total_length();
        let rate = rate.to_string();
        (speed_m_per_s > speed).then(|| Self {
            command: command(
                "optimize speed",
                swimmer,
                &bounds,
                Some(("--max-rate", &rate)),
            ),
            speed_m_per_s,
            period_s: found.period,
        })
    }
}

impl ServoTiming {
    /// Times a gait, if that was asked for.
    fn of(&self, gait: &OptimalGait, file: &GaitFile) -> Outcome<Option<Timed>> {
        let (Some(max_rate), Some(period)) = (self.max_rate, self.period) else {
            return Ok(None);
        };
        let broken = |error: &dyn std::error::Error| Failure::tried(error);
        let model = Model::new(&gait.swimmer).map_err(|error| broken(&error))?;
        let (timing, file) = timing_of_table(&model, file, period, max_rate)?;
        let timed = AnyGait::from_file(&file).map_err(|error| broken(&error))?;
        Ok(Some(Timed {
            efficiency: swim(&model, &timed, &Tolerance::default()).efficiency(),
            timing,
            file,
        }))
    }

    /// Times a gait, if that was asked for, and writes it, if it was. Named are the swimmer in the file, and the one of the command
    /// line.
    pub(super) fn write(
        &self,
        gait: &OptimalGait,
        (name, swimmer): (&str, &str),
        path: Option<&Path>,
    ) -> Outcome<Option<TimingAnswer>> {
        let file = gait.gait_file(name);
        let timed = self.of(gait, &file)?;
        if let Some(path) = path {
            timed
                .as_ref()
                .map_or(&file, |timed| &timed.file)
                .save(path)?;
        }
        Ok(timed.map(|timed| timed.answer(gait, swimmer)))
    }
}

impl Timed {
    /// What is printed of it.
    fn answer(self, gait: &OptimalGait, swimmer: &str) -> TimingAnswer {
        let distance = gait
            .displacement_over_length
            .hypot(gait.lateral_over_length)
            * gait.swimmer.total_length();
        let speed_m_per_s = distance / self.timing.period;
        TimingAnswer {
            speed_m_per_s,
            known_to_be_faster: Faster::than(speed_m_per_s, gait, swimmer, self.timing.max_rate),
            timing: self.timing,
            efficiency: self.efficiency,
        }
    }
}

impl TimingAnswer {
    /// Lines for people.
    pub(super) fn rows(&self, rows: &mut Rows) {
        let timing = &self.timing;
        let rate = |value: f64| format!("{} a second", quantity::angle(value));
        rows.row(
            "timed for",
            format!(
                "{} s with joints of at most {} (shortest period {:.2} s)",
                timing.period,
                rate(timing.max_rate),
                timing.shortest_period
            ),
        )
        .row(
            "servo at limit",
            format!(
                "{:.1} % of the period; constant power would want {}",
                timing.at_limit * 100.0,
                rate(timing.rate_at_constant_power)
            ),
        )
        .row(
            "limit costs",
            format!("{:.3} % of ξ", timing.efficiency_loss * 100.0),
        )
        .row(
            "speed",
            format!("{} a second", quantity::length(self.speed_m_per_s)),
        );
        if let Some(faster) = &self.known_to_be_faster {
            rows.row(
                "known to be faster",
                format!(
                    "`{}`: {} a second, a cycle in {:.3} s",
                    faster.command,
                    quantity::length(faster.speed_m_per_s),
                    faster.period_s
                ),
            );
        }
    }
}

impl From<TimingError> for Failure {
    /// A gait that servos cannot run in time was tried; numbers that are none are bad input.
    fn from(error: TimingError) -> Self {
        match error {
            TimingError::Rate { .. } | TimingError::Period { .. } => Self::bad_input(&error),
            _ => Self::tried(&error),
        }
    }
}
