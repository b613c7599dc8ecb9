//! Keep-alives: when the next may go out, and what it tells the robot.
//!
//! Each is answered, and what is unanswered lies on the way: in a module's buffer, ahead of any stop. So there is one at a
//! time; only where the way itself is long, as many as it takes to be heard every [`KEEP_ALIVE`] over it, for the robot waits no
//! longer than its lease. The shortest round trip says how long the way is: a queue makes others longer, not that one.
//!
//! One that is unanswered for twice as long was lost, and another takes its place: a few times quickly, for a line that drops
//! every tenth frame must not lose the lease, then ever more slowly, for one that stands still fills its buffer.

use std::collections::VecDeque;
use std::time::Duration;

use super::round_trip::RoundTrip;

/// Shortest time from one keep-alive to the next.
pub const KEEP_ALIVE: Duration = Duration::from_millis(50);
/// The same while an upload has its share of the line.
pub(super) const APART: Duration = Duration::from_millis(100);
/// Shortest time after which one is lost.
const SHORTEST_WAIT: Duration = Duration::from_millis(80);
/// Longest time, and the only one where nothing watches the lease.
const LONGEST_WAIT: Duration = Duration::from_secs(3);
/// So many in a row are replaced quickly.
const QUICK: u32 = 5;
/// No legal way is longer, both ways together; a greeting that waited behind another host's bytes may have been.
const LONGEST_WAY: Duration = Duration::from_millis(500);

/// A keep-alive on its way.
#[derive(Debug, Clone, Copy)]
struct Sent {
    at: Duration,
    host_us: u64,
}

/// The keep-alives of a session.
#[derive(Debug, Default)]
pub(super) struct Beats {
    unanswered: VecDeque<Sent>,
    last: Option<Duration>,
    /// Written off in a row.
    lost: u32,
    /// The latest time of the robot's clock that was heard, µs.
    heard_us: u64,
}

impl Beats {
    /// The robot was heard to say what time it is.
    pub(super) fn heard(&mut self, robot_us: u64) {
        self.heard_us = self.heard_us.max(robot_us);
    }

    /// The robot has answered a request: bytes reach it, so that what is lost is replaced quickly again.
    pub(super) fn reached(&mut self) {
        self.lost = 0;
    }

    /// What the next one tells of that.
    pub(super) fn heard_us(&self) -> u64 {
        self.heard_us
    }

    /// When the next one may go out. `alone`: nothing watches the lease, so there is never more than one on its way.
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

    /// How long the oldest may be unanswered.
    fn wait(&self, trip: &RoundTrip, alone: bool) -> Duration {
        if alone {
            return LONGEST_WAIT;
        }
        let slower = self.lost.saturating_sub(QUICK - 1).min(10);
        ((way(trip) * 2).max(SHORTEST_WAIT) * (1 << slower)).min(LONGEST_WAIT)
    }

    /// Notes that one goes out now, under this time of the host's clock. What has waited for its answer for too long is
    /// written off.
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

    /// The answer to the one of this time came: those before were answered too, or never will be.
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

/// How long the way is, there and back.
fn way(trip: &RoundTrip) -> Duration {
    trip.shortest().unwrap_or_default().min(LONGEST_WAY)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    /// Sends whatever may go out for a while; when each did.
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
        // Unanswered: only the time-outs of a lost frame.
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
        // A queue makes round trips longer, and yet no more go out.
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
