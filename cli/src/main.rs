//! The `swimmer` command: parses, calls, prints, draws. No physics and no protocol live here.

mod arguments;
mod bounds;
mod commands;
mod failure;
mod fit_file;
mod interrupt;
mod link_log;
mod new_folder;
mod output;
mod paper;
mod progress;
mod quantity;
mod recording;
mod report;
mod virtual_robot;

use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;

use crate::commands::Arguments;
use crate::output::Output;

fn main() -> ExitCode {
    match Arguments::try_parse() {
        Ok(arguments) => {
            let output = Output {
                json: arguments.json,
            };
            match commands::run(arguments.command, output) {
                Ok(()) => ExitCode::SUCCESS,
                Err(failure) => {
                    output.failure(&failure);
                    failure.exit_code()
                }
            }
        }
        Err(error) => bad_usage(&error),
    }
}

/// Help and version go to standard output with status 0; anything else is bad usage, status 2.
fn bad_usage(error: &clap::Error) -> ExitCode {
    let _ = error.print();
    if matches!(
        error.kind(),
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
    ) {
        return ExitCode::SUCCESS;
    }
    // Nothing was parsed, so whether a script is asking can only be seen in the words themselves.
    if std::env::args_os().any(|word| word == "--json") {
        let text = error.render().to_string();
        // The first paragraph is the reason, the rest is about usage.
        let reason: Vec<&str> = text
            .lines()
            .map(str::trim)
            .take_while(|line| !line.is_empty())
            .collect();
        let reason = reason.join(" ");
        output::write_all(&output::error_document(
            reason.trim_start_matches("error: "),
        ));
    }
    ExitCode::from(2)
}
