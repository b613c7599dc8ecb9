//! The `swimmer` command: parses, calls, prints, draws. No physics and no protocol live here.
//!
//! Entry points: [`run`] is the whole command, arguments in and exit status out. A caller in the same process (the Python wheel)
//! keeps its own standard output, its own Ctrl-C and its own threads: it computes by `operations`, drives a robot by
//! [`RobotHandle`], runs experiments by [`Experiment`], and writes the commands' files by [`ResultsFolder`], [`NewFront`],
//! [`NewPicture`], [`NewPlaylist`] and [`NewMap`].

// All prints go through `output`, which does not panic if the reader has gone.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod arguments;
mod bounds;
mod captured;
mod commands;
mod context;
mod csv_text;
mod experiments;
mod exports;
mod failure;
mod in_fluid;
mod interrupt;
mod link_log;
mod new_file;
mod new_folder;
mod output;
mod paper;
mod passive;
mod picture_file;
mod progress;
mod quantity;
mod raster;
mod recording;
mod report;
mod threads;
mod virtual_robot;

use std::ffi::OsString;

use clap::FromArgMatches as _;
use clap::error::ErrorKind;

pub use crate::captured::{Noted, NotedFailure};
use crate::commands::Arguments;
pub use crate::commands::robot::{
    IsInterrupted, Reply, RobotHandle, RobotOptions, Stopper, TelemetryReport,
};
pub use crate::commands::sweep::map::MapQuantity;
pub use crate::experiments::Experiment;
pub use crate::exports::{
    NewFront, NewMap, NewPicture, NewPlaylist, ResultsFolder, check_new_file, shard_of_job_array,
};
use crate::failure::BAD_INPUT;
use crate::output::Output;
pub use crate::picture_file::FigureWidth;

/// Runs the command that these words name, the program's own name first, and gives its exit status: 0 done, 1 tried and failed,
/// 2 bad usage or bad input. It prints on this process's standard output and standard error, and may take over its Ctrl-C.
pub fn run(words: impl IntoIterator<Item = OsString>) -> u8 {
    let words = negative_values_joined(words.into_iter());
    match parse(&words) {
        Ok(arguments) => {
            let output = Output {
                json: arguments.json,
            };
            interrupt::answers_with(output);
            if arguments.overwrite {
                new_file::allow_overwriting();
            }
            if arguments.json {
                output::be_for_scripts();
            }
            if arguments.verbose {
                output::be_verbose();
            }
            match commands::run(arguments.command, output).and_then(|()| output::delivered()) {
                Ok(()) => 0,
                Err(failure) => {
                    output.failure(&failure);
                    failure.status()
                }
            }
        }
        Err(error) => bad_usage(&error, &words),
    }
}

/// The words typed, with a negative value joined to its option (`--max-angle=-1deg`): no option of ours begins with a digit, so
/// the command can say itself what is wrong with the value.
fn negative_values_joined(words: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    for word in words {
        let negative = word
            .to_str()
            .and_then(|word| word.strip_prefix('-'))
            .is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit() || c == '.'));
        let option = joined.last_mut().filter(|option| {
            let option = option.to_string_lossy();
            option.len() > 2 && option.starts_with("--") && !option.contains('=')
        });
        match option {
            Some(option) if negative => {
                option.push("=");
                option.push(word);
            }
            _ => joined.push(word),
        }
    }
    joined
}

/// Parses the arguments. Help is text even for scripts, but the word `help` takes no flags: there `--json` is ignored.
fn parse(words: &[OsString]) -> Result<Arguments, clap::Error> {
    parsed(words.iter()).map_err(|error| {
        if error.kind() != ErrorKind::InvalidSubcommand || !words.iter().any(|word| word == "help")
        {
            return error;
        }
        let without = words.iter().filter(|word| *word != "--json");
        match parsed(without) {
            Err(help) if help.kind() == ErrorKind::DisplayHelp => help,
            _ => error,
        }
    })
}

fn parsed<'a>(words: impl Iterator<Item = &'a OsString>) -> Result<Arguments, clap::Error> {
    let mut command = commands::command();
    let matches = command.try_get_matches_from_mut(words)?;
    Arguments::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
}

/// Help and version go to standard output with status 0; anything else is bad usage, status 2.
fn bad_usage(error: &clap::Error, words: &[OsString]) -> u8 {
    let printed = error.print();
    if matches!(
        error.kind(),
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
    ) {
        return match output::loss(printed) {
            None => 0,
            Some(lost) => {
                output::aside(&format!("error: {lost}"));
                1
            }
        };
    }
    // Nothing was parsed, so only the arguments themselves show `--json`.
    if words.iter().any(|word| word == "--json") {
        output::write_all(&output::error_document(&reason(error)));
    }
    BAD_INPUT
}

/// Reason of a parse error, without the usage that follows.
fn reason(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let first: Vec<&str> = text
        .lines()
        .map(str::trim)
        .take_while(|line| !line.is_empty())
        .collect();
    first.join(" ").trim_start_matches("error: ").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negative_values_belong_to_their_options() {
        let joined = |words: &[&str]| -> Vec<String> {
            negative_values_joined(words.iter().map(OsString::from))
                .into_iter()
                .map(|word| word.into_string().unwrap())
                .collect()
        };
        assert_eq!(
            joined(&["a", "--b", "-1deg", "-2"]),
            ["a", "--b=-1deg", "-2"]
        );
        for kept in [
            ["--b", "--c", "x"],
            ["--", "-1", "x"],
            ["--b=1", "-1", "x"],
            ["--b", "-o", "x"],
        ] {
            assert_eq!(joined(&kept), kept);
        }
    }
}
