//! Runs one command for a caller in the same process: returns its JSON document and its messages.

use std::ffi::OsString;

use clap::Command;

use crate::failure::Failure;
use crate::new_folder::with_places;
use crate::output::{self, Output};
use crate::{commands, negative_values_joined, parse, reason};

/// Output of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answered {
    /// The JSON document that `--json` prints.
    pub document: String,
    /// Warnings and notes, each as standard error would show it.
    pub notes: Vec<String>,
}

/// Failure of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    /// The sentence that standard error would show, without its `error: `.
    pub reason: String,
    /// `true` if the arguments, or a file that they name, are invalid (exit status 2); otherwise the command ran and failed.
    pub bad_input: bool,
    /// Warnings and notes that came before.
    pub notes: Vec<String>,
}

/// Runs the command that these words name (without the program's own name) and gives what `--json` would print. A check that is
/// made and not met, as of `certify`, is an answer: its document says so.
///
/// Nothing is printed, and Ctrl-C stays the caller's. For commands that compute; those that drive a robot want a program of their
/// own, which Ctrl-C stops.
///
/// # Errors
/// [`Refused`], with the command's own sentence.
///
/// ```
/// let words = ["simulate", "--swimmer", "purcell", "--gait", "circle:1.6331625"];
/// let answered = swimmer_command::answer(words.map(Into::into)).unwrap();
/// assert!(answered.document.contains("\"displacement_over_length\": 0.08228539"));
///
/// let refused = swimmer_command::answer(["simulate", "--swimmer", "purcel"].map(Into::into)).unwrap_err();
/// assert!(refused.bad_input && refused.reason.contains("--gait"));
/// ```
pub fn answer(words: impl IntoIterator<Item = OsString>) -> Result<Answered, Refused> {
    let words = [OsString::from("swimmer")].into_iter().chain(words);
    let arguments = parse(&negative_values_joined(words)).map_err(|error| Refused {
        reason: reason(&error),
        bad_input: true,
        notes: Vec::new(),
    })?;
    let (outcome, said) =
        output::hand_over(|| commands::run(arguments.command, Output { json: true }));
    match outcome {
        Ok(()) => Ok(said.into_answer()),
        Err(Failure::Answered(reason)) => {
            let mut answered = said.into_answer();
            answered.notes.push(with_places(&reason));
            Ok(answered)
        }
        Err(failure) => Err(Refused {
            reason: with_places(&failure.to_string()),
            bad_input: matches!(failure, Failure::BadInput(_)),
            notes: said.asides,
        }),
    }
}

impl output::HandedOver {
    fn into_answer(self) -> Answered {
        Answered {
            document: self.document,
            notes: self.asides,
        }
    }
}

/// The long options of a command (`["optimize", "displacement"]`), without those of every command. Returns `None` if there is no
/// such command.
///
/// ```
/// let options = swimmer_command::options(&["optimize", "displacement"]);
/// assert!(options.contains(&"max-angle".to_owned()) && !options.contains(&"json".to_owned()));
/// assert!(swimmer_command::options(&["optimise"]).is_empty());
/// ```
pub fn options(path: &[&str]) -> Vec<String> {
    let mut whole = commands::command();
    whole.build();
    let found = path.iter().try_fold(&whole, |command: &Command, name| {
        command.find_subcommand(name)
    });
    let every = ["help", "version"];
    found.map_or_else(Vec::new, |command| {
        command
            .get_arguments()
            .filter(|option| !option.is_global_set())
            .filter_map(|option| option.get_long())
            .filter(|name| !every.contains(name))
            .map(str::to_owned)
            .collect()
    })
}
