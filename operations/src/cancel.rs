//! Cancellation of a computation by its caller.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Request to end a computation. Clones share the request.
///
/// The computation ends at its next report of progress, in each of its threads. It ends by unwinding, as an early return would have
/// to pass through every search; the panic hook is not called, so nothing is printed.
///
/// ```
/// use operations::{Cancel, Context, atlas};
///
/// let mut context = Context::on_disk();
/// let cancel = context.cancel.clone();
/// cancel.request();
/// let request = atlas::Request {
///     starts: 100_000,
///     ..atlas::Request::new("purcell".into(), atlas::Aim::Efficiency)
/// };
/// assert!(Cancel::catch(|| atlas::run(&request, &mut context)).is_none());
/// ```
#[derive(Debug, Clone, Default)]
pub struct Cancel(Arc<AtomicBool>);

/// Payload of the unwinding.
struct Cancelled;

impl Cancel {
    /// Requests the end.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Returns `true` after a request.
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Ends the computation here if that was requested.
    pub(crate) fn check(&self) {
        if self.is_requested() {
            resume_unwind(Box::new(Cancelled));
        }
    }

    /// Result of a computation. Returns `None` if it was cancelled.
    pub fn catch<T>(computation: impl FnOnce() -> T) -> Option<T> {
        // The caller drops everything that the computation has changed.
        match catch_unwind(AssertUnwindSafe(computation)) {
            Ok(result) => Some(result),
            Err(payload) if is_cancelled(&*payload) => None,
            Err(panic) => resume_unwind(panic),
        }
    }
}

fn is_cancelled(payload: &(dyn Any + Send)) -> bool {
    payload.is::<Cancelled>()
}
