//! Exceptions, with the sentences of the command line.

use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use swimmer_files::FileError;

pyo3::create_exception!(
    swimmer,
    Error,
    PyException,
    "Something was asked for and not done; the text says what, and what to do next."
);
pyo3::create_exception!(
    swimmer,
    BadInput,
    Error,
    "An argument, or a file that it names, cannot be used (exit status 2 of the command)."
);
pyo3::create_exception!(
    swimmer,
    Failed,
    Error,
    "It was tried and failed: no optimum, no convergence (exit status 1 of the command)."
);

/// A file that cannot be read is bad input; one that cannot be written is a failed try.
pub(crate) fn of_file(error: &FileError) -> PyErr {
    match error {
        FileError::Write { .. } => Failed::new_err(error.to_string()),
        _ => BadInput::new_err(error.to_string()),
    }
}
