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

/// Names of options as names of arguments: `max_angle` for `--max-angle`, outside of command lines in backticks.
pub(crate) fn in_terms_of_python(text: &str) -> String {
    let mut pieces = Vec::new();
    for (number, piece) in text.split('`').enumerate() {
        let is_a_command = number % 2 == 1 && piece.starts_with("swimmer ");
        pieces.push(if is_a_command {
            piece.to_owned()
        } else {
            arguments(piece)
        });
    }
    pieces.join("`")
}

fn arguments(text: &str) -> String {
    let mut parts = text.split("--");
    let mut all = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let is_of_name = |c: &char| c.is_ascii_lowercase() || *c == '-';
        let name: String = part.chars().take_while(is_of_name).collect();
        let rest = part.get(name.len()..).unwrap_or_default();
        if name.is_empty() {
            all.push_str("--");
        } else {
            all.push_str(&name.replace('-', "_"));
            if ["from", "continue"].contains(&name.as_str()) {
                all.push('_');
            }
        }
        // The command line shows the form of a value, as `--max-angle <ANGLE>`.
        let without = rest.strip_prefix(" <").or_else(|| rest.strip_prefix("=<"));
        let after = without.and_then(|form| form.split_once('>'));
        all.push_str(after.map_or(rest, |(_, after)| after));
    }
    all
}
