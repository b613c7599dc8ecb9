//! `swimmer simulate --played`: options, and text rows of the forecast.

use operations::played::PlayedCycle;
use operations::simulate::{Options, PlayedOptions};

use crate::arguments::seconds;
use crate::quantity::{self, Rows};
use forecast::Servos;

/// Settings of the play on the robot.
#[derive(Debug, clap::Args)]
pub(super) struct Playing {
    /// Also predict a cycle on the robot, loss by loss: table, ticks, pulses, and the servos of the swimmer file (or the twin's,
    /// if it has none)
    #[arg(long)]
    played: bool,
    /// Seconds a cycle takes: for --played, and for torque and power where the swimmer file names a fluid
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "30")]
    pub(super) period: f64,
    /// Knots of the robot's table
    #[arg(long, value_name = "N", default_value_t = 512, requires = "played")]
    knots: usize,
    /// Step of the timer that makes the pulses, ns; 0 for none, as the twin's
    #[arg(long, value_name = "NS", default_value_t = Servos::ROBOT_PULSE_STEP_NS, requires = "played")]
    pulse_step: u32,
}

impl Playing {
    /// Options of the operation.
    pub(super) fn options(&self) -> Options {
        Options {
            period_s: self.period,
            played: self.played.then_some(PlayedOptions {
                knots: self.knots,
                pulse_step_ns: self.pulse_step,
            }),
        }
    }
}

/// Adds the forecast of a played cycle.
pub(crate) fn played_rows(played: &PlayedCycle, rows: &mut Rows) {
    let share = |share: Option<f64>| {
        share.map_or_else(String::new, |share| {
            format!("   {:.3} %", tidy(share * 100.0))
        })
    };
    rows.row(
        "as played",
        format!(
            "X = {:.3} mm, Y = {:.3} mm, turning {} a cycle of {} s",
            tidy(played.displacement_m * 1e3),
            tidy(played.lateral_m * 1e3),
            quantity::angle(played.rotation_rad),
            played.period_s
        ),
    );
    for loss in &played.losses {
        let name = match loss.by {
            "interpolation" => format!("lost by {} knots", played.knots),
            "rounding" => "lost by rounding".to_owned(),
            "ticks" => "lost by 50 Hz".to_owned(),
            "pulses" => "lost by pulses".to_owned(),
            "rate" => "lost by rate".to_owned(),
            _ => "lost by dead band".to_owned(),
        };
        rows.row(
            name,
            format!(
                "{:.4} mm{}",
                tidy(loss.loss_m * 1e3),
                share(loss.loss_share)
            ),
        );
    }
    rows.row(
        "lost in all",
        format!(
            "{:.4} mm{}",
            tidy(played.loss_m * 1e3),
            share(played.loss_share)
        ),
    )
    .row(
        "links apart",
        format!(
            "{:.2} mm at least (the robot keeps {:.2} mm)",
            played.gap_m * 1e3,
            played.gap_margin_m * 1e3
        ),
    )
    .row(
        "joints reach",
        format!(
            "φ{} = {} of ±{}",
            played.reach.joint,
            quantity::angle(played.reach.angle_rad),
            quantity::angle(played.reach.max_angle_rad)
        ),
    )
    .row(
        "shortest cycle",
        format!("{:.2} s on the robot", played.min_period_s),
    );
    for warning in &played.warnings {
        rows.row("note", warning.as_str());
    }
}

/// Rounded to four decimals without a minus before zero.
fn tidy(value: f64) -> f64 {
    (value * 1e4).round() / 1e4 + 0.0
}
