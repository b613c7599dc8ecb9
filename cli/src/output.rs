//! The one place that writes to standard output: plain lines for people, one JSON document for scripts.

use std::cell::RefCell;
use std::fmt;
use std::io::{self, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use operations::Context;
use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::new_folder::with_places;

/// What the system said when standard output first took no more.
static LOST: OnceLock<String> = OnceLock::new();

/// Whether a script asks, which wants no progress told.
static FOR_SCRIPTS: AtomicBool = AtomicBool::new(false);

/// From here on a script is asking.
pub(crate) fn be_for_scripts() {
    FOR_SCRIPTS.store(true, Ordering::Relaxed);
}

/// Whether one is.
pub(crate) fn for_scripts() -> bool {
    FOR_SCRIPTS.load(Ordering::Relaxed) || handed_over()
}

/// Whether experts' details are wanted.
static VERBOSE: AtomicBool = AtomicBool::new(false);

/// From here on answers and failures tell their details, too.
pub(crate) fn be_verbose() {
    VERBOSE.store(true, Ordering::Relaxed);
}

/// Whether they do.
pub(crate) fn verbose() -> bool {
    VERBOSE.load(Ordering::Relaxed)
}

thread_local! {
    /// What this thread's command says, where its caller in the same process takes it.
    static HANDED_OVER: RefCell<Option<HandedOver>> = const { RefCell::new(None) };
}

/// What would have gone to standard output and to standard error.
#[derive(Debug, Default)]
pub(crate) struct HandedOver {
    pub(crate) document: String,
    pub(crate) asides: Vec<String>,
}

/// Runs `command` with all that this thread says kept for the caller.
pub(crate) fn hand_over<T>(command: impl FnOnce() -> T) -> (T, HandedOver) {
    let before = HANDED_OVER.replace(Some(HandedOver::default()));
    let done = command();
    let said = HANDED_OVER.replace(before);
    (done, said.unwrap_or_default())
}

/// Whether a caller in the same process takes what this thread says.
pub(crate) fn handed_over() -> bool {
    HANDED_OVER.with_borrow(Option::is_some)
}

/// Where and how a command answers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Output {
    /// One JSON document on standard output instead of lines for people.
    pub(crate) json: bool,
}

/// What a command found: its fields are the JSON keys, its `Display` is what people read.
pub(crate) trait Answer: Serialize + fmt::Display {}

impl<T: Serialize + fmt::Display> Answer for T {}

impl Output {
    /// Prints the answer of a command, once, at its end.
    pub(crate) fn answer(self, answer: &impl Answer) {
        let text = if self.json {
            document(answer)
        } else {
            format!("{answer}\n")
        };
        write_all(&text);
    }

    /// Prints the output of an operation, once, at the end of its command: as JSON, or as text.
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

    /// Says why the command failed: on standard error for people, and as `{"error": …}` for scripts.
    pub(crate) fn failure(self, failure: &Failure) {
        let reason = with_places(&failure.to_string());
        aside(&format!("error: {reason}"));
        if self.json && !matches!(failure, Failure::Answered(_)) {
            write_all(&error_document(&reason));
        }
    }
}

/// Something worth knowing that is no part of the answer: standard error. Where nobody reads that any more there is nobody to
/// tell.
pub(crate) fn aside(text: &str) {
    let taken = HANDED_OVER
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

/// The JSON document of an answer.
pub(crate) fn document(value: &impl Serialize) -> String {
    // Answers hold numbers, texts and lists of them, which always have a JSON form; NaN becomes null.
    let text = serde_json::to_string_pretty(value)
        .unwrap_or_else(|error| format!("{{\"error\": \"the answer has no JSON form: {error}\"}}"));
    text + "\n"
}

/// Writes to standard output. What it does not take is told at the end, by [`delivered`].
pub(crate) fn write_all(text: &str) {
    let taken =
        HANDED_OVER.with_borrow_mut(|said| said.as_mut().map(|said| said.document.push_str(text)));
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

/// Why what was written did not arrive. A reader that has gone away (`swimmer … | head`) is no reason to fail.
pub(crate) fn loss(written: io::Result<()>) -> Option<String> {
    written
        .err()
        .filter(|error| error.kind() != io::ErrorKind::BrokenPipe)
        .map(|error| {
            format!("standard output took no more: {error}; the answer is not all there, so send it elsewhere and run this again")
        })
}

/// Whether standard output took all that was written to it.
///
/// # Errors
/// [`Failure::Answered`] where it did not: there is no use in writing more to it.
pub(crate) fn delivered() -> Outcome {
    LOST.get()
        .map_or(Ok(()), |lost| Err(Failure::Answered(lost.clone())))
}
