//! Pre-flight: forecast of a gait on the robot and in its tank, before it is sent.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use forecast::{Forecast, Meeting, Played, Servos, Tank, forecast, forecast_passive, until_wall};
use link_protocol::{ANGLE_UNIT_RAD, Configuration, HelloReply, MAX_KNOTS, TangentialDrag};
use nalgebra::Vector2;
use passive_joint::PassiveJoint;
use serde::Serialize;
use swimmer_files::{AnyGait, GaitSpring, SwimmerFile};
use swimmer_model::{Links, Model, Pose, Swimmer};
use twin::is_configured_as;

use super::playing::duration;
use crate::arguments::{angle, load_fit, period};
use operations::played::PlayedCycle;

use crate::commands::simulate::played::played_rows;
use crate::failure::{Failure, Outcome};
use crate::quantity::{self, Rows};

/// Options of the forecast.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Foretell for this duration of a cycle
    #[arg(long, value_name = "SECONDS", value_parser = period, default_value = "30")]
    period: f64,
    /// Foretell with this fit's error (of swimmer calibrate: fit.json, or its --json)
    #[arg(long, value_name = "FIT.json")]
    fit: Option<PathBuf>,
    #[command(flatten)]
    room: TankOptions,
}

/// The tank, and the start pose in it.
#[derive(Debug, clap::Args)]
pub(super) struct TankOptions {
    /// Foretell when the swimmer meets a wall of this tank: length x width, m
    #[arg(long, value_name = "LENGTHxWIDTH")]
    pub(super) tank: Option<Tank>,
    /// Where in the tank it starts: from its centre along length and width, m
    #[arg(long, value_name = "X,Y", value_parser = tank_position, requires = "tank", allow_hyphen_values = true, default_value = "0,0")]
    start: TankPosition,
    /// Where the middle link heads at the start, from the tank's length
    #[arg(long, value_name = "ANGLE", value_parser = angle, requires = "tank", allow_hyphen_values = true, default_value = "0deg")]
    heading: f64,
}

/// A position in the tank, from its centre \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
struct TankPosition(Vector2<f64>);

/// The swimmer that plays the gait, and its servos.
pub(super) struct Player {
    pub(super) name: String,
    pub(super) swimmer: Swimmer<f64>,
    pub(super) servos: Servos,
    /// No swimmer file describes the servos, so typical values are assumed.
    assumed: bool,
}

impl Player {
    /// The swimmer of a file alone, without a robot.
    pub(super) fn of_file(file: &SwimmerFile) -> Self {
        Self {
            name: file.name.clone(),
            swimmer: file.swimmer,
            servos: Servos::on_the_robot(file.servo.unwrap_or_default()),
            assumed: file.servo.is_none(),
        }
    }

    /// The robot as configured, or body and servos of the file, if one is named, with the robot's limits.
    pub(super) fn of_robot(
        hello: &HelloReply,
        configuration: &Configuration,
        file: Option<&SwimmerFile>,
    ) -> Self {
        let servo_file = file.and_then(|file| file.servo);
        let (name, swimmer) = match file {
            Some(file) => (file.name.clone(), file.swimmer),
            None => configured(configuration),
        };
        Self {
            name,
            swimmer,
            servos: Servos::on_robot(servo_file.unwrap_or_default(), hello, configuration),
            assumed: servo_file.is_none(),
        }
    }
}

/// The swimmer of a robot's configuration, and the name of the preset that it equals.
pub(super) fn configured(configuration: &Configuration) -> (String, Swimmer<f64>) {
    let presets = SwimmerFile::PRESETS
        .iter()
        .filter_map(|name| SwimmerFile::preset(name));
    let known = presets
        .into_iter()
        .find(|file| is_configured_as(configuration, &file.swimmer));
    if let Some(file) = known {
        return (file.name, file.swimmer);
    }
    let swimmer = Swimmer {
        links: Links {
            middle: double(configuration.middle_m),
            front: double(configuration.front_m),
            back: double(configuration.back_m),
        },
        chi: double(configuration.chi),
        tangential_drag: match configuration.tangential_drag {
            TangentialDrag::LogAspect(value) => {
                swimmer_model::TangentialDrag::LogAspect(double(value))
            }
            TangentialDrag::HalfThickness(value) => {
                swimmer_model::TangentialDrag::HalfThickness(double(value))
            }
            TangentialDrag::OverViscosity(value) => {
                swimmer_model::TangentialDrag::OverViscosity(double(value))
            }
        },
        sphere_radius: double(configuration.sphere_radius_m),
        ..Swimmer::purcell()
    };
    ("as configured on the robot".to_owned(), swimmer)
}

/// The shortest decimal number that rounds to this single-precision number.
fn double(single: f32) -> f64 {
    f64::from_str(&single.to_string()).unwrap_or_else(|_| single.into())
}

/// Forecast of a gait on the robot.
#[derive(Debug, Serialize)]
pub(super) struct Preflight {
    gait: String,
    swimmer: String,
    max_rate_rad_s: f64,
    /// Largest rate that the robot allows \[rad/s\].
    max_rate_allowed_rad_s: f64,
    /// Unit of the table's angles.
    table_step_rad: f64,
    /// Angle of one step of the pulses' timer \[rad\].
    pulse_step_rad: f64,
    dead_band_rad: f64,
    /// True if the dead band is assumed, because no swimmer file with a `[servo]` was named.
    dead_band_assumed: bool,
    /// Half width of the displacement's interval, from the fit; `null` without a fit.
    displacement_error_m: Option<f64>,
    /// Level of that interval.
    level: Option<f64>,
    tank: Option<TankOutput>,
    #[serde(flatten)]
    played: PlayedCycle,
    /// Reason to refuse a gait that the robot would play.
    #[serde(skip)]
    pub(super) unseen_by_robot: Option<String>,
}

#[derive(Debug, Serialize)]
struct TankOutput {
    length_m: f64,
    width_m: f64,
    /// Cycles until a wall is met; `null` if none is.
    cycles: Option<f64>,
    seconds: Option<f64>,
    meets: Option<&'static str>,
    at_m: Option<[f64; 2]>,
}

impl TankOptions {
    /// Checks the options before any robot is contacted.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a start outside the tank.
    pub(super) fn check(&self) -> Outcome {
        let Some(tank) = &self.tank else {
            return Ok(());
        };
        let TankPosition(start) = self.start;
        let (along, across) = (tank.length / 2.0, tank.width / 2.0);
        if start.x.abs() < along && start.y.abs() < across {
            return Ok(());
        }
        Err(Failure::BadInput(format!(
            "the start {},{} lies outside the tank, which reaches ±{along} m along and ±{across} m across from its centre; \
             put --start inside",
            start.x, start.y
        )))
    }

    /// The start pose.
    pub(super) fn start(&self) -> Pose<f64> {
        let TankPosition(start) = self.start;
        Pose::new(start.x, start.y, self.heading)
    }
}

impl Arguments {
    /// Forecast for this duration of a cycle \[s\], without a fit and without a tank.
    pub(super) fn at_period(period: f64) -> Self {
        Self {
            period,
            fit: None,
            room: TankOptions {
                tank: None,
                start: TankPosition(Vector2::zeros()),
                heading: 0.0,
            },
        }
    }

    /// Checks the options before any robot is contacted.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a start outside the tank.
    pub(super) fn check(&self) -> Outcome {
        self.room.check()
    }

    /// Forecasts a gait.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for an invalid fit or swimmer, [`Failure::Tried`] for a gait that no robot can play.
    pub(super) fn foretell(
        &self,
        name: &str,
        gait: &AnyGait,
        spring: Option<&GaitSpring>,
        player: &Player,
    ) -> Outcome<Preflight> {
        let model = Model::new(&player.swimmer).map_err(|error| {
            Failure::BadInput(format!(
                "the swimmer `{}` cannot swim: {error}",
                player.name
            ))
        })?;
        let played = Played {
            servos: player.servos,
            period: self.period,
            knots: MAX_KNOTS,
        };
        let servo_file = match spring {
            None => forecast(&model, gait, &played),
            Some(spring) => {
                let passive = PassiveJoint::relaxing_in(&model, spring.joint.0, spring.relaxation);
                let passive = passive.map_err(|error| Failure::bad_input(&error))?;
                forecast_passive(&model, gait, &played, passive)
            }
        };
        let servo_file = servo_file.map_err(|error| Failure::tried(&error))?;
        let fit = self.fit.as_deref().map(load_fit).transpose()?;
        let error = fit
            .as_ref()
            .map(|fit| {
                let fitted = Swimmer {
                    sphere_radius: fit.sphere_radius,
                    chi: fit.chi,
                    ..player.swimmer
                };
                let intervals = (fit.sphere_radius_interval, fit.chi_interval);
                servo_file.displacement_error(&fitted, intervals.0, intervals.1, fit.correlation)
            })
            .transpose()
            .map_err(|error| Failure::bad_input(&error))?;
        let meeting = |tank: &Tank| until_wall(&model, &servo_file.way, tank, &self.room.start());
        let tank = self.room.tank.as_ref();
        let tank = tank.map(|tank| TankOutput::new(tank, meeting(tank), self.period));
        let mut preflight = Preflight::new(name, player, &servo_file);
        if let Some(tank) = tank.as_ref().filter(|tank| tank.is_too_small()) {
            preflight.refuse(format!("the tank of {tank}"));
        }
        Ok(Preflight {
            displacement_error_m: error,
            level: fit.map(|fit| fit.level),
            tank,
            ..preflight
        })
    }
}

impl Preflight {
    fn new(name: &str, player: &Player, servo_file: &Forecast) -> Self {
        let servos = &servo_file.played.servos;
        let allowed = servos.file.max_rate;
        Self {
            gait: name.to_owned(),
            swimmer: player.name.clone(),
            // In the shortest period the fastest joint just reaches the allowed rate.
            max_rate_rad_s: allowed * servo_file.verdict.min_period / servo_file.played.period,
            max_rate_allowed_rad_s: allowed,
            table_step_rad: double(ANGLE_UNIT_RAD),
            pulse_step_rad: f64::from(servos.pulse_step_ns) * 1e-3 * servos.file.slope_rad_per_us,
            dead_band_rad: servos.file.dead_band,
            dead_band_assumed: player.assumed,
            displacement_error_m: None,
            level: None,
            tank: None,
            played: PlayedCycle::new(servo_file),
            unseen_by_robot: servo_file
                .verdict
                .refused
                .is_none()
                .then(|| servo_file.too_close())
                .flatten(),
        }
    }

    /// Refuses the gait for a reason that the robot cannot check, unless it is refused already.
    fn refuse(&mut self, reason: String) {
        if self.played.refused.is_none() {
            self.played.refused = Some(reason.clone());
            self.unseen_by_robot = Some(reason);
        }
    }

    /// Reason to refuse the gait. Returns `None` if it may be played.
    pub(super) fn refusal(&self) -> Option<&str> {
        self.played.refused.as_deref()
    }
}

impl fmt::Display for Preflight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        rows.row(
            "fastest joint",
            format!(
                "{}/s of {}/s",
                quantity::angle(self.max_rate_rad_s),
                quantity::angle(self.max_rate_allowed_rad_s)
            ),
        )
        .row(
            "finest steps",
            format!(
                "{:.4}° in the table, {:.4}° in the pulses, dead band ±{:.3}°{}",
                self.table_step_rad.to_degrees(),
                self.pulse_step_rad.to_degrees(),
                self.dead_band_rad.to_degrees(),
                if self.dead_band_assumed {
                    " (assumed: name the swimmer file of `swimmer robot setup`)"
                } else {
                    ""
                }
            ),
        );
        played_rows(&self.played, &mut rows);
        rows.row(
            "error of X",
            match (self.displacement_error_m, self.level) {
                (Some(error), Some(level)) => format!(
                    "±{:.3} mm ({:.0} %, from the fit)",
                    error * 1e3,
                    level * 100.0
                ),
                _ => "not known: name a fit with --fit".to_owned(),
            },
        );
        if let Some(tank) = &self.tank {
            rows.row("tank", tank.to_string());
        }
        rows.row(
            "robot",
            match self.refusal() {
                None => "will play it".to_owned(),
                Some(reason) => format!("must not play it: {reason}"),
            },
        );
        write!(
            f,
            "Pre-flight of {}, swimmer {}\n{rows}",
            self.gait, self.swimmer
        )
    }
}

impl TankOutput {
    fn new(tank: &Tank, meeting: Option<Meeting>, period: f64) -> Self {
        Self {
            length_m: tank.length,
            width_m: tank.width,
            cycles: meeting.map(|meeting| meeting.cycles),
            seconds: meeting.map(|meeting| meeting.cycles * period),
            meets: meeting.map(|meeting| meeting.part.word()),
            at_m: meeting.map(|meeting| meeting.at.into()),
        }
    }
}

impl TankOutput {
    /// Returns true if a wall is met before the first cycle.
    fn is_too_small(&self) -> bool {
        self.cycles.is_some_and(|cycles| cycles <= 0.0)
    }
}

impl fmt::Display for TankOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} m by {} m: ", self.length_m, self.width_m)?;
        match (self.cycles, self.seconds, self.meets, self.at_m) {
            (Some(cycles), _, Some(part), _) if cycles <= 0.0 => {
                write!(f, "too small: {part} meets the wall before the first cycle")
            }
            (Some(cycles), Some(seconds), Some(part), Some([x, y])) => write!(
                f,
                "{part} meets the wall after {cycles:.1} cycles ({}), {:.0} mm along and {:.0} mm across from the centre",
                duration(seconds),
                x * 1e3,
                y * 1e3
            ),
            _ => write!(f, "no wall is met"),
        }
    }
}

fn tank_position(text: &str) -> Result<TankPosition, String> {
    let numbers = text
        .split_once(',')
        .map(|(x, y)| (f64::from_str(x.trim()), f64::from_str(y.trim())));
    match numbers {
        Some((Ok(x), Ok(y))) if x.is_finite() && y.is_finite() => {
            Ok(TankPosition(Vector2::new(x, y)))
        }
        _ => Err("write two lengths in metres from the tank's centre, as 0.1,-0.2".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_files::ServoFile;

    #[test]
    fn places_are_read() {
        assert_eq!(
            tank_position("0.1,-0.2"),
            Ok(TankPosition(Vector2::new(0.1, -0.2)))
        );
        for text in ["", "1", "1,", "nan,0", "1,2,3"] {
            assert!(tank_position(text).is_err(), "{text}");
        }
    }

    /// A robot's single-precision configuration is read back as the decimal swimmer that was sent.
    #[test]
    fn a_configured_robot_is_its_preset_or_its_own_numbers() {
        let robot = SwimmerFile::preset("robot").unwrap();
        let servo_file = twin::configuration(&robot.swimmer, &ServoFile::default()).unwrap();
        assert_eq!(configured(&servo_file), (robot.name, robot.swimmer));
        let other = Configuration {
            chi: 3.21,
            ..servo_file
        };
        let (name, swimmer) = configured(&other);
        assert_eq!(name, "as configured on the robot");
        assert_eq!((swimmer.chi, swimmer.links.front), (3.21, 0.137));
    }
}
