//! The commands: the output of one as its JSON document, and the whole `swimmer` command.

use std::ffi::OsString;

use pyo3::prelude::*;
use swimmer_command::{CapturedFailure, CapturedOutput};

use crate::computation::in_thread;
use crate::errors::{BadInput, Failed, in_terms_of_python};

/// The JSON document of a command, and the warnings that it gave.
///
/// On Ctrl-C this raises `KeyboardInterrupt` at once; what was being computed ends by itself and is dropped.
#[pyfunction]
pub(crate) fn run_captured(
    py: Python<'_>,
    words: Vec<OsString>,
) -> PyResult<(String, Vec<String>)> {
    let outcome = in_thread(py, None, || swimmer_command::run_captured(words))?;
    let CapturedOutput { document, notes } = outcome.map_err(exception)?;
    Ok((document, notes))
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
