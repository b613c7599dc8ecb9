//! State that survives a reset: the e-stop latch and the ages of the last resets, packed into one word. The shell keeps the
//! word in a register that a reset preserves and a power cut clears (promises R6 and R8).
//!
//! ```text
//!  31   24 23       17 16           10 9    3      2        1       0
//! | 0xA5  | last, s   | before it, s  | free | by starts | locked | e-stop |
//! ```
//! Ages of the last two faulty resets, s; 127 means no such reset, or an older one.

use link_protocol::ResetReason;

const MAGIC: u32 = 0xA5;
const NONE: u32 = 127;
/// Window of the reset lock, s. Three resets within it lock arming, and the robot must be up for as long before the lock may be
/// cleared.
const WINDOW_S: u32 = 60;

/// State that survives a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Resets {
    /// The e-stop is latched.
    pub(crate) estop: bool,
    /// Arming is locked.
    locked: bool,
    /// The lock has its cause in short starts, not (only) in resets.
    by_starts: bool,
    /// Ages of the last two faulty resets when this run started, s.
    ages: [u32; 2],
    uptime_s: u32,
}

impl Resets {
    /// Decodes the stored word at a start with this cause.
    pub(crate) fn at_start(kept: u32, reason: ResetReason) -> Self {
        if reason == ResetReason::PowerOn || kept >> 24 != MAGIC {
            let fault = matches!(reason, ResetReason::Watchdog | ResetReason::Crash);
            let ages = [if fault { 0 } else { NONE }, NONE];
            return Self {
                estop: false,
                locked: false,
                by_starts: false,
                ages,
                uptime_s: 0,
            };
        }
        let (estop, locked, by_starts) = (kept & 1 != 0, kept & 2 != 0, kept & 4 != 0);
        let ages = [kept >> 17 & NONE, kept >> 10 & NONE];
        match reason {
            ResetReason::Watchdog | ResetReason::Crash => Self {
                estop,
                locked: locked || ages[1] <= WINDOW_S,
                by_starts,
                ages: [0, ages[0]],
                uptime_s: 0,
            },
            ResetReason::Pin | ResetReason::PowerOn => Self {
                estop,
                locked,
                by_starts,
                ages,
                uptime_s: 0,
            },
        }
    }

    /// Updates the time since the start.
    pub(crate) fn up_for(&mut self, now_us: u64) {
        self.uptime_s = (now_us / 1_000_000).min(u64::from(u16::MAX)) as u32;
    }

    /// Seconds until [`Self::clear`] is accepted. Returns `None` if arming is not locked.
    pub(crate) fn wait_s(&self) -> Option<u16> {
        self.locked
            .then(|| WINDOW_S.saturating_sub(self.uptime_s) as u16)
    }

    /// Locks arming after too many short starts.
    pub(crate) fn lock(&mut self) {
        (self.locked, self.by_starts) = (true, true);
    }

    /// Arming is locked because of repeated short starts.
    pub(crate) fn locked_by_starts(&self) -> bool {
        self.locked && self.by_starts
    }

    /// Returns true if the robot has been up long enough that this run is not a short one.
    pub(crate) fn lasted(&self) -> bool {
        self.uptime_s >= WINDOW_S
    }

    /// Clears the lock.
    pub(crate) fn clear(&mut self) {
        (self.locked, self.by_starts) = (false, false);
    }

    /// Encodes the word to store.
    pub(crate) fn word(&self) -> u32 {
        let age = |at_start: u32| {
            if at_start == NONE {
                NONE
            } else {
                (at_start + self.uptime_s).min(NONE)
            }
        };
        MAGIC << 24
            | age(self.ages[0]) << 17
            | age(self.ages[1]) << 10
            | u32::from(self.by_starts) << 2
            | u32::from(self.locked) << 1
            | u32::from(self.estop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ResetReason::{Crash, Pin, PowerOn, Watchdog};

    fn run(resets: Resets, seconds: u64) -> u32 {
        let mut resets = resets;
        resets.up_for(seconds * 1_000_000);
        resets.word()
    }

    #[test]
    fn three_resets_in_sixty_seconds_lock() {
        let first = Resets::at_start(run(Resets::at_start(0, PowerOn), 500), Watchdog);
        assert_eq!(first.wait_s(), None);
        let second = Resets::at_start(run(first, 29), Crash);
        assert_eq!(second.wait_s(), None);
        let mut third = Resets::at_start(run(second, 31), Watchdog);
        assert_eq!(third.wait_s(), Some(60));
        third.up_for(18_999_999);
        assert_eq!(third.wait_s(), Some(42));
        third.up_for(3_600_000_000);
        assert_eq!(third.wait_s(), Some(0));
        third.clear();
        assert_eq!(third.wait_s(), None);
        // One second later the third reset is outside the window.
        assert_eq!(Resets::at_start(run(second, 32), Watchdog).wait_s(), None);
    }

    #[test]
    fn a_lock_and_an_estop_outlive_resets_but_no_power_cut() {
        let kept = Resets {
            estop: true,
            locked: true,
            by_starts: false,
            ages: [0, 5],
            uptime_s: 9,
        }
        .word();
        for reason in [Watchdog, Crash, Pin] {
            let after = Resets::at_start(kept, reason);
            assert!(after.estop && after.wait_s().is_some(), "{reason:?}");
        }
        let after = Resets::at_start(kept, PowerOn);
        assert!(!after.estop && after.wait_s().is_none());
        assert!(!Resets::at_start(!kept, Watchdog).estop);
    }

    #[test]
    fn what_locked_it_is_told_and_outlives_resets() {
        let mut by_starts = Resets::at_start(0, PowerOn);
        assert!(!by_starts.locked_by_starts());
        by_starts.lock();
        assert!(by_starts.locked_by_starts());
        let by_resets = Resets {
            estop: true,
            locked: true,
            by_starts: false,
            ages: [0, 5],
            uptime_s: 9,
        };
        for reason in [Watchdog, Crash, Pin] {
            let after = |kept: Resets| Resets::at_start(kept.word(), reason);
            assert!(after(by_starts).locked_by_starts(), "{reason:?}");
            let other = after(by_resets);
            assert!(
                other.wait_s().is_some() && !other.locked_by_starts(),
                "{reason:?}"
            );
        }
        by_starts.clear();
        assert!(!by_starts.locked_by_starts() && by_starts.wait_s().is_none());
    }

    #[test]
    fn ages_saturate() {
        let long_ago = run(Resets::at_start(0, Watchdog), 1_000_000);
        assert_eq!(Resets::at_start(long_ago, Watchdog).ages, [0, NONE]);
    }
}
