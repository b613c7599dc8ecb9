//! Order of the two followed points, front and back: names vote on it, and the heading continues it over gaps.

/// Net votes for the order that settle it.
const SETTLED: f64 = 50.0;
/// Net votes against the order that turn it round before it is settled: more than a burst of swapped names has.
const TURNED: f64 = 40.0;
/// Weight of a frame in the running agreement of the names with a settled order.
const AGREEMENT_WEIGHT: f64 = 0.02;
/// Names whose running agreement is below this were exchanged for good. A burst of swapped names does not reach it.
const EXCHANGED: f64 = -0.8;

/// Knowledge of the order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Certainty {
    /// Unknown until names have voted.
    Open,
    /// Continued by the heading over a gap; names may still turn it round.
    Continued,
    Settled,
}

/// The order of a stretch in which both points were followed without an ambiguous gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Order {
    /// The follower's front is the back.
    pub(super) exchanged: bool,
    agree: f64,
    contradict: f64,
    certainty: Certainty,
    /// Running mean agreement of the names with the settled order, from −1 to 1.
    agreement: f64,
}

impl Order {
    /// An order that geometry or nothing decides.
    pub(super) fn settled(exchanged: bool) -> Self {
        Self {
            exchanged,
            agree: 0.0,
            contradict: 0.0,
            certainty: Certainty::Settled,
            agreement: 1.0,
        }
    }

    /// An order that names decide.
    pub(super) fn open() -> Self {
        Self {
            certainty: Certainty::Open,
            ..Self::settled(false)
        }
    }

    /// The order after a gap over which the heading continues it. Names that were exchanged for good stay exchanged.
    pub(super) fn continued(self, exchanged: bool) -> Self {
        match self.certainty {
            Certainty::Settled => Self {
                exchanged,
                agree: 0.0,
                contradict: 0.0,
                certainty: Certainty::Continued,
                ..self
            },
            Certainty::Open | Certainty::Continued => Self { exchanged, ..self },
        }
    }

    /// Returns `true` if the order is settled, or continued from one that was.
    pub(super) fn is_known(&self) -> bool {
        self.certainty != Certainty::Open
    }

    /// Takes a frame's vote: `true` if its names agree with the follower's order. Returns `true` if the order turns round.
    pub(super) fn vote(&mut self, names: Option<bool>) -> bool {
        let Some(names) = names else {
            return false;
        };
        let agrees = names != self.exchanged;
        if self.certainty == Certainty::Settled {
            let frame = if agrees { 1.0 } else { -1.0 };
            self.agreement += AGREEMENT_WEIGHT * (frame - self.agreement);
            return false;
        }
        if agrees == (self.agreement >= EXCHANGED) {
            self.agree += 1.0;
        } else {
            self.contradict += 1.0;
        }
        if self.contradict - self.agree >= TURNED {
            self.exchanged = !self.exchanged;
            (self.agree, self.contradict) = (self.contradict, self.agree);
            return true;
        }
        if self.agree - self.contradict >= SETTLED {
            self.certainty = Certainty::Settled;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_that_begins_with_swapped_names_is_turned_round_once() {
        let mut order = Order::open();
        // Names were swapped in the first frame, so every later one contradicts.
        let mut turns = (0..200).filter(|_| order.vote(Some(false)));
        assert_eq!((turns.next(), turns.next()), (Some(39), None));
        drop(turns);
        assert!(order.exchanged && order.is_known());
        // A swap for good changes nothing any more.
        assert!((0..500).all(|_| !order.vote(Some(true))));
    }

    #[test]
    fn silent_names_settle_nothing() {
        let mut order = Order::open();
        assert!((0..500).all(|_| !order.vote(None)) && !order.is_known());
    }

    /// A heading that was wrong after a gap is put right by the names; names that were exchanged before the gap say the contrary.
    #[test]
    fn names_correct_an_order_after_a_gap() {
        for are_exchanged in [false, true] {
            let mut order = Order::settled(false);
            assert!((0..200).all(|_| !order.vote(Some(!are_exchanged))));
            // The follower begins anew with the points in the other order, and the heading does not notice.
            let mut order = order.continued(false);
            assert!(order.is_known());
            let turned = (0..60).filter(|_| order.vote(Some(are_exchanged))).count();
            assert!(turned == 1 && order.exchanged, "{are_exchanged}");
            // A burst of swapped names turns nothing round.
            let mut order = Order::settled(false).continued(false);
            assert!((0..39).all(|_| !order.vote(Some(false))));
        }
    }
}
