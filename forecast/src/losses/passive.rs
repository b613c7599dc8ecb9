//! Forecast with a spring in place of one servo: at every stage the passive joint responds, in its limit cycle, to the path of
//! the other joint's servo.

use gait_player::playback::PlayedPoint;
use nalgebra::Vector2;
use passive_joint::{LimitCycle, PassiveJoint};
use swimmer_files::AnyGait;
use swimmer_model::{Gait, GaitPoint, Model};

use super::{Forecast, ForecastError, Motion, Played, forecast_of};

/// Samples of the response to a curve.
const SAMPLES: usize = 1024;

/// Foretells a cycle of a gait whose passive joint has a spring in place of a servo, with κ over the period of `played`. The
/// gait is the designed limit cycle; its driven joint is played.
///
/// # Errors
/// As [`super::forecast`], and [`ForecastError::Passive`] if the passive joint has no limit cycle.
///
/// ```
/// use forecast::{Played, Servos, forecast_passive};
/// use link_protocol::Joint;
/// use passive_joint::{LimitCycle, PassiveJoint, Waveform};
/// use swimmer_files::{ServoFile, SwimmerFile};
/// use swimmer_model::Model;
///
/// let model = Model::new(&SwimmerFile::preset("robot").unwrap().swimmer)?;
/// let passive = PassiveJoint::relaxing_in(&model, Joint::Back, 0.15)?;
/// let drive = Waveform::sine(1.0).driving(Joint::Front);
/// let designed = LimitCycle::new(&model, &drive, passive)?;
/// let played = Played { servos: Servos::on_the_robot(ServoFile::default()), period: 20.0, knots: 512 };
/// let forecast = forecast_passive(&model, &designed, &played, passive)?;
/// // The table and the timer change little, the dead band takes some.
/// assert!(forecast.share(forecast.total_loss()).unwrap() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn forecast_passive<G: Gait<f64> + ?Sized>(
    model: &Model<f64>,
    gait: &G,
    played: &Played,
    passive: PassiveJoint,
) -> Result<Forecast, ForecastError> {
    let motion = Motion {
        of_curve: |curve: AnyGait| {
            let cycle = LimitCycle::new(model, &curve, passive)?;
            Ok(AnyGait::from_file(&cycle.gait_file(SAMPLES))?)
        },
        of_path: |path: &[PlayedPoint]| {
            let path = TimedPath::new(path, played.period);
            let cycle = LimitCycle::new(model, &path, passive)?;
            Ok(cycle.shapes().collect())
        },
    };
    forecast_of(model, gait, played, &motion)
}

/// Path of the servos on the clock of its cycle: straight pieces between points in time.
struct TimedPath {
    points: Vec<TimedPoint>,
}

#[derive(Clone, Copy)]
struct TimedPoint {
    u: f64,
    phi: Vector2<f64>,
}

impl TimedPath {
    fn new(path: &[PlayedPoint], period: f64) -> Self {
        let mut points: Vec<_> = path
            .iter()
            .map(|point| TimedPoint {
                u: point.time_s / period,
                phi: point.angles.into(),
            })
            .collect();
        // The end of a tick is the start of the next.
        points.dedup_by(|after, before| after.u <= before.u);
        Self { points }
    }
}

impl Gait<f64> for TimedPath {
    fn at(&self, u: f64) -> GaitPoint<f64> {
        let u = u - u.floor();
        let after = self.points.partition_point(|point| point.u <= u);
        let index = after.clamp(1, self.points.len().max(2) - 1);
        let (Some(from), Some(to)) = (self.points.get(index - 1), self.points.get(index)) else {
            return GaitPoint {
                phi: Vector2::zeros(),
                rate: Vector2::zeros(),
            };
        };
        let rate = (to.phi - from.phi) / (to.u - from.u);
        GaitPoint {
            phi: from.phi + rate * (u - from.u),
            rate,
        }
    }

    fn pieces(&self) -> usize {
        self.points.len().saturating_sub(1).max(1)
    }

    fn piece_end(&self, i: usize) -> f64 {
        self.points.get(i + 1).map_or(1.0, |point| point.u)
    }

    fn corner_at_end(&self, _i: usize) -> bool {
        true
    }
}
