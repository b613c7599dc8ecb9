//! Runs one command for a caller in the same process: returns its JSON document and its messages.

use std::ffi::OsString;

use crate::failure::{Failure, Outcome};
use crate::new_folder::with_places;
use crate::output::{self, Output};
use crate::{commands, negative_values_joined, parse, reason};

/// Output of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CapturedOutput {
    /// The JSON document that `--json` prints.
    pub document: String,
    /// Warnings and notes, each as standard error would show it.
    pub notes: Vec<String>,
}

/// Failure of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CapturedFailure {
    /// The sentence that standard error would show, without its `error: `.
    pub reason: String,
    /// `true` if the arguments, or a file that they name, are invalid (exit status 2); otherwise the command ran and failed.
    pub bad_input: bool,
    /// Warnings and notes that came before.
    pub notes: Vec<String>,
}

/// Runs the command of these arguments (without the program's own name) and returns the output of `--json`. A check that fails,
/// as of `certify`, is an output: its document says so.
///
/// Nothing is printed, and Ctrl-C stays the caller's. For commands that compute; those that drive a robot want a program of their
/// own, which Ctrl-C stops.
///
/// # Errors
/// [`CapturedFailure`], with the command's own sentence.
///
/// ```
/// let words = ["simulate", "--swimmer", "purcell", "--gait", "circle:1.6331625"];
/// let output = swimmer_command::run_captured(words.map(Into::into)).unwrap();
/// assert!(output.document.contains("\"displacement_over_length\": 0.08228539"));
///
/// let failure = swimmer_command::run_captured(["simulate", "--swimmer", "purcel"].map(Into::into)).unwrap_err();
/// assert!(failure.bad_input && failure.reason.contains("--gait"));
/// ```
pub fn run_captured(
    words: impl IntoIterator<Item = OsString>,
) -> Result<CapturedOutput, CapturedFailure> {
    let words = [OsString::from("swimmer")].into_iter().chain(words);
    let arguments = parse(&negative_values_joined(words)).map_err(|error| CapturedFailure {
        reason: reason(&error),
        bad_input: true,
        notes: Vec::new(),
    })?;
    let (outcome, captured) =
        output::capture(|| commands::run(arguments.command, Output { json: true }));
    match outcome {
        Ok(()) => Ok(captured.into_output()),
        Err(Failure::AlreadyPrinted(reason)) => {
            let mut output = captured.into_output();
            output.notes.push(with_places(&reason));
            Ok(output)
        }
        Err(failure) => Err(CapturedFailure {
            reason: with_places(&failure.to_string()),
            bad_input: matches!(failure, Failure::BadInput(_)),
            notes: captured.asides,
        }),
    }
}

/// Value that a call returns, and its messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Noted<T> {
    /// The value.
    pub value: T,
    /// Warnings and notes, each as standard error would show it.
    pub notes: Vec<String>,
}

/// Runs a part of a command and collects its messages.
///
/// # Errors
/// [`CapturedFailure`], with the command's own sentence.
pub(crate) fn noted<T>(work: impl FnOnce() -> Outcome<T>) -> Result<Noted<T>, CapturedFailure> {
    let (outcome, captured) = output::capture(work);
    let notes = captured.asides;
    match outcome {
        Ok(value) => Ok(Noted { value, notes }),
        Err(failure) => Err(CapturedFailure {
            reason: with_places(&failure.to_string()),
            bad_input: matches!(failure, Failure::BadInput(_)),
            notes,
        }),
    }
}

impl output::Captured {
    fn into_output(self) -> CapturedOutput {
        CapturedOutput {
            document: self.document,
            notes: self.asides,
        }
    }
}
