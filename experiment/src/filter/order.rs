//! Order of the two followed points, front and back: a vote of the names, closed once it is clear.

/// Net votes for the order that settle it.
const SETTLED: f64 = 50.0;
/// Net votes against the order that turn it round before it is settled: more than a burst of swapped names has.
const TURNED: f64 = 40.0;

/// The order of a stretch in which both points were followed without an ambiguous gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Order {
    /// The follower's front is the back.
    pub(super) exchanged: bool,
    agree: f64,
    contradict: f64,
    settled: bool,
}

impl Order {
    /// An order that geometry or nothing decides.
    pub(super) fn settled(exchanged: bool) -> Self {
        Self {
            exchanged,
            agree: 0.0,
            contradict: 0.0,
            settled: true,
        }
    }

    /// An order that names decide.
    pub(super) fn open() -> Self {
        Self {
            settled: false,
            ..Self::settled(false)
        }
    }

    /// The same votes for a stretch in which the follower's order may be the other.
    pub(super) fn with(self, exchanged: bool) -> Self {
        Self { exchanged, ..self }
    }

    pub(super) fn is_settled(&self) -> bool {
        self.settled
    }

    /// Takes a frame's vote: `true` if its names agree with the follower's order. Returns `true` if the order turns round.
    pub(super) fn vote(&mut self, names: Option<bool>) -> bool {
        let Some(names) = names.filter(|_| !self.settled) else {
            return false;
        };
        if names == self.exchanged {
            self.contradict += 1.0;
        } else {
            self.agree += 1.0;
        }
        if self.contradict - self.agree >= TURNED {
            self.exchanged = !self.exchanged;
            (self.agree, self.contradict) = (self.contradict, self.agree);
            return true;
        }
        self.settled = self.agree - self.contradict >= SETTLED;
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
        assert!(order.exchanged && order.is_settled());
        // A swap for good changes nothing any more.
        assert!((0..500).all(|_| !order.vote(Some(true))));
    }

    #[test]
    fn silent_names_settle_nothing() {
        let mut order = Order::open();
        assert!((0..500).all(|_| !order.vote(None)) && !order.is_settled());
    }
}
