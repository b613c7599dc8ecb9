//! The command line as one type, with one file for each subcommand: its arguments, the call, its output.

pub(crate) mod atlas;
pub(crate) mod calibrate;
pub(crate) mod certify;
pub(crate) mod demo;
mod examples;
pub(crate) mod experiment;
pub(crate) mod height_map;
pub(crate) mod lab;
pub(crate) mod optimize;
pub(crate) mod paper;
pub(crate) mod plan;
pub(crate) mod robot;
pub(crate) mod shell;
pub(crate) mod simulate;
pub(crate) mod sweep;
pub(crate) mod swimmers;
pub(crate) mod track;
pub(crate) mod tracks;
pub(crate) mod twin;

use clap::{CommandFactory as _, Parser, Subcommand};

use crate::failure::Outcome;
use crate::output::Output;

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
SWIMMER is a preset (`swimmer swimmers` lists them) or the path of a swimmer file (TOML).
GAIT is circle:AMPLITUDE, square:AMPLITUDE or the path of a gait file; add :cw to reverse it.
Exit status: 0 done, 1 tried and failed, 2 bad usage or bad input.")]
pub(crate) struct Arguments {
    /// Print one JSON document on standard output; everything else goes to standard error
    #[arg(long, global = true, help_heading = "Options of every command")]
    pub(crate) json: bool,
    /// Replace files that exist; without it a command that would write one refuses
    #[arg(long, global = true, help_heading = "Options of every command")]
    pub(crate) overwrite: bool,
    /// Also print details for experts: the origin of a result, and the course of a search that failed
    #[arg(long, global = true, help_heading = "Options of every command")]
    pub(crate) verbose: bool,
    /// Command to run.
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Commands of `swimmer`; the help of each is at its arguments.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(demo::Demo),
    Simulate(simulate::Simulate),
    #[command(subcommand)]
    Optimize(optimize::Optimize),
    Atlas(atlas::Atlas),
    Certify(certify::Certify),
    HeightMap(height_map::HeightMap),
    #[command(subcommand)]
    Sweep(sweep::Sweep),
    Paper(paper::Paper),
    Plan(plan::Plan),
    #[command(subcommand)]
    Experiment(experiment::Experiment),
    Robot(robot::Robot),
    Twin(twin::Twin),
    Lab(lab::Lab),
    Calibrate(calibrate::Calibrate),
    Track(track::Track),
    Tracks(tracks::Tracks),
    Swimmers(swimmers::Swimmers),
    Gaits(swimmers::Gaits),
    Completions(shell::Completions),
    Man(shell::Man),
}

/// The command line, with an example in each help text and without options that have no effect.
pub(crate) fn command() -> clap::Command {
    examples::with_examples(Arguments::command()).mut_subcommand("robot", |robot| {
        let virtual_robot = ["board", "firmware", "emulator", "firmware_log"];
        let all = |others: &[&'static str]| [&virtual_robot, others].concat();
        [
            ("hc05", all(&["log", "key"])),
            ("flash", all(&[])),
            ("replay", all(&["port", "log", "baud", "key"])),
        ]
        .into_iter()
        .fold(robot, |robot, (action, names)| {
            without(robot, action, &names)
        })
    })
}

/// The command with these options, which every subcommand accepts, hidden in one subcommand.
fn without(command: clap::Command, action: &str, names: &[&str]) -> clap::Command {
    let hidden: Vec<_> = command
        .get_arguments()
        .filter(|option| names.contains(&option.get_id().as_str()))
        .map(|option| option.clone().hide(true))
        .collect();
    command.mut_subcommand(action, |action| action.args(hidden))
}

/// Runs a subcommand.
///
/// # Errors
/// As the command.
pub(crate) fn run(command: Command, output: Output) -> Outcome {
    match command {
        Command::Demo(demo) => demo.run(output),
        Command::Calibrate(calibrate) => calibrate.run(output),
        Command::Simulate(simulate) => simulate.run(output),
        Command::Certify(certify) => certify.run(output),
        Command::Optimize(optimize) => optimize.run(output),
        Command::HeightMap(height_map) => height_map.run(output),
        Command::Sweep(sweep) => sweep.run(output),
        Command::Paper(paper) => paper.run(output),
        Command::Plan(plan) => plan.run(output),
        Command::Atlas(atlas) => atlas.run(output),
        Command::Experiment(experiment) => experiment.run(output),
        Command::Robot(robot) => robot.run(output),
        Command::Twin(twin) => twin.run(output),
        Command::Lab(lab) => lab.run(output),
        Command::Track(track) => track.run(output),
        Command::Tracks(tracks) => tracks.run(output),
        Command::Swimmers(swimmers) => swimmers.run(output),
        Command::Gaits(gaits) => {
            gaits.run(output);
            Ok(())
        }
        Command::Completions(completions) => {
            completions.run(output);
            Ok(())
        }
        Command::Man(man) => man.run(output),
    }
}

#[cfg(test)]
mod tests {
    use super::command;

    #[test]
    fn the_command_line_is_consistent() {
        command().debug_assert();
    }
}
