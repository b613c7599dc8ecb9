//! Faults of one direction as a pure queue: frames and times in, modified frames and times out.

use std::collections::VecDeque;
use std::time::Duration;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::baud::misread;
use super::faults::{Faults, Outage};
use crate::port::FrameCutter;

/// Counts of an injector, in frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FaultCounts {
    /// Frames received.
    pub frames: u64,
    /// Frames lost by chance.
    pub dropped: u64,
    /// Frames with one inverted bit.
    pub flipped: u64,
    /// Frames sent twice.
    pub duplicated: u64,
    /// Frames delayed so that others may overtake them.
    pub detoured: u64,
    /// Old bytes sent again.
    pub stale_bytes: u64,
    /// Frames garbled by another baud rate.
    pub misread: u64,
    /// Frames lost to a disconnection.
    pub cut_off: u64,
    /// Frames that did not fit the buffer of a slow line.
    pub overflowed: u64,
}

/// Faults of one direction of a link.
#[derive(Debug)]
pub struct FaultInjector {
    faults: Faults,
    rng: ChaCha8Rng,
    cutter: FrameCutter,
    /// Frames under way with their arrival times, in order.
    under_way: VecDeque<(Duration, Vec<u8>)>,
    /// Arrived bytes that are held for a lump.
    held: VecDeque<u8>,
    held_since: Duration,
    /// Last bytes carried, for a module that sends them again.
    carried: VecDeque<u8>,
    last_push: Option<Duration>,
    /// Time at which a slow line has sent its bytes.
    line_free: Duration,
    counts: FaultCounts,
}

impl FaultInjector {
    /// Returns a direction with these faults. `rng` is its own random stream, so that directions are independent.
    pub fn new(faults: Faults, rng: ChaCha8Rng) -> Self {
        Self {
            faults,
            rng,
            cutter: FrameCutter::default(),
            under_way: VecDeque::new(),
            held: VecDeque::new(),
            held_since: Duration::ZERO,
            carried: VecDeque::new(),
            last_push: None,
            line_free: Duration::ZERO,
            counts: FaultCounts::default(),
        }
    }

    /// Counts so far.
    pub fn counts(&self) -> FaultCounts {
        self.counts
    }

    /// Replaces the faults. Frames under way keep their outcome; held bytes are released.
    pub fn set_faults(&mut self, faults: Faults) {
        self.faults = faults;
    }

    /// Interrupts the link from `outage.from` on; frames under way then are lost too.
    pub fn disconnect(&mut self, outage: Outage) {
        self.faults.disconnect = Some(outage);
    }

    /// Adds bytes that were sent at `now`.
    pub fn push(&mut self, now: Duration, bytes: &[u8]) {
        if bytes.is_empty() {
            return;
        }
        self.let_out_stale(now);
        let Self {
            faults,
            rng,
            cutter,
            under_way,
            carried,
            line_free,
            counts,
            ..
        } = self;
        cutter.push(bytes, |frame| {
            counts.frames += 1;
            // Every frame draws the same number of random values, so that one more fault does not change the later ones.
            let (drop, flip, twice): (f64, f64, f64) = (rng.random(), rng.random(), rng.random());
            let bit = rng.random_range(0..frame.len() * 8);
            let (reorder, detour): (f64, f64) = (rng.random(), rng.random());
            if cut(faults, now) || cut(faults, now + faults.delay) {
                counts.cut_off += 1;
                return;
            }
            if drop < faults.drop {
                counts.dropped += 1;
                return;
            }
            if flip < faults.flip {
                counts.flipped += 1;
                frame[bit / 8] ^= 1 << (bit % 8);
            }
            if let Some(baud) = faults.baud.filter(|&baud| baud != Faults::BAUD) {
                counts.misread += 1;
                *frame = misread(frame, Faults::BAUD, baud);
            }
            let Some(passed) = through_line(faults, line_free, now, frame.len()) else {
                counts.overflowed += 1;
                return;
            };
            let mut arrival = passed + faults.delay;
            if reorder < faults.reorder {
                counts.detoured += 1;
                arrival += Faults::LONGEST_DETOUR.mul_f64(detour);
            }
            carried.extend(frame.iter());
            carried.drain(..carried.len().saturating_sub(faults.stale));
            if twice < faults.duplicate {
                counts.duplicated += 1;
                insert(under_way, arrival, frame.clone());
            }
            insert(under_way, arrival, frame.clone());
        });
    }

    /// Queues the old bytes of the module because traffic has resumed.
    fn let_out_stale(&mut self, now: Duration) {
        let anew = self.last_push.is_some_and(|last| {
            now.saturating_sub(last) >= Faults::QUIET || cut(&self.faults, last)
        });
        let cut_now = cut(&self.faults, now);
        self.last_push = Some(now);
        if self.faults.stale == 0 || !anew || cut_now {
            return;
        }
        let kept: Vec<u8> = self.carried.iter().copied().collect();
        self.counts.stale_bytes += kept.len() as u64;
        insert(&mut self.under_way, now + self.faults.delay, kept);
    }

    /// Time at which [`pop`](Self::pop) next returns bytes, unless more are added.
    pub fn next_release(&self) -> Option<Duration> {
        let arrival = self.under_way.front().map(|(at, _)| *at);
        if self.held.is_empty() {
            return arrival;
        }
        let patience = if self.faults.clump == 0 {
            self.held_since
        } else {
            self.held_since + Faults::LONGEST_HOLD
        };
        Some(arrival.map_or(patience, |at| at.min(patience)))
    }

    /// Appends the bytes that have passed by `now` to `out`.
    pub fn pop(&mut self, now: Duration, out: &mut Vec<u8>) {
        if self.faults.clump == 0 {
            out.extend(self.held.drain(..));
        }
        while let Some((at, _)) = self.under_way.front()
            && *at <= now
        {
            let Some((at, frame)) = self.under_way.pop_front() else {
                break;
            };
            if self.faults.clump == 0 {
                out.extend_from_slice(&frame);
                continue;
            }
            if self.held.is_empty() {
                self.held_since = at;
            }
            self.held.extend(frame);
            while self.held.len() >= self.faults.clump {
                out.extend(self.held.drain(..self.faults.clump));
                self.held_since = at;
            }
        }
        if !self.held.is_empty() && now >= self.held_since + Faults::LONGEST_HOLD {
            out.extend(self.held.drain(..));
        }
    }
}

fn cut(faults: &Faults, at: Duration) -> bool {
    faults.disconnect.is_some_and(|outage| outage.covers(at))
}

/// Time at which a slow line has sent a frame of this length. Returns `None` if it does not fit the buffer.
fn through_line(
    faults: &Faults,
    line_free: &mut Duration,
    now: Duration,
    len: usize,
) -> Option<Duration> {
    let Some(rate) = faults.rate else {
        return Some(now);
    };
    let rate = f64::from(rate);
    let waiting = line_free.saturating_sub(now).as_secs_f64() * rate;
    if faults.buffer > 0 && waiting + len as f64 > faults.buffer as f64 {
        return None;
    }
    *line_free = (*line_free).max(now) + Duration::from_secs_f64(len as f64 / rate);
    Some(*line_free)
}

/// Inserts by arrival time; equal times keep the order of sending.
fn insert(under_way: &mut VecDeque<(Duration, Vec<u8>)>, arrival: Duration, frame: Vec<u8>) {
    let place = under_way.partition_point(|(at, _)| *at <= arrival);
    under_way.insert(place, (arrival, frame));
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    const MS: Duration = Duration::from_millis(1);

    fn injector(text: &str) -> FaultInjector {
        FaultInjector::new(text.parse().unwrap(), ChaCha8Rng::seed_from_u64(7))
    }

    fn frames(count: usize) -> Vec<u8> {
        (0..count).flat_map(|_| [1, 2, 3, 4, 0]).collect()
    }

    #[test]
    fn without_faults_bytes_pass_at_once_and_unchanged() {
        let mut injector = injector("");
        let sent = frames(100);
        injector.push(MS, &sent);
        let mut out = Vec::new();
        injector.pop(MS, &mut out);
        assert_eq!(out, sent);
    }

    #[test]
    fn the_share_of_faults_is_the_chance() {
        let mut injector = injector("drop=10%,flip=1%,duplicate=2%");
        injector.push(MS, &frames(50_000));
        let counts = injector.counts();
        assert_eq!(counts.frames, 50_000);
        // Five standard deviations of a binomial count.
        assert!(
            (counts.dropped as f64 - 5000.0).abs() < 5.0 * 67.1,
            "{counts:?}"
        );
        assert!(
            (counts.flipped as f64 - 450.0).abs() < 5.0 * 21.2,
            "{counts:?}"
        );
        assert!(
            (counts.duplicated as f64 - 900.0).abs() < 5.0 * 30.0,
            "{counts:?}"
        );
    }

    #[test]
    fn a_flip_changes_exactly_one_bit() {
        let mut injector = injector("flip=100%");
        injector.push(MS, &[1, 2, 3, 4, 0]);
        let mut out = Vec::new();
        injector.pop(MS, &mut out);
        let bits: u32 = out
            .iter()
            .zip([1u8, 2, 3, 4, 0])
            .map(|(a, b)| (a ^ b).count_ones())
            .sum();
        assert_eq!((out.len(), bits), (5, 1));
    }

    #[test]
    fn delay_holds_until_its_time() {
        let mut injector = injector("delay=100");
        injector.push(MS * 5, &frames(1));
        let mut out = Vec::new();
        injector.pop(MS * 104, &mut out);
        assert!(out.is_empty());
        assert_eq!(injector.next_release(), Some(MS * 105));
        injector.pop(MS * 105, &mut out);
        assert_eq!(out.len(), 5);
    }

    #[test]
    fn a_slow_line_carries_its_rate_and_its_buffer_no_more_than_it_holds() {
        let mut injector = injector("rate=100,buffer=20");
        injector.push(MS, &frames(6));
        assert_eq!(injector.counts().overflowed, 2);
        let mut out = Vec::new();
        for (at, arrived) in [(50, 0), (51, 5), (101, 10), (200, 15), (201, 20), (900, 20)] {
            injector.pop(MS * at, &mut out);
            assert_eq!(out.len(), arrived, "after {at} ms");
        }
        // The buffer is empty again.
        injector.push(MS * 1000, &frames(4));
        assert_eq!(injector.counts().overflowed, 2);
        assert_eq!(injector.next_release(), Some(MS * 1050));
    }

    #[test]
    fn clumps_come_whole_or_after_the_longest_hold() {
        let mut injector = injector("clump=12");
        let mut out = Vec::new();
        injector.push(MS, &frames(2));
        injector.pop(MS, &mut out);
        assert!(out.is_empty());
        injector.push(MS * 2, &frames(1));
        injector.pop(MS * 2, &mut out);
        assert_eq!(out.len(), 12);
        injector.pop(MS * 1001, &mut out);
        assert_eq!(out.len(), 12);
        injector.pop(MS * 1002, &mut out);
        assert_eq!(out.len(), 15);
    }

    #[test]
    fn nothing_passes_while_disconnected() {
        let mut injector = injector("delay=10,disconnect=100:50");
        let mut out = Vec::new();
        for at in [80, 95, 120, 149, 150] {
            injector.push(MS * at, &frames(1));
        }
        injector.pop(MS * 1000, &mut out);
        // Sent at 80 and 150; frames under way at 100 are lost.
        assert_eq!(out.len(), 10);
        assert_eq!(injector.counts().cut_off, 3);
    }

    #[test]
    fn reordered_frames_are_overtaken_and_none_is_lost() {
        let mut injector = injector("reorder=30%,delay=20");
        let sent: Vec<[u8; 2]> = (1..=200).map(|byte| [byte, 0]).collect();
        for (frame, ms) in sent.iter().zip(0..) {
            injector.push(MS * 10 * ms, frame);
        }
        let mut out = Vec::new();
        injector.pop(MS * 5000, &mut out);
        let mut arrived: Vec<u8> = out.chunks_exact(2).map(|frame| frame[0]).collect();
        let overtaken = arrived.windows(2).filter(|pair| pair[1] < pair[0]).count();
        assert!(overtaken > 10, "{overtaken}");
        assert!(injector.counts().detoured > 30, "{:?}", injector.counts());
        arrived.sort_unstable();
        assert_eq!(arrived, (1..=200).collect::<Vec<u8>>());
    }

    #[test]
    fn old_bytes_come_first_after_a_silence_or_an_outage() {
        let mut injector = injector("stale=6,disconnect=1000:100");
        let mut out = Vec::new();
        let mut at = |ms, byte| {
            out.clear();
            injector.push(MS * ms, &[byte, byte, 0]);
            injector.pop(MS * ms, &mut out);
            out.clone()
        };
        assert_eq!(at(0, 1), [1, 1, 0]);
        assert_eq!(at(100, 2), [2, 2, 0]);
        assert_eq!(at(200, 3), [3, 3, 0]);
        // After a silence.
        assert_eq!(at(500, 4), [2, 2, 0, 3, 3, 0, 4, 4, 0]);
        assert_eq!(at(799, 5), [5, 5, 0]);
        assert_eq!(at(950, 6), [6, 6, 0]);
        assert!(at(1050, 7).is_empty());
        // After the interruption, although it was never silent.
        assert_eq!(at(1100, 8), [5, 5, 0, 6, 6, 0, 8, 8, 0]);
        assert_eq!(injector.counts().stale_bytes, 12);
    }

    #[test]
    fn another_baud_rate_leaves_noise() {
        let mut injector = injector("baud=57600");
        injector.push(MS, &frames(20));
        let mut out = Vec::new();
        injector.pop(MS, &mut out);
        assert!(!out.is_empty() && out != frames(20), "{out:?}");
        assert_eq!(injector.counts().misread, 20);
    }
}
