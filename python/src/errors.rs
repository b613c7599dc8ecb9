//! Exceptions, and messages with keywords in place of the command's options.

use operations::{Error as OperationError, ErrorKind};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use swimmer_command::NotedFailure;
use swimmer_files::FileError;

pyo3::create_exception!(
    swimmer,
    Error,
    PyException,
    "Base class of the errors of this package; the text says what failed, and what to do next."
);
pyo3::create_exception!(
    swimmer,
    BadInput,
    Error,
    "A value, or a file that it names, cannot be used (exit status 2 of the command)."
);
pyo3::create_exception!(
    swimmer,
    Failed,
    Error,
    "The computation or the robot failed: no optimum, no convergence, a refusal (exit status 1 of the command)."
);

/// A file that cannot be read is bad input; one that cannot be written is a failed try.
pub(crate) fn of_file(error: &FileError) -> PyErr {
    match error {
        FileError::Write { .. } => Failed::new_err(error.to_string()),
        _ => BadInput::new_err(error.to_string()),
    }
}

/// Exception of an operation's error. Details for experts are a note of the exception.
pub(crate) fn of_operation(error: OperationError) -> PyErr {
    let text = in_terms_of_python(&error.message);
    let exception = match error.kind {
        ErrorKind::BadInput => BadInput::new_err(text),
        ErrorKind::Failed => Failed::new_err(text),
    };
    if let Some(details) = error.details {
        let details = in_terms_of_python(&details);
        Python::attach(|py| {
            // The exception is complete without the note.
            let _ = exception.value(py).call_method1("add_note", (details,));
        });
    }
    exception
}

/// Exception of a failed call, after whose reason come the messages that were before it.
pub(crate) fn of_reply(failure: NotedFailure) -> PyErr {
    let NotedFailure { mut error, notes } = failure;
    for note in notes {
        error.message.push('\n');
        error.message.push_str(&note);
    }
    of_operation(error)
}

/// A message with the command's options as keywords: `max_angle` for `--max-angle`, `swimmer.atlas(starts=…)` for
/// `swimmer atlas --starts` in backticks.
pub(crate) fn in_terms_of_python(text: &str) -> String {
    let mut pieces = Vec::new();
    for (number, piece) in text.split('`').enumerate() {
        let call = piece.strip_prefix("swimmer ").filter(|_| number % 2 == 1);
        pieces.push(match call {
            Some(command) => call_of(command).unwrap_or_else(|| piece.to_owned()),
            None => keywords(piece),
        });
    }
    pieces.join("`")
}

/// Commands that are functions of the package.
const FUNCTIONS: [&str; 10] = [
    "atlas",
    "calibrate",
    "certify",
    "experiment",
    "height-map",
    "optimize",
    "plan",
    "simulate",
    "sweep",
    "tracks",
];
/// Options without a value.
const FLAGS: [&str; 7] = [
    "advise",
    "fixed-period",
    "no-overlap",
    "overwrite",
    "playable",
    "played",
    "sector",
];
/// Values that messages name.
const VALUES: [&str; 14] = [
    "back",
    "displacement",
    "efficiency",
    "emulator",
    "free",
    "front",
    "large",
    "mean",
    "sideways",
    "small",
    "speed",
    "turning",
    "twin",
    "worst",
];

/// The call that a command stands for. Returns `None` if the package has no such function.
fn call_of(command: &str) -> Option<String> {
    let (path, options) = match command.split_once(" --") {
        Some((path, options)) => (path, Some(options)),
        None => (command, None),
    };
    let first = path.split_whitespace().next()?;
    if !FUNCTIONS.contains(&first) {
        return None;
    }
    let function = path.replace(' ', ".").replace('-', "_");
    let Some(options) = options else {
        return Some(format!("swimmer.{function}"));
    };
    let options: Vec<String> = options
        .split(" --")
        .filter(|option| *option != "json")
        .map(|option| match option.split_once(' ') {
            Some((name, value)) => format!("{}={value:?}", keyword(name)),
            None if FLAGS.contains(&option) => format!("{}=True", keyword(option)),
            None => format!("{}=…", keyword(option)),
        })
        .collect();
    Some(format!("swimmer.{function}({})", options.join(", ")))
}

fn keyword(option: &str) -> String {
    let name = option.replace('-', "_");
    // Words of Python.
    if ["from", "continue"].contains(&option) {
        name + "_"
    } else {
        name
    }
}

fn keywords(text: &str) -> String {
    let text = text
        .replace(", or replace it with --overwrite", "")
        .replace(" --json", "")
        .replace(" -o ", " output ")
        .replace(" -o,", " output,");
    let text = match text.strip_prefix("-o ") {
        Some(rest) => format!("output {rest}"),
        None => text,
    };
    let mut parts = text.split("--");
    let mut all = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let is_of_name = |c: &char| c.is_ascii_lowercase() || *c == '-';
        let name: String = part.chars().take_while(is_of_name).collect();
        let rest = part.get(name.len()..).unwrap_or_default();
        if name.is_empty() {
            all.push_str("--");
            all.push_str(rest);
            continue;
        }
        all.push_str(&keyword(&name));
        all.push_str(&after(&name, rest));
    }
    all
}

/// The text after the name of an option, with the value that follows it: `="front"` for ` front`, nothing for the form of a value as
/// ` <ANGLE>` or ` FIT.json`.
fn after(name: &str, rest: &str) -> String {
    if FLAGS.contains(&name) {
        return format!("=True{rest}");
    }
    let form = rest.strip_prefix(" <").or_else(|| rest.strip_prefix("=<"));
    if let Some((_, after)) = form.and_then(|form| form.split_once('>')) {
        return after.to_owned();
    }
    let Some(following) = rest.strip_prefix(' ') else {
        return rest.to_owned();
    };
    let is_of_word = |c: char| c.is_alphanumeric() || "-_./=|".contains(c);
    let end = following.find(|c| !is_of_word(c));
    let (word, after) = following.split_at(end.unwrap_or(following.len()));
    if VALUES.contains(&word) {
        return format!("={word:?}{after}");
    }
    if word.starts_with(|c: char| c.is_ascii_digit()) {
        return format!("={word}{after}");
    }
    let is_form = word.len() > 1 && word.starts_with(|c: char| c.is_ascii_uppercase());
    if is_form && !word.chars().skip(1).any(|c| c.is_ascii_lowercase())
        || word
            .rsplit_once('.')
            .is_some_and(|(_, ending)| ending == "json")
    {
        // A second value may follow, as LOW HIGH.
        return after.strip_prefix(" HIGH").unwrap_or(after).to_owned();
    }
    rest.to_owned()
}
