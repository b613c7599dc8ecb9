//! One cycle as the robot plays it: losses by table, ticks, pulses and servos.

use forecast::{Forecast, Loss, Stage};
use serde::Serialize;

use crate::text::degrees;

/// Forecast of a played cycle.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlayedCycle {
    /// Duration of the cycle \[s\].
    pub period_s: f64,
    /// Knots of the robot's table.
    pub knots: usize,
    /// Step of the timer that makes the pulses \[ns\].
    pub pulse_step_ns: u32,
    /// Displacement along the swimmer \[m\].
    pub displacement_m: f64,
    /// Displacement across the swimmer \[m\].
    pub lateral_m: f64,
    /// Net rotation \[rad\].
    pub rotation_rad: f64,
    /// Sway ΔY \[m\].
    pub delta_y_m: f64,
    /// Yaw Δθ \[rad\].
    pub delta_theta_rad: f64,
    /// Sum of all losses of displacement, along the designed displacement \[m\].
    pub loss_m: f64,
    /// The same as a share of the designed displacement.
    pub loss_share: Option<f64>,
    /// Loss by each imperfection, in order. They sum to [`loss_m`](Self::loss_m).
    pub losses: Vec<PlayedLoss>,
    /// Radius of the circle on which the played gait swims \[m\]. `None` if it swims straight.
    pub turn_radius_m: Option<f64>,
    /// Largest joint angle.
    pub reach: Reach,
    /// Smallest distance of the side links' centre lines \[m\].
    pub gap_m: f64,
    /// Joint angles at that distance \[rad\].
    pub gap_at_rad: [f64; 2],
    /// Smallest distance in the designed gait \[m\].
    pub gap_designed_m: f64,
    /// Distance that the robot keeps \[m\].
    pub gap_margin_m: f64,
    /// Shortest cycle that the robot accepts \[s\].
    pub min_period_s: f64,
    /// Reason why the robot refuses the gait.
    pub refused: Option<String>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// Displacement lost to one imperfection.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlayedLoss {
    /// Name of the imperfection.
    pub by: &'static str,
    /// Loss along the designed displacement \[m\].
    pub loss_m: f64,
    /// The same as a share of the designed displacement.
    pub loss_share: Option<f64>,
    /// Rotation that it adds \[rad\].
    pub rotation_rad: f64,
}

/// Largest joint angle of a cycle.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reach {
    /// Phase, from 0 to 1.
    pub u: f64,
    /// Joint: 1 or 2.
    pub joint: usize,
    /// Angle \[rad\].
    pub angle_rad: f64,
    /// Largest angle of the servos \[rad\].
    pub max_angle_rad: f64,
}

impl PlayedCycle {
    /// Output of a forecast.
    pub fn new(forecast: &Forecast) -> Self {
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
                .map(|loss| PlayedLoss {
                    by: loss.stage.word(),
                    loss_m: loss.loss,
                    loss_share: forecast.share(loss.loss),
                    rotation_rad: loss.turned,
                })
                .collect(),
            turn_radius_m: radius.is_finite().then_some(radius),
            reach: Reach {
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
}

/// Share of the displacement from which a loss to the dead band is worth a warning.
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
            degrees(forecast.played.servos.file.dead_band),
            share * 100.0
        )
    })
}

#[cfg(test)]
mod tests {
    use calibrate::predict;
    use forecast::{Played, Servos, forecast};
    use swimmer_files::{AnyGait, ServoFile, SwimmerFile};
    use swimmer_model::Model;

    /// The fit's own prediction has no stages: it follows the servos piecewise linearly and estimates the cycle as from
    /// cameras. Its heading is a harmonic estimate, so the lengths of the displacements are compared.
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
                let predicted = forecast(&model, &gait, &played).unwrap();
                let (_, end) = predicted.ends().unwrap();
                let other = predict(&file, &gait, 30.0).unwrap();
                let ratio = end.displacement.norm() / other.x_m.hypot(other.y_m);
                assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
                assert!((end.rotation - other.rotation_rad).abs() < 1e-5);
            }
        }
    }
}
