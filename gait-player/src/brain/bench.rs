//! Somebody at the robot: the bench window, which a jumper or BOOTSEL opens, and the way out into the boot loader.

/// The window is open for so long from when the jumper closes.
const WINDOW_US: u64 = 120_000_000;
/// The answer leaves before the robot does.
const LEAVE_AFTER_US: u64 = 200_000;

/// What the bench asked for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bench {
    /// The jumper is closed, or BOOTSEL pressed.
    closed: bool,
    /// The window is open before this time.
    open_until_us: u64,
    /// The boot loader was asked for, and may be entered from this time on.
    leave_us: Option<u64>,
}

impl Bench {
    /// Takes what the shell sees of the jumper. Where it becomes closed the window opens; where it stays so, it closes in its
    /// time: a jumper that was forgotten is nobody at the robot.
    pub(crate) fn look(&mut self, now_us: u64, closed: bool) {
        if closed && !self.closed {
            self.open_until_us = now_us.saturating_add(WINDOW_US);
        }
        self.closed = closed;
    }

    pub(crate) fn open(&self, now_us: u64) -> bool {
        now_us < self.open_until_us
    }

    /// Seconds left of the window, rounded up.
    pub(crate) fn left_s(&self, now_us: u64) -> u16 {
        let left_us = self.open_until_us.saturating_sub(now_us);
        left_us.div_ceil(1_000_000).min(u64::from(u16::MAX)) as u16
    }

    /// The boot loader was asked for.
    pub(crate) fn leave(&mut self, now_us: u64) {
        self.leave_us = Some(now_us.saturating_add(LEAVE_AFTER_US));
    }

    /// The robot does something else now: it stays.
    pub(crate) fn stay(&mut self) {
        self.leave_us = None;
    }

    /// It is time to leave.
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
        bench.look(5, true);
        assert!(bench.open(5) && bench.open(WINDOW_US + 4) && !bench.open(WINDOW_US + 5));
        assert_eq!((bench.left_s(5), bench.left_s(6)), (120, 120));
        assert_eq!(bench.left_s(WINDOW_US + 4), 1);
        // Forgotten.
        bench.look(2 * WINDOW_US, true);
        assert!(!bench.open(2 * WINDOW_US));
        bench.look(2 * WINDOW_US, false);
        assert!(!bench.open(2 * WINDOW_US));
        bench.look(2 * WINDOW_US, true);
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
