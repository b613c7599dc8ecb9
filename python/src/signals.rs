//! Ctrl-C during a call that runs without the interpreter's lock.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// Longest delay until Ctrl-C is noticed.
pub(crate) const LOOK_FOR_SIGNALS_EVERY: Duration = Duration::from_millis(50);

/// Signals of the interpreter, for a call that polls them. Clones share the state.
#[derive(Clone, Default)]
pub(crate) struct Signals(Arc<Mutex<State>>);

#[derive(Default)]
struct State {
    looked: Option<Instant>,
    /// Exception of the signal's handler.
    raised: Option<PyErr>,
}

impl Signals {
    /// Returns `true` once a signal's handler has raised, until [`raised`](Self::raised) takes the exception. Cheap if called often.
    pub(crate) fn poll(&self) -> bool {
        let mut state = self.state();
        let due = state
            .looked
            .is_none_or(|looked| looked.elapsed() >= LOOK_FOR_SIGNALS_EVERY);
        if due && state.raised.is_none() {
            state.looked = Some(Instant::now());
            // The handler may take a while, and may call us.
            drop(state);
            #[allow(clippy::redundant_closure_for_method_calls)]
            // the method is not general enough over lifetimes
            let raised = Python::attach(|py| py.check_signals()).err();
            state = self.state();
            state.raised = raised;
        }
        state.raised.is_some()
    }

    /// Exception of the signal that ended a call, if one did.
    ///
    /// # Errors
    /// That exception.
    pub(crate) fn raised(&self) -> PyResult<()> {
        self.state().raised.take().map_or(Ok(()), Err)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
