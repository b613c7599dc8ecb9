//! Standard output: plain lines for people, or one JSON document for scripts. No other module writes to it.

use std::cell::RefCell;
use std::fmt;
use std::io::{self, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use operations::Context;
use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::new_folder::with_places;

/// Error of the first write to standard output that failed.
static LOST: OnceLock<String> = OnceLock::new();

/// Set if a script reads the output, so that no progress is shown.
static FOR_SCRIPTS: AtomicBool = AtomicBool::new(false);

/// Turns progress off, because a script reads the output.
pub(crate) fn be_for_scripts() {
    FOR_SCRIPTS.store(true, Ordering::Relaxed);
}

/// Returns true if a script reads the output.
pub(crate) fn for_scripts() -> bool {
    FOR_SCRIPTS.load(Ordering::Relaxed) || is_captured()
}

/// Set by `--verbose`.
static VERBOSE: AtomicBool = AtomicBool::new(false);

/// Adds details to outputs and failures from here on.
pub(crate) fn be_verbose() {
    VERBOSE.store(true, Ordering::Relaxed);
}

/// Returns true if outputs and failures have details.
pub(crate) fn verbose() -> bool {
    VERBOSE.load(Ordering::Relaxed)
}

thread_local! {
    /// Output of this thread's command, if its caller in the same process collects it.
    static CAPTURED: RefCell<Option<Captured>> = const { RefCell::new(None) };
}

/// Text for standard output and for standard error.
#[derive(Debug, Default)]
pub(crate) struct Captured {
    pub(crate) document: String,
    pub(crate) asides: Vec<String>,
}

/// Runs `command` and collects this thread's output for the caller.
pub(crate) fn capture<T>(command: impl FnOnce() -> T) -> (T, Captured) {
    let before = CAPTURED.replace(Some(Captured::default()));
    let done = command();
    let said = CAPTURED.replace(before);
    (done, said.unwrap_or_default())
}

/// Returns true if a caller in the same process collects this thread's output.
pub(crate) fn is_captured() -> bool {
    CAPTURED.with_borrow(Option::is_some)
}

/// Form of a command's output.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Output {
    /// One JSON document on standard output instead of lines for people.
    pub(crate) json: bool,
}

impl Output {
    /// Prints the output of a command whose text is its `Display`, once, at its end.
    pub(crate) fn print(self, output: &(impl Serialize + fmt::Display)) {
        self.rendered(output, output);
    }

    /// Prints the output of a command, once, at its end: as JSON, or as text.
    pub(crate) fn rendered(self, output: &impl Serialize, text: &impl fmt::Display) {
        let text = if self.json {
            document(output)
        } else {
            format!("{text}\n")
        };
        write_all(&text);
    }

    /// A line for people while the command runs: standard output, or standard error when that is kept for JSON.
    pub(crate) fn line(self, text: &str) {
        if self.json {
            aside(text);
        } else {
            write_all(&format!("{text}\n"));
        }
    }

    /// Prints why the command failed: on standard error for people, and as `{"error": …}` for scripts.
    pub(crate) fn failure(self, failure: &Failure) {
        let reason = with_places(&failure.to_string());
        aside(&format!("error: {reason}"));
        if self.json && !matches!(failure, Failure::AlreadyPrinted(_)) {
            write_all(&error_document(&reason));
        }
    }
}

/// Prints a warning or a note on standard error. A closed standard error is ignored.
pub(crate) fn aside(text: &str) {
    let taken = CAPTURED
        .with_borrow_mut(|said| said.as_mut().map(|said| said.asides.push(text.to_owned())));
    if taken.is_some() {
        return;
    }
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Prints the warnings of an operation on standard error.
pub(crate) fn asides(context: &Context) {
    for warning in &context.warnings {
        aside(warning);
    }
}

/// The JSON document that stands for a failure.
pub(crate) fn error_document(reason: &str) -> String {
    document(&serde_json::json!({ "error": reason }))
}

/// The JSON document of an output.
pub(crate) fn document(value: &impl Serialize) -> String {
    // Outputs consist of numbers, texts and lists of them, which always have a JSON form; NaN becomes null.
    let text = serde_json::to_string_pretty(value)
        .unwrap_or_else(|error| format!("{{\"error\": \"the answer has no JSON form: {error}\"}}"));
    text + "\n"
}

/// Writes to standard output. [`delivered`] reports a failure at the end.
pub(crate) fn write_all(text: &str) {
    let taken =
        CAPTURED.with_borrow_mut(|said| said.as_mut().map(|said| said.document.push_str(text)));
    if taken.is_some() {
        return;
    }
    let mut stdout = io::stdout().lock();
    let written = stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush());
    if let Some(lost) = loss(written) {
        LOST.get_or_init(|| lost);
    }
}

/// Message of a failed write. Returns `None` if the reader closed the pipe (`swimmer … | head`), which is no failure.
pub(crate) fn loss(written: io::Result<()>) -> Option<String> {
    written
        .err()
        .filter(|error| error.kind() != io::ErrorKind::BrokenPipe)
        .map(|error| {
            format!("standard output took no more: {error}; the answer is not all there, so send it elsewhere and run this again")
        })
}

/// Checks that all output was written.
///
/// # Errors
/// [`Failure::AlreadyPrinted`] if not, because nothing more can be written to it.
pub(crate) fn delivered() -> Outcome {
    LOST.get()
        .map_or(Ok(()), |lost| Err(Failure::AlreadyPrinted(lost.clone())))
}
