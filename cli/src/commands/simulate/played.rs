//! `swimmer simulate --played`: what the robot's table, pulses and servos leave of a gait.

use forecast::{Forecast, ForecastError, Loss, Played, Servos, Stage, forecast};
use serde::Serialize;
use swimmer_files::{AnyGait, SwimmerFile};
use swimmer_model::Model;

use crate::arguments::seconds;
use crate::failure::{Failure, Outcome};
use crate::quantity::{self, Rows};

/// How the robot plays.
#[derive(Debug, clap::Args)]
pub(super) struct Playing {
    /// Also foretell a cycle on the robot, loss by loss: table, ticks, pulses, and the servos of the swimmer file (or the
    /// twin's, where it names none)
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
    /// Foretells the cycle, if that was asked for.
    pub(super) fn forecast(
        &self,
        file: &SwimmerFile,
        model: &Model<f64>,
        gait: &AnyGait,
    ) -> Outcome<Option<PlayedAnswer>> {
        if !self.played {
            return Ok(None);
        }
        let played = Played {
            servos: Servos {
                file: file.servo.unwrap_or_default(),
                pulse_step_ns: self.pulse_step,
            },
            period: self.period,
            knots: self.knots,
        };
        Ok(Some(PlayedAnswer::new(&forecast(model, gait, &played)?)))
    }
}

/// A cycle as the tank will see it.
#[derive(Debug, Serialize)]
pub(crate) struct PlayedAnswer {
    period_s: f64,
    knots: usize,
    pulse_step_ns: u32,
    displacement_m: f64,
    lateral_m: f64,
    rotation_rad: f64,
    delta_y_m: f64,
    delta_theta_rad: f64,
    /// All losses together, of the displacement along the designed one.
    loss_m: f64,
    loss_share: Option<f64>,
    /// One for each imperfection, in order; they sum to the whole.
    losses: Vec<LossAnswer>,
    /// Of the circle that the played gait drives the robot round; none where it goes straight.
    turn_radius_m: Option<f64>,
    reach: ReachAnswer,
    /// Least distance of the side links' centre lines.
    gap_m: f64,
    gap_at_rad: [f64; 2],
    gap_designed_m: f64,
    gap_margin_m: f64,
    min_period_s: f64,
    pub(crate) refused: Option<String>,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct LossAnswer {
    by: &'static str,
    loss_m: f64,
    loss_share: Option<f64>,
    rotation_rad: f64,
}

#[derive(Debug, Serialize)]
struct ReachAnswer {
    u: f64,
    joint: usize,
    angle_rad: f64,
    max_angle_rad: f64,
}

impl PlayedAnswer {
    pub(crate) fn new(forecast: &Forecast) -> Self {
        let played = forecast.ends().map(|(_, played)| *played);
        let of = |value: fn(&Loss) -> f64| played.as_ref().map_or(f64::NAN, value);
        let radius = forecast.turn_radius();
        Self {
            period_s: forecast.played.period,
            knots: forecast.played.knots,
            pulse_step_ns: forecast.played.servos.pulse_step_ns,
            displacement_m: of(|loss| loss.displacement.x),
            lateral_m: of(|loss| loss.displacement.y),
            rotation_rad: of(|loss| loss.rotation),
            delta_y_m: of(|loss| loss.delta_y),
            delta_theta_rad: of(|loss| loss.delta_theta),
            loss_m: forecast.total_loss(),
            loss_share: forecast.share(forecast.total_loss()),
            losses: forecast
                .stages
                .iter()
                .filter(|loss| loss.stage != Stage::Designed)
                .map(|loss| LossAnswer {
                    by: loss.stage.word(),
                    loss_m: loss.loss,
                    loss_share: forecast.share(loss.loss),
                    rotation_rad: loss.turned,
                })
                .collect(),
            turn_radius_m: radius.is_finite().then_some(radius),
            reach: ReachAnswer {
                u: forecast.reach.u,
                joint: forecast.reach.joint + 1,
                angle_rad: forecast.reach.angle,
                max_angle_rad: forecast.played.servos.largest_angle(),
            },
            gap_m: forecast.gap.distance,
            gap_at_rad: forecast.gap.phi.into(),
            gap_designed_m: forecast.designed_gap.distance,
            gap_margin_m: forecast.margin,
            min_period_s: forecast.verdict.min_period,
            refused: forecast.refusal(),
            warnings: forecast
                .warnings()
                .into_iter()
                .chain(swallowed(forecast))
                .collect(),
        }
    }

    /// Lines for people.
    pub(crate) fn rows(&self, rows: &mut Rows) {
        let share = |share: Option<f64>| {
            share.map_or_else(String::new, |share| {
                format!("   {:.3} %", tidy(share * 100.0))
            })
        };
        rows.row(
            "as played",
            format!(
                "X = {:.3} mm, Y = {:.3} mm, turning {} a cycle of {} s",
                tidy(self.displacement_m * 1e3),
                tidy(self.lateral_m * 1e3),
                quantity::angle(self.rotation_rad),
                self.period_s
            ),
        );
        for loss in &self.losses {
            let name = match loss.by {
                "interpolation" => format!("lost by {} knots", self.knots),
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
                tidy(self.loss_m * 1e3),
                share(self.loss_share)
            ),
        )
        .row(
            "links apart",
            format!(
                "{:.2} mm at least (the robot keeps {:.2} mm)",
                self.gap_m * 1e3,
                self.gap_margin_m * 1e3
            ),
        )
        .row(
            "joints reach",
            format!(
                "φ{} = {} of ±{}",
                self.reach.joint,
                quantity::angle(self.reach.angle_rad),
                quantity::angle(self.reach.max_angle_rad)
            ),
        )
        .row(
            "shortest cycle",
            format!("{:.2} s on the robot", self.min_period_s),
        );
        for warning in &self.warnings {
            rows.row("note", warning.as_str());
        }
    }
}

/// A dead band takes nearly all of a gait that is hardly larger.
const SWALLOWED: f64 = 0.25;

fn swallowed(forecast: &Forecast) -> Option<String> {
    let lost = forecast
        .stages
        .iter()
        .find(|loss| loss.stage == Stage::Played)?;
    let share = forecast.share(lost.loss)?;
    (share >= SWALLOWED).then(|| {
        format!(
            "the servos' dead band of ±{} takes {:.0} % of this gait: use a larger one",
            quantity::angle(forecast.played.servos.file.dead_band),
            share * 100.0
        )
    })
}

/// Rounded to four decimals without a minus before zero.
fn tidy(value: f64) -> f64 {
    (value * 1e4).round() / 1e4 + 0.0
}

impl From<ForecastError> for Failure {
    /// What no robot can play is bad input.
    fn from(error: ForecastError) -> Self {
        Self::bad_input(&error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use calibrate::predict;
    use swimmer_files::ServoFile;

    /// The fit's own prediction knows nothing of stages: it follows the servos by straight pieces and estimates the cycle as
    /// from cameras. Its heading is a harmonic estimate, so the lengths of the displacements are compared.
    #[test]
    fn it_agrees_with_what_the_fit_predicts() {
        for (knots, servo) in [
            (512, ServoFile::default()),
            (
                512,
                ServoFile {
                    dead_band: 0.08,
                    ..ServoFile::default()
                },
            ),
        ] {
            let file = SwimmerFile {
                servo: Some(servo),
                ..SwimmerFile::preset("robot").unwrap()
            };
            let model = Model::new(&file.swimmer).unwrap();
            for gait in [
                AnyGait::circle(1.0),
                AnyGait::square(1.2),
                AnyGait::circle(1.5).reversed_if(true),
            ] {
                let played = Played {
                    servos: Servos {
                        file: servo,
                        pulse_step_ns: 0,
                    },
                    period: 30.0,
                    knots,
                };
                let told = forecast(&model, &gait, &played).unwrap();
                let (_, end) = told.ends().unwrap();
                let other = predict(&file, &gait, 30.0).unwrap();
                let ratio = end.displacement.norm() / other.x_m.hypot(other.y_m);
                assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
                assert!((end.rotation - other.rotation_rad).abs() < 1e-5);
            }
        }
    }
}
