//! The commands: the output of one as its JSON document, and the whole `swimmer` command.

use std::ffi::OsString;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use swimmer_command::{CapturedFailure, CapturedOutput};

use crate::errors::{BadInput, Failed, in_terms_of_python};
use crate::signals::LOOK_FOR_SIGNALS_EVERY;

/// Main threads have as much; others as little as a quarter of it.
const STACK_BYTES: usize = 8 << 20;
/// The JSON document of a command, and the warnings that it gave.
///
/// On Ctrl-C this raises `KeyboardInterrupt` at once; what was being computed ends by itself and is dropped.
#[pyfunction]
pub(crate) fn run_captured(
    py: Python<'_>,
    words: Vec<OsString>,
) -> PyResult<(String, Vec<String>)> {
    let outcome = in_thread(py, || swimmer_command::run_captured(words))?;
    let CapturedOutput { document, notes } = outcome.map_err(exception)?;
    Ok((document, notes))
}

/// Result of work in a thread of its own, with the interpreter free meanwhile.
///
/// # Errors
/// On Ctrl-C `KeyboardInterrupt` at once; the work ends by itself and its result is dropped.
#[allow(clippy::redundant_closure_for_method_calls)] // the method is not general enough over lifetimes
pub(crate) fn in_thread<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = mpsc::channel();
    thread::Builder::new()
        .name("swimmer".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(move || {
            // No one receives after Ctrl-C.
            let _ = sender.send(work());
        })?;
    py.detach(move || {
        loop {
            match receiver.recv_timeout(LOOK_FOR_SIGNALS_EVERY) {
                Ok(result) => return Ok(result),
                Err(RecvTimeoutError::Timeout) => Python::attach(|py| py.check_signals())?,
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PyRuntimeError::new_err(
                        "the computation ended without a result, which is a fault of swimmer; please report it with what was called",
                    ));
                }
            }
        }
    })
}

/// The command's own sentence in the terms of Python, after the warnings that came before it.
pub(crate) fn exception(failure: CapturedFailure) -> PyErr {
    let CapturedFailure {
        reason,
        bad_input,
        mut notes,
    } = failure;
    notes.insert(0, reason);
    let text = in_terms_of_python(&notes.join("\n"));
    if bad_input {
        BadInput::new_err(text)
    } else {
        Failed::new_err(text)
    }
}

/// The whole `swimmer` command, the program's name first; gives its exit status.
#[pyfunction]
pub(crate) fn run(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| swimmer_command::run(words))
}

/// The long options that a command takes, as `["optimize", "displacement"]`.
#[pyfunction]
pub(crate) fn options(path: Vec<String>) -> Vec<String> {
    let path: Vec<&str> = path.iter().map(String::as_str).collect();
    swimmer_command::options(&path)
}
