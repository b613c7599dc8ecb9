//! `swimmer robot configure`: what the robot must know of its body.

use std::fmt;

use host_link::LinkError;
use link_protocol::{Configuration, Refusal, RobotLimits, TangentialDrag};
use serde::Serialize;
use swimmer_files::ServoFile;
use twin::configuration;

use super::Configure;
use super::access::Access;
use super::port::Pace;
use crate::arguments::load_robots_swimmer;
use crate::failure::{Failure, Outcome};
use crate::output::{Output, aside};
use crate::quantity;

#[derive(Debug, Serialize)]
struct Configured {
    swimmer: String,
    max_angle_rad: f32,
    max_rate_rad_s: f32,
}

impl fmt::Display for Configured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "The robot is configured as `{}`, joints within {} and {}/s.",
            self.swimmer,
            quantity::angle(f64::from(self.max_angle_rad)),
            quantity::angle(f64::from(self.max_rate_rad_s))
        )
    }
}

/// `swimmer robot configure`: limits come from the command line, else from the file's `[servo]` table, else stay.
pub(super) fn configure(access: &Access, arguments: &Configure, output: Output) -> Outcome {
    let file = load_robots_swimmer(&arguments.swimmer)?;
    let mut line = access.connect("swimmer robot configure", Pace::AsFastAsPossible)?;
    let robot = &mut line.robot;
    let present = robot.configuration()?;
    let servo = file.servo;
    #[allow(clippy::cast_possible_truncation)] // the wire's precision
    let limit = |typed: Option<f64>, in_file: Option<f64>, now: f32| {
        typed.or(in_file).map_or(now, |value| value as f32)
    };
    let wanted = Configuration {
        max_angle: limit(
            arguments.max_angle,
            servo.map(|servo| servo.max_angle),
            present.max_angle,
        ),
        max_rate: limit(
            arguments.max_rate,
            servo.map(|servo| servo.max_rate),
            present.max_rate,
        ),
        ..configuration(&file.swimmer, &ServoFile::default())?
    };
    let limits = robot.info().limits;
    robot
        .configure(wanted)
        .map_err(|error| refused(error, &wanted, &limits))?;
    output.print(&Configured {
        swimmer: file.name,
        max_angle_rad: wanted.max_angle,
        max_rate_rad_s: wanted.max_rate,
    });
    if line.is_fresh() {
        aside(&format!(
            "note: this robot ends with the command and forgets; name the swimmer in the port, as `--port twin:{0}`, or let \
             `swimmer twin --swimmer {0} --pty /tmp/robot` run and use `--port /tmp/robot`",
            arguments.swimmer
        ));
    }
    line.close()
}

/// The robot names a value that it refuses by its place in the configuration; people know it by its option or its key.
fn refused(error: LinkError, wanted: &Configuration, limits: &RobotLimits) -> Failure {
    let LinkError::Refused {
        refusal: Refusal::BadValue { field },
        ..
    } = error
    else {
        return error.into();
    };
    let most = |value: f32, limit: f32, per: &str| {
        let angle = |radians: f32| format!("{}{per}", quantity::angle(f64::from(radians)));
        let said = format!("{value} rad{per} ({})", angle(value));
        if value > limit {
            format!(
                "{said}; it takes at most {limit} rad{per} ({})",
                angle(limit)
            )
        } else {
            format!("{said}, too little")
        }
    };
    let (what, value) = match field {
        0 => (
            "the middle link's length ([links] middle)",
            metres(wanted.middle_m),
        ),
        1 => (
            "the front link's length ([links] side)",
            metres(wanted.front_m),
        ),
        2 => (
            "the back link's length ([links] side)",
            metres(wanted.back_m),
        ),
        3 => ("the ratio of drags χ ([drag] chi)", wanted.chi.to_string()),
        4 => (
            "the tangential drag ([drag] c_t)",
            match wanted.tangential_drag {
                TangentialDrag::LogAspect(value) => format!("log_aspect = {value}"),
                TangentialDrag::HalfThickness(value) => {
                    format!(
                        "half_thickness = {value} m, which must be thinner than every link is long"
                    )
                }
                TangentialDrag::OverViscosity(value) => format!("over_viscosity = {value}"),
            },
        ),
        5 => (
            "the sphere's radius ([sphere] radius)",
            metres(wanted.sphere_radius_m),
        ),
        6 => (
            "the largest joint angle (--max-angle, else [servo] max_angle)",
            most(wanted.max_angle, limits.max_angle, ""),
        ),
        7 => (
            "the largest joint rate (--max-rate, else [servo] max_rate)",
            most(wanted.max_rate, limits.max_rate, "/s"),
        ),
        _ => return error.into(),
    };
    Failure::Tried(format!(
        "while configuring the robot: the robot refuses {what}: {value}"
    ))
}

fn metres(value: f32) -> String {
    format!("{value} m")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every field that the robot can name has a name here, with its value.
    #[test]
    fn a_refused_value_is_named() {
        let preset = swimmer_files::SwimmerFile::preset("robot").unwrap();
        let wanted = configuration(&preset.swimmer, &ServoFile::default()).unwrap();
        let limits = RobotLimits {
            max_angle: 2.5,
            max_rate: 10.0,
            pulse_min_ns: 0,
            pulse_max_ns: 0,
            max_knots: 0,
            upload_window: 0,
        };
        let said = |field| {
            let error = LinkError::Refused {
                doing: "configuring the robot",
                refusal: Refusal::BadValue { field },
            };
            refused(error, &wanted, &limits).to_string()
        };
        for (field, words) in [
            (0, "[links] middle): 0.071 m"),
            (1, "front link's length ([links] side): 0.137 m"),
            (2, "back link's length ([links] side): 0.137 m"),
            (3, "[drag] chi): 3.598"),
            (4, "[drag] c_t): log_aspect = 4.543"),
            (5, "[sphere] radius): 0.0692 m"),
            (
                6,
                "[servo] max_angle): 2.8 rad (160.428°); it takes at most 2.5 rad (143.239°)",
            ),
            (7, "[servo] max_rate): 3.5 rad/s (200.535°/s), too little"),
        ] {
            assert!(said(field).contains(words), "{field}: {}", said(field));
        }
        assert!(said(8).contains("value number 8"), "{}", said(8));
    }
}
