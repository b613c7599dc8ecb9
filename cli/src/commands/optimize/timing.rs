//! Servo limits on the timing of an optimised gait: `--max-rate` and `--period`.

use operations::optimize::timing::{GaitTiming, Request};

use crate::arguments::{rate, seconds};
use crate::quantity::{self, Rows};

/// Rates of the servos, and period of the gait.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct ServoTiming {
    /// Servos turn no faster than this angle a second: the gait is timed best under that limit instead of at constant power
    #[arg(long, value_name = "ANGLE_PER_S", value_parser = rate, requires = "period")]
    max_rate: Option<f64>,
    /// Seconds a cycle shall take with servos of that rate
    #[arg(long, value_name = "SECONDS", value_parser = seconds, requires = "max_rate")]
    period: Option<f64>,
}

impl ServoTiming {
    /// The requested timing, if a rate is given.
    pub(super) fn request(&self) -> Option<Request> {
        let (max_rate, period) = (self.max_rate?, self.period?);
        Some(Request { max_rate, period })
    }
}

/// Adds the cost of the limit. The efficiency of the timed gait is in the outputs that report one.
pub(super) fn add(rows: &mut Rows, timed: &GaitTiming) {
    let timing = &timed.timing;
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
        format!("{} a second", quantity::length(timed.speed_m_per_s)),
    );
}
