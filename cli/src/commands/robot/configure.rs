//! `swimmer robot configure`: what the robot must know of its body.

use std::fmt;

use link_protocol::Configuration;
use serde::Serialize;
use swimmer_files::ServoFile;
use swimmer_model::Swimmer;
use twin::configuration;

use super::Configure;
use super::access::Access;
use super::port::Pace;
use crate::arguments::load_swimmer;
use crate::failure::Outcome;
use crate::output::Output;
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
    let file = load_swimmer(&arguments.swimmer)?;
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
        ..configuration(&file.swimmer, &ServoFile::default())
    };
    robot.configure(wanted)?;
    output.answer(&Configured {
        swimmer: file.name,
        max_angle_rad: wanted.max_angle,
        max_rate_rad_s: wanted.max_rate,
    });
    line.close()
}

/// Whether the robot's configuration is this swimmer's body, to the wire's precision; its limits do not matter.
pub(super) fn is_configured_as(present: &Configuration, swimmer: &Swimmer<f64>) -> bool {
    let told = configuration(swimmer, &ServoFile::default());
    Configuration {
        max_angle: present.max_angle,
        max_rate: present.max_rate,
        ..told
    } == *present
}
