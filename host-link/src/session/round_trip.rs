//! Round-trip estimator, and the retransmission time-out derived from it.

use std::time::Duration;

/// Shortest wait before a retransmission.
pub(crate) const SHORTEST: Duration = Duration::from_millis(80);
/// Longest wait before a retransmission.
pub(crate) const LONGEST: Duration = Duration::from_secs(3);
/// Wait before the first measured reply.
const FIRST: Duration = Duration::from_millis(200);

/// Smoothed round trip of a link.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct RoundTrip {
    smoothed: Option<Duration>,
    shortest: Option<Duration>,
    /// Least time from a first attempt to a reply that could belong to a repeat.
    at_most: Option<Duration>,
}

impl RoundTrip {
    /// Adds the round trip of a frame that was sent once; a reply to a repeated frame is ambiguous.
    pub(crate) fn sample(&mut self, round_trip: Duration) {
        self.shortest = Some(
            self.shortest
                .map_or(round_trip, |least| least.min(round_trip)),
        );
        self.smoothed = Some(match self.smoothed {
            Some(smoothed) => (smoothed * 7 + round_trip) / 8,
            None => round_trip,
        });
    }

    /// Smoothed round trip, if there is one.
    pub(crate) fn smoothed(&self) -> Option<Duration> {
        self.smoothed
    }

    /// Shortest round trip so far: the delay of the link without queues.
    pub(crate) fn shortest(&self) -> Option<Duration> {
        self.shortest
    }

    /// Adds an upper bound of the round trip, from the first attempt of a repeated frame. On a slow line nothing better is
    /// known at first, because everything is repeated before its reply arrives.
    pub(crate) fn bound(&mut self, longest: Duration) {
        self.at_most = Some(self.at_most.map_or(longest, |least| least.min(longest)));
    }

    /// Smoothed round trip; otherwise the best bound; otherwise the initial estimate.
    pub(crate) fn assumed(&self) -> Duration {
        self.smoothed.or(self.at_most).unwrap_or(FIRST / 2)
    }

    /// Wait after attempt `tries` (from 1): twice the smoothed round trip, doubled for each repeat, because a link that buffers
    /// in lumps may answer several at once.
    pub(crate) fn wait(&self, tries: u32) -> Duration {
        let first = self.smoothed.map_or(FIRST, |smoothed| smoothed * 2);
        let doubled = first
            .max(SHORTEST)
            .saturating_mul(1 << tries.saturating_sub(1).min(10));
        doubled.clamp(SHORTEST, LONGEST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn waits_are_twice_the_round_trip_within_80_ms_and_3_s() {
        let mut trip = RoundTrip::default();
        assert_eq!(trip.wait(1), FIRST);
        trip.sample(MS * 10);
        assert_eq!(trip.wait(1), SHORTEST);
        let mut slow = RoundTrip::default();
        slow.sample(MS * 300);
        assert_eq!(slow.wait(1), MS * 600);
        assert_eq!(slow.wait(2), MS * 1200);
        assert_eq!(slow.wait(3), MS * 2400);
        assert_eq!(slow.wait(4), LONGEST);
        assert_eq!(slow.wait(u32::MAX), LONGEST);
    }

    #[test]
    fn what_is_assumed_is_the_best_that_is_known() {
        let mut trip = RoundTrip::default();
        assert_eq!(trip.assumed(), FIRST / 2);
        trip.bound(MS * 900);
        trip.bound(MS * 400);
        trip.bound(MS * 500);
        assert_eq!(trip.assumed(), MS * 400);
        // Waits require a sample.
        assert_eq!(trip.wait(1), FIRST);
        trip.sample(MS * 380);
        assert_eq!(trip.assumed(), MS * 380);
    }

    #[test]
    fn smoothing_follows_slowly() {
        let mut trip = RoundTrip::default();
        trip.sample(MS * 80);
        trip.sample(MS * 160);
        assert_eq!(trip.smoothed(), Some(MS * 90));
    }
}
