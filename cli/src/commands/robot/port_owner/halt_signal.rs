//! Stop that another process has requested, visible to a thread that waits for something else.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

use host_link::robot::Halt;

const STOP: u8 = 1;
const ESTOP: u8 = 2;

/// Most severe stop that was requested and is not taken yet.
#[derive(Debug, Clone, Default)]
pub(in super::super) struct HaltSignal {
    pending: Arc<AtomicU8>,
    /// A stop was requested, taken or not.
    ever: Arc<AtomicBool>,
}

impl HaltSignal {
    /// Requests a stop.
    #[cfg_attr(not(unix), allow(dead_code))]
    pub(super) fn set(&self, halt: Halt) {
        let level = match halt {
            Halt::Stop => STOP,
            Halt::EStop => ESTOP,
        };
        self.ever.store(true, Ordering::SeqCst);
        self.pending.fetch_max(level, Ordering::SeqCst);
    }

    /// Returns `true` if a stop was ever requested, also one that was taken.
    pub(in super::super) fn was_set(&self) -> bool {
        self.ever.load(Ordering::SeqCst)
    }

    /// Takes it.
    pub(in super::super) fn take(&self) -> Option<Halt> {
        match self.pending.swap(0, Ordering::SeqCst) {
            0 => None,
            STOP => Some(Halt::Stop),
            _ => Some(Halt::EStop),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estop_is_taken_once_whatever_comes_after_it() {
        let signal = HaltSignal::default();
        assert_eq!(signal.take(), None);
        signal.set(Halt::EStop);
        signal.clone().set(Halt::Stop);
        assert_eq!(signal.take(), Some(Halt::EStop));
        assert_eq!(signal.take(), None);
    }
}
