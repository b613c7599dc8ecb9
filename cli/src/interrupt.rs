//! Ctrl-C or SIGTERM: a flag that a command polls, so that motion is stopped before the program ends. If no command polls it, the
//! drafts of unfinished files are removed and the program ends.
//!
//! A command that holds a robot treats Ctrl-Z the same: a suspended program keeps its port and feeds no lease.

use std::fmt;
use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use crate::failure::{Failure, Outcome};
use crate::new_folder::Drafts;
use crate::output::{Output, is_captured};

/// Exit status of a program that a second Ctrl-C ends, as shells have it.
const AT_ONCE: i32 = 130;
/// Name of the usual way to end a command.
pub(crate) const CTRL_C: &str = "Ctrl-C";
/// Exit status of a job that was tried and failed.
const TRIED: i32 = 1;

/// `true` if the handler is installed; there can be only one.
static LISTENING: Mutex<bool> = Mutex::new(false);
/// Flag that the handler sets; `None`: the handler ends the program itself.
static IN_CHARGE: Mutex<Option<Interrupt>> = Mutex::new(None);
/// Output of the program, for a message of the handler.
static OUTPUT: OnceLock<Output> = OnceLock::new();

/// Set if the operator requested the end of the program (Ctrl-C, SIGTERM, and Ctrl-Z for a command that holds a robot). Clones
/// share the flag.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interrupt {
    ended: Arc<AtomicBool>,
    suspended: Arc<AtomicBool>,
    poll: Option<Poll>,
}

/// Function of a caller in the same process that reports the wish to end, such as a signal of its own.
#[derive(Clone)]
struct Poll(Arc<dyn Fn() -> bool + Send + Sync>);

impl fmt::Debug for Poll {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Poll")
    }
}

impl Interrupt {
    /// From here on Ctrl-C no longer ends the program: whoever calls this looks at [`Self::requested`].
    /// A second Ctrl-C ends it at once, for the case that the first one is not heeded.
    ///
    /// # Errors
    /// [`Failure::Tried`] when the operating system refuses the handler.
    pub(crate) fn install() -> Outcome<Self> {
        listen().map_err(|error| {
            Failure::Tried(format!(
                "cannot listen for Ctrl-C ({error}), and without it a moving robot could not be stopped; nothing was started"
            ))
        })?;
        let interrupt = Self::default();
        *locked(&IN_CHARGE) = Some(interrupt.clone());
        Ok(interrupt)
    }

    /// The same for a program that holds a robot: Ctrl-Z does not suspend it either.
    ///
    /// # Errors
    /// As [`Self::install`].
    pub(crate) fn install_with_a_robot() -> Outcome<Self> {
        let interrupt = Self::install()?;
        #[cfg(unix)]
        signal_hook::flag::register(
            signal_hook::consts::SIGTSTP,
            Arc::clone(&interrupt.suspended),
        )
        .map_err(|error| {
            Failure::Tried(format!(
                "cannot listen for Ctrl-Z ({error}), and a suspended program would keep the robot's port and not its link; nothing was started"
            ))
        })?;
        Ok(interrupt)
    }

    /// For a caller in the same process, which keeps its own Ctrl-C: `poll` is called while a command waits, and ends it by `true`.
    pub(crate) fn polled(poll: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self {
            poll: Some(Poll(Arc::new(poll))),
            ..Self::default()
        }
    }

    /// Requests the end.
    pub(crate) fn request(&self) {
        self.ended.store(true, Ordering::SeqCst);
    }

    /// Forgets an earlier request.
    pub(crate) fn clear(&self) {
        self.ended.store(false, Ordering::SeqCst);
    }

    /// `true` after Ctrl-C, or after Ctrl-Z if that ends the program too.
    pub(crate) fn requested(&self) -> bool {
        self.ended.load(Ordering::SeqCst)
            || self.suspended.load(Ordering::SeqCst)
            || self.poll.as_ref().is_some_and(|Poll(poll)| poll())
    }

    /// Key that was pressed, with an explanation if its effect is not the usual one.
    pub(crate) fn pressed(&self) -> &'static str {
        if self.poll.is_some() {
            "interrupted"
        } else if self.suspended.load(Ordering::SeqCst) {
            "Ctrl-Z (a suspended program keeps no link, so it ends instead)"
        } else {
            CTRL_C
        }
    }
}

/// Says how a program that ends in the middle answers.
pub(crate) fn answers_with(output: Output) {
    OUTPUT.get_or_init(|| output);
}

/// From here on Ctrl-C removes what is half-written before it ends the program; Ctrl-C of a program that only calls a command
/// stays its own.
///
/// # Errors
/// The operating system refuses the handler.
pub(crate) fn listen() -> Result<(), ctrlc::Error> {
    if is_captured() {
        return Ok(());
    }
    let mut listening = locked(&LISTENING);
    if !*listening {
        ctrlc::set_handler(heard)?;
        *listening = true;
    }
    Ok(())
}

/// Runs in a thread of its own at each Ctrl-C.
fn heard() {
    let in_charge = locked(&IN_CHARGE).clone();
    match in_charge {
        Some(interrupt) => {
            if interrupt.ended.swap(true, Ordering::SeqCst) {
                Drafts::held().remove();
                exit(AT_ONCE);
            }
        }
        None => give_up(),
    }
}

fn give_up() {
    // Held to the end: from here on nothing is published, and nothing that was published is taken back.
    let drafts = Drafts::held();
    if drafts.none() {
        // All is written, and only the answer is still to come.
        return;
    }
    drafts.remove();
    let output = OUTPUT.get().copied().unwrap_or(Output { json: false });
    output.failure(&Failure::Tried(
        "interrupted: incomplete files are removed and nothing was kept; run it again".to_owned(),
    ));
    // The command may have written on meanwhile.
    drafts.remove();
    exit(TRIED);
}

/// Locks what a thread that panicked may have left.
pub(crate) fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
