//! Parts of commands for a caller in the same process, which collects the messages.

use std::ffi::OsString;

use operations::Error;

use crate::failure::{Failure, Outcome};
use crate::output::{self, Output};
use crate::{commands, negative_values_joined, parse, reason};

/// Value that a call returns, and its messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Noted<T> {
    /// The value.
    pub value: T,
    /// Warnings and notes, each as standard error would show it.
    pub notes: Vec<String>,
}

/// Failure of a call, and the messages that came before.
#[derive(Debug, Clone)]
pub struct NotedFailure {
    /// Failure.
    pub error: Error,
    /// Warnings and notes, each as standard error would show it.
    pub notes: Vec<String>,
}

/// Runs a part of a command and collects its messages.
///
/// # Errors
/// [`NotedFailure`], with the command's own sentence.
pub(crate) fn noted<T>(work: impl FnOnce() -> Outcome<T>) -> Result<Noted<T>, NotedFailure> {
    let (outcome, captured) = output::capture(work);
    let notes = captured.asides;
    match outcome {
        Ok(value) => Ok(Noted { value, notes }),
        Err(failure) => Err(NotedFailure {
            error: failure.into_error(),
            notes,
        }),
    }
}

/// Runs a part of a command whose Ctrl-C and messages stay the caller's.
///
/// # Errors
/// The failure of that part.
pub(crate) fn quietly<T>(work: impl FnOnce() -> Outcome<T>) -> Result<T, Error> {
    let (outcome, _) = output::capture(work);
    outcome.map_err(Failure::into_error)
}

/// Runs the command of these words (without the program's own name) without any output. A check that fails is a success.
///
/// # Errors
/// Invalid words, and the failure of the command.
pub(crate) fn run_quietly(words: impl IntoIterator<Item = OsString>) -> Result<(), Error> {
    let words = [OsString::from("swimmer")].into_iter().chain(words);
    let arguments = parse(&negative_values_joined(words));
    let arguments = arguments.map_err(|error| Error::refused(reason(&error)))?;
    quietly(
        || match commands::run(arguments.command, Output { json: true }) {
            Err(Failure::AlreadyPrinted(_)) => Ok(()),
            outcome => outcome,
        },
    )
}
