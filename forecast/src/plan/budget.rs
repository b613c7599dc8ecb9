//! Bounded work of a plan search. Work is counted, not timed, so that the same plan follows on every machine.

use super::search::EFFORTS;

/// Callback for the fraction of the bounded work that is done, from 0 to 1. It never decreases during a plan.
pub type Watch<'a> = &'a dyn Fn(f64);

/// Work of the legs between a pair of approaches, in vertices of a played path. Over 1032 pairs and 94 chains of the 30 targets of
/// `how_long_it_takes` (`tests/plan.rs`), a pair took 19 ms and a vertex 1.15 µs of CPU time.
pub(super) const PAIR: usize = 17_000;

/// Work of a plan search, in vertices of played paths. Each search has a budget of its own: what a cheap search spends is not
/// missing in a thorough one.
pub(super) struct Budget<'a> {
    watch: Watch<'a>,
    /// Budgets of the searches that have ended.
    ended: usize,
    /// Budget of the present search, and the part that is spent.
    present: usize,
    spent: usize,
}

impl<'a> Budget<'a> {
    pub(super) fn new(watch: Watch<'a>) -> Self {
        Self {
            watch,
            ended: 0,
            present: 0,
            spent: 0,
        }
    }

    /// Ends the present search and starts one with this budget.
    pub(super) fn start(&mut self, budget: usize) {
        self.ended += self.present;
        (self.present, self.spent) = (budget, 0);
        self.report();
    }

    pub(super) fn spend(&mut self, work: usize) {
        self.spent += work;
        self.report();
    }

    /// Returns `true` if the present search is to end.
    pub(super) fn is_spent(&self) -> bool {
        self.spent >= self.present
    }

    fn report(&self) {
        let all: usize = EFFORTS.iter().map(|effort| 2 * effort.budget).sum();
        let done = self.ended + self.spent.min(self.present);
        (self.watch)(done as f64 / all as f64);
    }
}
