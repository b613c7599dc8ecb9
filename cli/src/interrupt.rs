//! Ctrl-C as a value that a command looks at, so that what moves is stopped before the program ends.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::{Failure, Outcome};

/// Whether the operator asked the program to end (Ctrl-C, or a polite kill). Clones share the answer.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// From here on Ctrl-C no longer ends the program: whoever calls this looks at [`Self::requested`].
    /// A second Ctrl-C ends it at once, for the case that the first one is not heeded.
    ///
    /// # Errors
    /// [`Failure::Tried`] when the operating system refuses the handler.
    pub(crate) fn install() -> Outcome<Self> {
        let interrupt = Self::default();
        let flag = interrupt.clone();
        ctrlc::set_handler(move || {
            if flag.0.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
        })
        .map_err(|error| {
            Failure::Tried(format!(
                "cannot listen for Ctrl-C ({error}), and without it a moving robot could not be stopped; nothing was started"
            ))
        })?;
        Ok(interrupt)
    }

    /// Whether Ctrl-C was pressed.
    pub(crate) fn requested(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}
