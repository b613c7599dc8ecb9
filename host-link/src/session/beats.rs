//! Keep-alives: their schedule, and the robot time that they echo.
//!
//! Each keep-alive is answered, and unanswered ones may fill a module's buffer ahead of a stop. So only one is in flight; on a
//! link with a long round trip, as many as needed for one every [`KEEP_ALIVE`], because the lease is fixed. The shortest round
//! trip measures the link, since a queue lengthens only the others.
//!
//! A keep-alive that is unanswered for twice as long counts as lost and is replaced. The first replacements are quick, so that
//! a line that loses every tenth frame keeps the lease. Later ones back off, because a stalled line fills its buffer.

use std::collections::VecDeque;
use std::time::Duration;

use super::round_trip::RoundTrip;

/// Shortest interval between keep-alives.
pub const KEEP_ALIVE: Duration = Duration::from_millis(50);
/// Shortest interval during an upload, which needs its share of the line.
pub(super) const APART: Duration = Duration::from_millis(100);
/// Shortest time after which a keep-alive counts as lost.
const SHORTEST_WAIT: Duration = Duration::from_millis(80);
/// Longest such time, and the only one if no lease has to be kept.
const LONGEST_WAIT: Duration = Duration::from_secs(3);
/// Number of consecutive quick replacements.
const QUICK: u32 = 5;
/// Longest legal round trip. A greeting may have taken longer because it waited behind another host's bytes.
const LONGEST_WAY: Duration = Duration::from_millis(500);

/// Keep-alive in flight.
#[derive(Debug, Clone, Copy)]
struct Sent {
    at: Duration,
    host_us: u64,
}

/// Keep-alives of a session.
#[derive(Debug, Default)]
pub(super) struct Beats {
    unanswered: VecDeque<Sent>,
    last: Option<Duration>,
    /// Consecutive losses.
    lost: u32,
    /// Latest received time of the robot's clock, µs.
    heard_us: u64,
}

impl Beats {
    /// Records a received time of the robot.
    pub(super) fn heard(&mut self, robot_us: u64) {
        self.heard_us = self.heard_us.max(robot_us);
    }

    /// Records a reply: the robot receives, so losses are replaced quickly again.
    pub(super) fn reached(&mut self) {
        self.lost = 0;
    }

    /// Robot time that the next keep-alive echoes, µs.
    pub(super) fn heard_us(&self) -> u64 {
        self.heard_us
    }

    /// Earliest time of the next keep-alive. `alone`: no lease has to be kept, so at most one is in flight.
    pub(super) fn due(&self, trip: &RoundTrip, alone: bool, uploading: bool) -> Duration {
        let Some(last) = self.last else {
            return Duration::ZERO;
        };
        let apart = if uploading { APART } else { KEEP_ALIVE };
        let Some(oldest) = self.unanswered.front() else {
            return last + apart;
        };
        let more = if alone {
            0
        } else {
            way(trip).as_millis() / apart.as_millis()
        };
        if (self.unanswered.len() as u128) <= more {
            last + apart
        } else {
            oldest.at + self.wait(trip, alone)
        }
    }

    /// Time after which the oldest keep-alive counts as lost.
    fn wait(&self, trip: &RoundTrip, alone: bool) -> Duration {
        if alone {
            return LONGEST_WAIT;
        }
        let slower = self.lost.saturating_sub(QUICK - 1).min(10);
        ((way(trip) * 2).max(SHORTEST_WAIT) * (1 << slower)).min(LONGEST_WAIT)
    }

    /// Records a keep-alive sent now, with this time of the host's clock. Removes the oldest one if it counts as lost.
    pub(super) fn sent(&mut self, trip: &RoundTrip, alone: bool, now: Duration, host_us: u64) {
        let wait = self.wait(trip, alone);
        if self
            .unanswered
            .front()
            .is_some_and(|oldest| now >= oldest.at + wait)
        {
            self.unanswered.clear();
            self.lost += 1;
        }
        self.last = Some(now);
        self.unanswered.push_back(Sent { at: now, host_us });
    }

    /// Records the reply to the keep-alive of this time. Earlier ones were answered too, or are lost.
    pub(super) fn answered(&mut self, host_us: u64) {
        let place = self
            .unanswered
            .iter()
            .position(|sent| sent.host_us == host_us);
        if let Some(place) = place {
            self.unanswered.drain(..=place);
            self.lost = 0;
        }
    }
}

/// Round trip of the link without queues.
fn way(trip: &RoundTrip) -> Duration {
    trip.shortest().unwrap_or_default().min(LONGEST_WAY)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    /// Sends keep-alives as scheduled; returns their times.
    fn run(beats: &mut Beats, trip: &RoundTrip, alone: bool, until: Duration) -> Vec<u128> {
        let (mut now, mut sent) = (Duration::ZERO, Vec::new());
        while now < until {
            if now >= beats.due(trip, alone, false) {
                beats.sent(trip, alone, now, u64::try_from(now.as_micros()).unwrap());
                sent.push(now.as_millis());
            }
            now += MS;
        }
        sent
    }

    #[test]
    fn one_at_a_time_on_a_quick_line() {
        let mut trip = RoundTrip::default();
        trip.sample(MS * 20);
        let mut beats = Beats::default();
        // Without replies, only the time-outs of lost frames apply.
        let sent = run(&mut beats, &trip, false, MS * 1_400);
        assert_eq!(sent, [0, 80, 160, 240, 320, 400, 560, 880]);
        beats.answered(880_000);
        assert_eq!(beats.due(&trip, false, false), MS * 930);
        assert_eq!(beats.due(&trip, false, true), MS * 980);
    }

    #[test]
    fn on_a_long_way_as_many_as_it_takes_and_never_more_than_one_when_alone() {
        let mut trip = RoundTrip::default();
        trip.sample(MS * 420);
        let sent = run(&mut Beats::default(), &trip, false, MS * 800);
        assert_eq!(sent, [0, 50, 100, 150, 200, 250, 300, 350, 400]);
        let sent = run(&mut Beats::default(), &trip, true, MS * 800);
        assert_eq!(sent, [0]);
        // A queue lengthens round trips, but does not add keep-alives.
        trip.sample(MS * 9_000);
        let sent = run(&mut Beats::default(), &trip, false, MS * 800);
        assert_eq!(sent, [0, 50, 100, 150, 200, 250, 300, 350, 400]);
    }

    #[test]
    fn a_later_answer_answers_those_before() {
        let mut trip = RoundTrip::default();
        trip.sample(MS * 420);
        let mut beats = Beats::default();
        run(&mut beats, &trip, false, MS * 450);
        beats.answered(300_000);
        beats.answered(100_000);
        assert_eq!(beats.unanswered.len(), 2);
    }

    #[test]
    fn what_is_heard_only_grows() {
        let mut beats = Beats::default();
        beats.heard(7);
        beats.heard(5);
        assert_eq!(beats.heard_us(), 7);
    }
}
