//! Servo limits on the timing of an optimised gait: `--max-rate` and `--period`.

use forecast::{Timing, TimingError, timing_of_table};
use gait_optimizer::OptimalGait;
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::{Model, Tolerance, swim};

use super::Task;
use crate::arguments::{rate, seconds};
use crate::document::{Document, object};
use crate::failure::{Failure, Outcome};
use crate::quantity;

/// Rates of the servos, and period of the gait.
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
pub(super) struct Timed {
    timing: Timing,
    /// The gait with this timing.
    pub(super) file: GaitFile,
    /// ξ of that file as it is timed.
    pub(super) efficiency: f64,
    /// |d| over the period.
    speed_m_per_s: f64,
}

impl ServoTiming {
    /// Times a gait, if a rate was given.
    pub(super) fn of(&self, task: &Task, gait: &OptimalGait) -> Outcome<Option<Timed>> {
        let (Some(max_rate), Some(period)) = (self.max_rate, self.period) else {
            return Ok(None);
        };
        let broken = |error: &dyn std::error::Error| Failure::tried(error);
        let model = Model::new(&gait.swimmer).map_err(|error| broken(&error))?;
        let at_constant_power = gait.gait_file(&task.file.name);
        let (timing, file) = timing_of_table(&model, &at_constant_power, period, max_rate)?;
        let timed = AnyGait::from_file(&file).map_err(|error| broken(&error))?;
        let length = gait.swimmer.total_length();
        let distance = gait
            .displacement_over_length
            .hypot(gait.lateral_over_length)
            * length;
        Ok(Some(Timed {
            efficiency: swim(&model, &timed, &Tolerance::default()).efficiency(),
            speed_m_per_s: distance / timing.period,
            timing,
            file,
        }))
    }
}

impl Timed {
    /// Adds the cost of the limit. ξ of the timed gait is reported by outputs with an efficiency.
    pub(super) fn add(&self, document: &mut Document) {
        let timing = &self.timing;
        let rate = |value: f64| format!("{} a second", quantity::angle(value));
        let keys = object! {
            "period_s": timing.period,
            "period_min_s": timing.shortest_period,
            "max_rate_rad_s": timing.max_rate,
            "rate_at_constant_power_rad_s": timing.rate_at_constant_power,
            "at_limit": timing.at_limit,
            "efficiency_loss": timing.efficiency_loss,
            "speed_m_per_s": self.speed_m_per_s,
        };
        document
            .row(
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
        document.key("timing", keys);
    }
}

impl From<TimingError> for Failure {
    /// A gait that servos cannot run in time was tried; invalid numbers are bad input.
    fn from(error: TimingError) -> Self {
        match error {
            TimingError::Rate { .. } | TimingError::Period { .. } => Self::bad_input(&error),
            _ => Self::tried(&error),
        }
    }
}
