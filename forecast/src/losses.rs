//! Losses of a gait's displacement on the robot, predicted before it is sent: the same table, brain arithmetic, pulses and servo
//! plant that the robot plays it by ([`gait_player::playback`]), with the imperfections switched on one by one.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "periods and pulses are bounded by what was checked; f32 is what the robot itself uses"
)]

mod gap;
mod passive;
mod servos;
mod stages;

use gait_player::playback::PlayedPoint;
use gait_player::table::TableError;
use nalgebra::Vector2;
use passive_joint::PassiveError;
use swimmer_files::{AnyGait, ServoFile, UnplayablePeriod, check_playable_period};
use swimmer_model::{Gait, InvalidSamples, Model, Swimmer, Tolerance};

use crate::path::Polyline;
use crate::reach::{Reach, reach};
pub use gap::Gap;
pub use passive::forecast_passive;
pub use servos::Servos;
pub(crate) use stages::verdict;

/// Settings of a play.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Played {
    /// Servos of the robot.
    pub servos: Servos,
    /// Duration of a cycle \[s\].
    pub period: f64,
    /// Knots of the table, 2 to 512.
    pub knots: usize,
}

/// Reason why no forecast can be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForecastError {
    /// The gait fits in no table.
    #[error("the robot cannot hold this gait: {0}")]
    Table(#[from] TableError),
    /// Its knots make no curve.
    #[error("the gait's knots make no curve: {0}")]
    Knots(#[from] InvalidSamples),
    /// The passive joint has no limit cycle.
    #[error(transparent)]
    Passive(#[from] PassiveError),
    /// The gait leaves the servos' range.
    #[error(
        "the gait turns φ{} to {:.4} rad at u = {:.4}, beyond the servos' largest angle of {max_angle} rad, so no robot plays \
         it; optimise with --max-angle {max_angle}",
        .reach.joint + 1, .reach.angle, .reach.u
    )]
    Range {
        /// Place of the largest angle.
        reach: Reach,
        /// The servos' largest angle \[rad\].
        max_angle: f64,
    },
    /// No robot plays cycles of this period.
    #[error(transparent)]
    Period(#[from] UnplayablePeriod),
    /// A parameter of the servos is invalid.
    #[error("the servos' {name} is {value}; {problem}")]
    Servo {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Requirement that it violates.
        problem: &'static str,
    },
}

/// Stages of a gait on its way to the servos' shafts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// The gait itself.
    Designed,
    /// Sampled at the table's knots, with the table's cubic between them.
    Interpolated,
    /// Knots rounded to 1e-4 rad.
    Rounded,
    /// Set-points every 20 ms, held between.
    Ticked,
    /// Set-points as pulses in steps of the timer.
    Pulsed,
    /// Servos that turn no faster than they can.
    RateLimited,
    /// Servos with their dead band: what the tank sees.
    Played,
}

impl Stage {
    /// All of them, in order.
    pub const ALL: [Self; 7] = [
        Self::Designed,
        Self::Interpolated,
        Self::Rounded,
        Self::Ticked,
        Self::Pulsed,
        Self::RateLimited,
        Self::Played,
    ];

    /// Imperfection that this stage adds, in a word for people and scripts.
    pub fn word(self) -> &'static str {
        match self {
            Self::Designed => "designed",
            Self::Interpolated => "interpolation",
            Self::Rounded => "rounding",
            Self::Ticked => "ticks",
            Self::Pulsed => "pulses",
            Self::RateLimited => "rate",
            Self::Played => "dead_band",
        }
    }
}

/// One cycle as it is up to a stage. Everything is in the frame of the designed gait's first shape, so that stages compare.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    /// The stage.
    pub stage: Stage,
    /// Net displacement (X, Y) with all imperfections up to this one \[m\].
    pub displacement: Vector2<f64>,
    /// Net rotation \[rad\].
    pub rotation: f64,
    /// ΔY \[m\].
    pub delta_y: f64,
    /// Δθ \[rad\].
    pub delta_theta: f64,
    /// Loss of displacement along the designed displacement due to this imperfection \[m\]; negative for a gain. The losses of
    /// all stages sum to the total loss.
    pub loss: f64,
    /// Its contribution to the net rotation \[rad\].
    pub turned: f64,
}

/// Result of the robot's own checks of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Reason why the robot would refuse the table or the period; `None` if it plays.
    pub refused: Option<String>,
    /// The shortest period that it allows for this table \[s\].
    pub min_period: f64,
}

/// Prediction of one cycle on the robot, in its steady state.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// Settings of the play.
    pub played: Played,
    /// Stage by stage, in the order of [`Stage::ALL`].
    pub stages: Vec<Loss>,
    /// The way of the joints through one cycle as the servos take it, from the designed gait's first shape back to it.
    pub way: Polyline,
    /// The joint that turns furthest.
    pub reach: Reach,
    /// Closest approach of the side links on the path that the servos take.
    pub gap: Gap,
    /// Closest approach of the side links on the designed curve.
    pub designed_gap: Gap,
    /// Twice the half thickness of the links: centre lines that come closer mean plates that touch \[m\].
    pub thickness: f64,
    /// The margin that the robot keeps: one degree at the tip of the longer side link \[m\].
    pub margin: f64,
    /// Result of the robot's checks.
    pub verdict: Verdict,
}

/// Thickness of the robot's plates \[m\] if the swimmer's drag does not define a half thickness.
const PLATE: f64 = 0.005;

/// Thickness of a swimmer's plates \[m\]: centre lines that come closer mean plates that touch.
///
/// ```
/// use swimmer_model::Swimmer;
///
/// assert_eq!(forecast::thickness(&Swimmer::robot()), 0.005);
/// ```
pub fn thickness(swimmer: &Swimmer<f64>) -> f64 {
    match swimmer.tangential_drag {
        swimmer_model::TangentialDrag::HalfThickness(half) => 2.0 * half,
        _ => PLATE,
    }
}

/// Foretells a cycle of a gait, played over and over, in its second cycle: the servos have forgotten where they came from.
///
/// # Errors
/// [`ForecastError`]: numbers that no robot can play.
pub fn forecast<G: Gait<f64> + ?Sized>(
    model: &Model<f64>,
    gait: &G,
    played: &Played,
) -> Result<Forecast, ForecastError> {
    let shape = |point: &PlayedPoint| Vector2::from(point.angles);
    let motion = Motion {
        of_curve: Ok,
        of_path: |path: &[PlayedPoint]| Ok(path.iter().map(shape).collect()),
    };
    forecast_of(model, gait, played, &motion)
}

/// Motion of both joints for what the servos command, as a curve and along a path: that of the servos, or with the response of a
/// passive joint.
pub(crate) struct Motion<C, P> {
    pub(crate) of_curve: C,
    pub(crate) of_path: P,
}

fn forecast_of<G, C, P>(
    model: &Model<f64>,
    gait: &G,
    played: &Played,
    motion: &Motion<C, P>,
) -> Result<Forecast, ForecastError>
where
    G: Gait<f64> + ?Sized,
    C: Fn(AnyGait) -> Result<AnyGait, ForecastError>,
    P: Fn(&[PlayedPoint]) -> Result<Vec<Vector2<f64>>, ForecastError>,
{
    played.validate()?;
    let reach = reach(gait);
    // The table's own rounding is no trespass.
    if reach.angle.abs() > played.servos.largest_angle() + 1e-4 {
        return Err(ForecastError::Range {
            reach,
            max_angle: played.servos.largest_angle(),
        });
    }
    let ways = stages::Ways::new(gait, played, motion)?;
    let swum = ways.swum(model, gait);
    let designed = swum
        .first()
        .map(|stroke| stroke.displacement)
        .unwrap_or_default();
    // A gait that goes nowhere loses along x.
    let along = designed
        .try_normalize(1e-12 * model.swimmer().total_length())
        .unwrap_or_else(Vector2::x);
    let before = swum.iter().take(1).chain(&swum);
    let stages = Stage::ALL.into_iter().zip(before.zip(&swum));
    let stages = stages.map(|(stage, (before, stroke))| Loss {
        stage,
        displacement: stroke.displacement,
        rotation: stroke.rotation,
        delta_y: stroke.delta_y,
        delta_theta: stroke.delta_theta,
        loss: along.dot(&(before.displacement - stroke.displacement)),
        turned: stroke.rotation - before.rotation,
    });
    let links = model.swimmer().links;
    let [.., way] = ways.chains;
    Ok(Forecast {
        played: *played,
        stages: stages.collect(),
        reach,
        gap: Gap::along(&links, &way),
        way,
        designed_gap: Gap::of_gait(&links, gait),
        thickness: thickness(model.swimmer()),
        margin: gap::margin(&links),
        verdict: verdict(&ways.table, &links, &played.servos, played.period_us()),
    })
}

impl Played {
    /// Duration of a cycle \[µs\].
    pub fn period_us(&self) -> u32 {
        (self.period * 1e6).round() as u32
    }

    fn validate(&self) -> Result<(), ForecastError> {
        check_playable_period(self.period)?;
        let ServoFile {
            max_angle,
            max_rate,
            dead_band,
            slope_rad_per_us,
            centre_us,
            torque: _,
            no_load_rate: _,
        } = self.servos.file;
        let wrong = |name, value, problem| {
            Err(ForecastError::Servo {
                name,
                value,
                problem,
            })
        };
        let positive = [
            ("largest angle [rad]", max_angle),
            ("largest rate [rad/s]", max_rate),
            ("slope [rad/µs]", slope_rad_per_us),
            ("centre pulse [µs]", centre_us),
        ];
        for (name, value) in positive {
            if value.is_nan() || value <= 0.0 {
                return wrong(name, value, "give a number above 0");
            }
        }
        if !(dead_band >= 0.0 && dead_band.is_finite()) {
            return wrong("dead band [rad]", dead_band, "give 0 or a number above");
        }
        Ok(())
    }
}

impl Forecast {
    /// The cycle as designed and as played.
    pub fn ends(&self) -> Option<(&Loss, &Loss)> {
        Some((self.stages.first()?, self.stages.last()?))
    }

    /// All losses together \[m\].
    pub fn total_loss(&self) -> f64 {
        self.stages.iter().map(|stage| stage.loss).sum()
    }

    /// A loss as a share of the designed displacement; none for a gait that goes nowhere.
    pub fn share(&self, loss: f64) -> Option<f64> {
        let designed = self.stages.first()?.displacement.norm();
        (designed > 0.0).then(|| loss / designed)
    }

    /// Radius of the circle on which the played gait drives the swimmer round, cycle after cycle \[m\]; infinite where it
    /// goes straight.
    pub fn turn_radius(&self) -> f64 {
        let Some((_, played)) = self.ends() else {
            return f64::INFINITY;
        };
        if played.rotation.abs() < 1e-9 {
            // Rounding, no turn.
            return f64::INFINITY;
        }
        played.displacement.norm() / (2.0 * (0.5 * played.rotation.abs()).sin().abs())
    }

    /// Returns why the gait must not be played: the robot's own refusal, or side links that come too close. `None` if it may be
    /// played.
    pub fn refusal(&self) -> Option<String> {
        let refused = self.verdict.refused.clone();
        refused.or_else(|| self.too_close())
    }

    /// Returns how close the side links come on the path that the servos take, if that is below the robot's margin. The robot
    /// checks its table alone, with half of the margin between two evaluations.
    pub fn too_close(&self) -> Option<String> {
        (self.gap.distance < self.margin).then(|| {
            format!(
                "the side links come within {:.2} mm of each other as the servos play it, below the robot's margin of {:.2} mm (one degree at the tip)",
                self.gap.distance * 1e3,
                self.margin * 1e3
            )
        })
    }

    /// Warnings to read before the gait is sent.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let mm = |length: f64| length * 1e3;
        if let Some(reason) = self.too_close() {
            warnings.push(reason);
        } else if self.gap.distance < self.thickness {
            warnings.push(format!(
                "the side links' centre lines come within {:.2} mm, below the plates' thickness of {:.2} mm: they pass only if they lie in different planes",
                mm(self.gap.distance),
                mm(self.thickness)
            ));
        }
        warnings.extend(
            self.verdict
                .refused
                .as_ref()
                .map(|reason| format!("the robot would refuse: {reason}")),
        );
        if let Some((_, played)) = self.ends()
            && played.rotation.abs() > TURNING
        {
            warnings.push(format!(
                "the robot turns by {:.3}° a cycle and goes round a circle of radius {:.3} m",
                played.rotation.to_degrees(),
                self.turn_radius()
            ));
        }
        warnings
    }
}

/// Net rotation a cycle that is worth a warning \[rad\]: a turn of one degree in ten cycles.
const TURNING: f64 = 0.001_745;

/// Tolerance of the integration of each stage, below the smallest loss that is reported.
pub(crate) fn tolerance() -> Tolerance {
    Tolerance::new(1e-10)
}

#[cfg(test)]
mod tests;
