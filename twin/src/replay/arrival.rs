//! Arrival of each frame at the robot, from the robot's own reports: every pong has the arrival time of its ping, and every
//! telemetry frame the number of received frames. The host's send times are not sufficient: a loaded machine writes a frame
//! long after its time, and its estimate of the robot's clock changes.

/// Ticks before which a frame may have been read, both inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) first: u64,
    pub(super) last: u64,
    /// The window comes from the robot's count of frames. False near lost frames, where only neighbouring pings bound it.
    pub(super) counted: bool,
}

impl Window {
    /// Tick of the window nearest to another tick.
    pub(super) fn nearest(&self, tick: u64) -> u64 {
        tick.clamp(self.first, self.last.max(self.first))
    }
}

/// Ping among the sent frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct PingArrival {
    /// Index among the sent frames.
    pub(super) index: usize,
    /// First tick after it was read; `None` without a reply.
    pub(super) tick: Option<u64>,
}

/// The robot's count of valid frames at a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameCount {
    pub(super) tick: u64,
    pub(super) frames_ok: u16,
}

/// Interval of pings without lost frames: the robot's count minus the index in the log is the same at each of them.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    from: usize,
    to: usize,
    offset: i64,
}

/// Ticks by which a counted window may end before the host's estimate of the sending and still be accepted.
const TOLERANCE: u64 = 5;

/// Arrival windows of all sent frames, in order. `sent` has the first tick after each sending, by the host's estimate; `end` is
/// the last tick of the log.
pub(super) fn windows(
    sent: &[u64],
    pings: &[PingArrival],
    counts: &[FrameCount],
    end: u64,
) -> Vec<Window> {
    let counts = unrolled(counts);
    let stretches = stretches(pings, &counts);
    let answered: Vec<(usize, u64)> = pings
        .iter()
        .filter_map(|ping| Some((ping.index, ping.tick?)))
        .collect();
    let mut earliest = 0;
    let mut windows: Vec<Window> = Vec::with_capacity(sent.len());
    for (index, &sent) in sent.iter().enumerate() {
        let counted = stretch_of(index, &stretches)
            .and_then(|stretch| stretch.window(index, &counts))
            .filter(|window| window.last.saturating_add(TOLERANCE) >= sent);
        let mut window = counted.unwrap_or_else(|| between_pings(index, &answered, end));
        // The line preserves the order.
        window.first = window.first.max(earliest).min(end.saturating_add(1));
        window.last = window.last.min(end.saturating_add(1)).max(window.first);
        earliest = window.first;
        windows.push(window);
    }
    windows
}

/// Counts without wrap-around, in the order of their ticks.
fn unrolled(counts: &[FrameCount]) -> Vec<(u64, i64)> {
    let mut unrolled: Vec<(u64, i64)> = Vec::with_capacity(counts.len());
    let mut last = 0_u16;
    for count in counts {
        let total = match unrolled.last() {
            None => i64::from(count.frames_ok),
            Some((tick, _)) if count.tick <= *tick => continue,
            Some((_, total)) => total + i64::from(count.frames_ok.wrapping_sub(last)),
        };
        last = count.frames_ok;
        unrolled.push((count.tick, total));
    }
    unrolled
}

/// Only pings that arrived alone between two telemetry frames are used: each of them gives the exact offset.
fn stretches(pings: &[PingArrival], counts: &[(u64, i64)]) -> Vec<Stretch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    for ping in pings {
        let Some(tick) = ping.tick else {
            continue;
        };
        let later = counts.partition_point(|(at, _)| *at < tick);
        let before = later.checked_sub(1).and_then(|i| counts.get(i));
        let (Some((_, before)), Some((_, after))) = (before, counts.get(later)) else {
            continue;
        };
        if before + 1 != *after {
            continue;
        }
        let offset = before - i64::try_from(ping.index).unwrap_or(i64::MAX);
        match stretches.last_mut() {
            Some(stretch) if stretch.offset == offset => stretch.to = ping.index,
            _ => stretches.push(Stretch {
                from: ping.index,
                to: ping.index,
                offset,
            }),
        }
    }
    stretches
}

/// Stretch of a frame. The first one extends to the start of the log, the last one to its end.
fn stretch_of(index: usize, stretches: &[Stretch]) -> Option<&Stretch> {
    let place = stretches.partition_point(|stretch| stretch.to < index);
    match stretches.get(place) {
        Some(stretch) => (place == 0 || stretch.from <= index).then_some(stretch),
        None => stretches.last(),
    }
}

impl Stretch {
    /// Returns `None` if the log ends before the frame was counted.
    fn window(&self, index: usize, counts: &[(u64, i64)]) -> Option<Window> {
        let place = i64::try_from(index).unwrap_or(i64::MAX);
        let later = counts.partition_point(|(_, count)| count - self.offset <= place);
        let first = later
            .checked_sub(1)
            .and_then(|i| counts.get(i))
            .map_or(0, |(tick, _)| tick.saturating_add(1));
        let (last, _) = counts.get(later)?;
        Some(Window {
            first,
            last: (*last).max(first),
            counted: true,
        })
    }
}

fn between_pings(index: usize, answered: &[(usize, u64)], end: u64) -> Window {
    let later = answered.partition_point(|(ping, _)| *ping < index);
    let before = later.checked_sub(1).and_then(|i| answered.get(i));
    let after = answered.get(later);
    Window {
        first: before.map_or(0, |(_, tick)| *tick),
        last: after.map_or(end, |(_, tick)| *tick),
        counted: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames read before these ticks, every fifth a ping, telemetry at every second tick, with a count that begins at `base`.
    fn log(
        read: &[u64],
        lost: &[usize],
        base: u16,
        end: u64,
    ) -> (Vec<PingArrival>, Vec<FrameCount>) {
        let arrived = |index: &usize| !lost.contains(index);
        let pings = (0..read.len())
            .filter(|index| index % 5 == 2)
            .map(|index| PingArrival {
                index,
                tick: arrived(&index).then(|| read[index]),
            })
            .collect();
        let counts = (0..=end)
            .step_by(2)
            .map(|tick| {
                let come = (0..read.len()).filter(|index| arrived(index) && read[*index] <= tick);
                FrameCount {
                    tick,
                    frames_ok: base.wrapping_add(u16::try_from(come.count()).unwrap()),
                }
            })
            .collect();
        (pings, counts)
    }

    fn late(count: u64) -> Vec<u64> {
        // Every third tick, with a stall of half a second after which all arrive at once.
        (0..count)
            .map(|index| match 10 + 3 * index {
                tick @ 100..=125 => tick.max(125),
                tick => tick,
            })
            .collect()
    }

    #[test]
    fn windows_hold_the_arrival_whatever_the_host_says() {
        let read = late(80);
        for base in [0, 65_500] {
            let (pings, counts) = log(&read, &[], base, 400);
            // The host's send times are up to half a second early.
            let sent: Vec<u64> = read
                .iter()
                .map(|tick| tick.saturating_sub(tick % 26))
                .collect();
            let windows = windows(&sent, &pings, &counts, 400);
            for (window, tick) in windows.iter().zip(&read) {
                assert!(window.counted, "{window:?}");
                assert!(
                    (window.first..=window.last).contains(tick),
                    "{window:?} {tick}"
                );
                assert!(window.last - window.first <= 1, "{window:?}");
            }
        }
    }

    #[test]
    fn near_a_lost_frame_the_pings_bound_the_window() {
        let read = late(80);
        let lost = [41, 42];
        let (pings, counts) = log(&read, &lost, 7, 400);
        let windows = windows(&read, &pings, &counts, 400);
        let arrived = (0..read.len()).filter(|index| !lost.contains(index));
        for index in arrived {
            let window = windows[index];
            assert!(
                (window.first..=window.last).contains(&read[index]),
                "{index}: {window:?}"
            );
            // The last ping before them that arrived alone is the 27th frame.
            let near = (28..=46).contains(&index);
            assert_eq!(window.counted, !near, "{index}: {window:?}");
        }
    }

    #[test]
    fn absurd_numbers_are_windows_too() {
        let counts =
            [(u64::MAX, 3), (5, 9), (6, 1)].map(|(tick, frames_ok)| FrameCount { tick, frames_ok });
        let pings = [(0, Some(u64::MAX)), (1, Some(0)), (9, None)]
            .map(|(index, tick)| PingArrival { index, tick });
        for window in windows(&[u64::MAX, 0, 7], &pings, &counts, 10) {
            assert!(window.first <= window.last);
        }
        assert!(windows(&[], &[], &[], 0).is_empty());
        assert_eq!(windows(&[3], &[], &[], 9)[0].nearest(3), 3);
    }
}
