//! One file for each subcommand: its arguments, what it calls, its answer.

pub(crate) mod calibrate;
pub(crate) mod demo;
pub(crate) mod optimize;
pub(crate) mod robot;
pub(crate) mod simulate;
pub(crate) mod tracks;
pub(crate) mod twin;

use crate::arguments::Command;
use crate::failure::Outcome;
use crate::output::Output;

/// Runs what was asked for.
///
/// # Errors
/// As the command.
pub(crate) fn run(command: Command, output: Output) -> Outcome {
    match command {
        Command::Demo(demo) => demo.run(output),
        Command::Calibrate(calibrate) => calibrate.run(output),
        Command::Simulate(simulate) => simulate.run(output),
        Command::Optimize(optimize) => optimize.run(output),
        Command::Robot(robot) => robot.run(output),
        Command::Twin(twin) => twin.run(output),
        Command::Tracks(tracks) => tracks.run(output),
    }
}
