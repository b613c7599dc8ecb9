//! Computations of the application library: without the interpreter's lock, until Ctrl-C.

use std::num::NonZero;
use std::sync::LazyLock;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Instant;

use operations::{Cancel, Context, Error};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::errors::{in_terms_of_python, of_operation};
use crate::signals::LOOK_FOR_SIGNALS_EVERY;

/// Main threads have as much; others as little as a quarter of it.
const STACK_BYTES: usize = 8 << 20;

/// Surroundings of an operation: file system, all cores, clock.
pub(crate) fn context() -> Context {
    Context {
        threads: thread::available_parallelism().map_or(1, NonZero::get),
        clock: Some(seconds),
        ..Context::on_disk()
    }
}

/// Time since the first call \[s\].
fn seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64()
}

/// Runs an operation in a thread of its own. Returns its output and its warnings.
///
/// # Errors
/// That of the operation, with the warnings as notes of the exception. On Ctrl-C the exception of the handler, at once; the operation
/// is cancelled and ends at its next report of progress.
pub(crate) fn compute<T: Send + 'static>(
    py: Python<'_>,
    mut context: Context,
    operation: impl FnOnce(&mut Context) -> Result<T, Error> + Send + 'static,
) -> PyResult<(T, Vec<String>)> {
    let cancel = context.cancel.clone();
    let (result, warnings) = in_thread(py, Some(cancel), move || {
        let result = operation(&mut context);
        (result, context.warnings)
    })?;
    let warnings: Vec<String> = warnings
        .iter()
        .map(|warning| in_terms_of_python(warning))
        .collect();
    match result {
        Ok(output) => Ok((output, warnings)),
        Err(error) => {
            let exception = of_operation(error);
            for warning in warnings {
                exception.value(py).call_method1("add_note", (warning,))?;
            }
            Err(exception)
        }
    }
}

/// Result of work in a thread of its own, with the interpreter free meanwhile.
///
/// # Errors
/// On Ctrl-C the exception of the handler, at once. The work is cancelled, or ends by itself, and its result is dropped.
#[allow(clippy::redundant_closure_for_method_calls)] // the method is not general enough over lifetimes
pub(crate) fn in_thread<T: Send + 'static>(
    py: Python<'_>,
    cancel: Option<Cancel>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = mpsc::channel();
    thread::Builder::new()
        .name("swimmer".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(move || {
            if let Some(result) = Cancel::catch(work) {
                // No one receives after Ctrl-C.
                let _ = sender.send(result);
            }
        })?;
    py.detach(move || {
        loop {
            match receiver.recv_timeout(LOOK_FOR_SIGNALS_EVERY) {
                Ok(result) => return Ok(result),
                Err(RecvTimeoutError::Timeout) => {
                    let checked = Python::attach(|py| py.check_signals());
                    if let (Err(_), Some(cancel)) = (&checked, &cancel) {
                        cancel.request();
                    }
                    checked?;
                }
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PyRuntimeError::new_err(
                        "the computation ended without a result, which is a fault of swimmer; please report it with what was called",
                    ));
                }
            }
        }
    })
}
