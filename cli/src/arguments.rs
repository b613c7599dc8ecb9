//! The command line as one type, and the values on it that several commands share.

use std::str::FromStr;

use clap::{Parser, Subcommand};
use swimmer_files::{AnyGait, GaitSpec, SwimmerFile, parse_angle};
use swimmer_model::Model;

use crate::commands::{calibrate, demo, optimize, robot, simulate, tracks, twin};
use crate::failure::{Failure, Outcome};

/// Optimal gaits for Purcell's three-link swimmer and its robot: model, optimise, play, track, fit.
#[derive(Debug, Parser)]
#[command(
    name = "swimmer",
    version,
    max_term_width = 100,
    arg_required_else_help = true
)]
#[command(after_help = "\
Angles are 70deg, 1.2rad or a bare number of radians.
SWIMMER is purcell, robot, robot-slender or the path of a swimmer file (TOML).
GAIT is circle:AMPLITUDE, square:AMPLITUDE or the path of a gait file; add :cw to reverse it.
Exit status: 0 done, 1 tried and failed, 2 bad usage or bad input.")]
pub(crate) struct Arguments {
    /// Print one JSON document on standard output; everything else goes to standard error
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What `swimmer` can do; the help of each command stands at its arguments.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(demo::Demo),
    Simulate(simulate::Simulate),
    #[command(subcommand)]
    Optimize(optimize::Optimize),
    Robot(robot::Robot),
    Twin(twin::Twin),
    Calibrate(calibrate::Calibrate),
    Tracks(tracks::Tracks),
}

/// An angle on the command line, in radians.
pub(crate) fn angle(text: &str) -> Result<f64, String> {
    parse_angle(text).map_err(|error| error.to_string())
}

/// An angle above zero on the command line, in radians.
pub(crate) fn positive_angle(text: &str) -> Result<f64, String> {
    let angle = angle(text)?;
    if angle > 0.0 {
        Ok(angle)
    } else {
        Err("the angle must be above zero".to_owned())
    }
}

/// A time above zero on the command line, in seconds.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('s').unwrap_or(text).trim_end();
    match f64::from_str(number) {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("write a number of seconds above zero, as 30 or 2.5".to_owned()),
    }
}

/// What `--gait` names, still to be loaded.
pub(crate) fn gait(text: &str) -> Result<GaitSpec, String> {
    text.parse()
        .map_err(|error: swimmer_files::GaitSpecError| error.to_string())
}

/// Loads what `--swimmer` names.
pub(crate) fn load_swimmer(preset_or_path: &str) -> Outcome<SwimmerFile> {
    Ok(SwimmerFile::find(preset_or_path)?)
}

/// Loads what `--gait` names.
pub(crate) fn load_gait(spec: &GaitSpec) -> Outcome<AnyGait> {
    Ok(spec.load()?)
}

/// The model of a swimmer.
pub(crate) fn model(file: &SwimmerFile) -> Outcome<Model<f64>> {
    Model::new(&file.swimmer).map_err(|error| {
        Failure::BadInput(format!("the swimmer `{}` cannot swim: {error}", file.name))
    })
}

impl From<swimmer_files::FileError> for Failure {
    /// A file that cannot be read, or says something wrong, is bad input; one that cannot be written is a failed try.
    fn from(error: swimmer_files::FileError) -> Self {
        match error {
            swimmer_files::FileError::Write { .. } => Self::tried(&error),
            _ => Self::bad_input(&error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }

    #[test]
    fn times_are_positive() {
        assert_eq!(seconds("30"), Ok(30.0));
        assert_eq!(seconds("2.5s"), Ok(2.5));
        for text in ["0", "-1", "nan", "inf", "s", "1m", ""] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
