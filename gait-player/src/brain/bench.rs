//! Bench window: presence by jumper or BOOTSEL, and the delayed jump into the boot loader.

/// Duration of the bench window after the jumper closes, µs.
const WINDOW_US: u64 = 120_000_000;
/// Delay before the boot loader starts, µs, so that the reply is sent first.
const LEAVE_AFTER_US: u64 = 200_000;

/// State of the bench window and of a boot-loader request.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bench {
    /// The jumper is closed, or BOOTSEL pressed.
    closed: bool,
    /// End of the window, µs.
    open_until_us: u64,
    /// The boot loader was requested and may start from this time on, µs.
    leave_us: Option<u64>,
}

impl Bench {
    /// Samples the jumper. A closing edge opens the window. A jumper that stays closed does not extend it: a forgotten jumper
    /// is no presence.
    pub(crate) fn sample(&mut self, now_us: u64, closed: bool) {
        if closed && !self.closed {
            self.open_until_us = now_us.saturating_add(WINDOW_US);
        }
        self.closed = closed;
    }

    pub(crate) fn open(&self, now_us: u64) -> bool {
        now_us < self.open_until_us
    }

    /// Remaining time of the window, s, rounded up.
    pub(crate) fn left_s(&self, now_us: u64) -> u16 {
        let left_us = self.open_until_us.saturating_sub(now_us);
        left_us.div_ceil(1_000_000).min(u64::from(u16::MAX)) as u16
    }

    /// Schedules the jump into the boot loader.
    pub(crate) fn leave(&mut self, now_us: u64) {
        self.leave_us = Some(now_us.saturating_add(LEAVE_AFTER_US));
    }

    /// Cancels the jump because another request was accepted.
    pub(crate) fn stay(&mut self) {
        self.leave_us = None;
    }

    /// Returns true if the delay has passed.
    pub(crate) fn leaves(&self, now_us: u64) -> bool {
        self.leave_us.is_some_and(|leave_us| now_us >= leave_us)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_opens_when_the_jumper_closes_and_for_two_minutes() {
        let mut bench = Bench::default();
        assert!(!bench.open(0));
        bench.sample(5, true);
        assert!(bench.open(5) && bench.open(WINDOW_US + 4) && !bench.open(WINDOW_US + 5));
        assert_eq!((bench.left_s(5), bench.left_s(6)), (120, 120));
        assert_eq!(bench.left_s(WINDOW_US + 4), 1);
        // The jumper was forgotten.
        bench.sample(2 * WINDOW_US, true);
        assert!(!bench.open(2 * WINDOW_US));
        bench.sample(2 * WINDOW_US, false);
        assert!(!bench.open(2 * WINDOW_US));
        bench.sample(2 * WINDOW_US, true);
        assert!(bench.open(2 * WINDOW_US));
    }

    #[test]
    fn the_boot_loader_waits_for_its_answer_and_yields_to_motion() {
        let mut bench = Bench::default();
        assert!(!bench.leaves(u64::MAX));
        bench.leave(7);
        assert!(!bench.leaves(LEAVE_AFTER_US + 6) && bench.leaves(LEAVE_AFTER_US + 7));
        bench.stay();
        assert!(!bench.leaves(u64::MAX));
    }
}
