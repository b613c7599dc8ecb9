//! Offset between camera clock and host clock, from the quickest of recent frames: jitter only adds to a delay.

use std::collections::VecDeque;

/// Window of frames that count \[s\]: clocks may drift.
const WINDOW_S: f64 = 30.0;
/// Minima that are kept.
const MOST: usize = 1024;

/// Least delay between stamp and reception over a sliding window, with a monotonic queue.
#[derive(Debug, Clone, Default)]
pub struct Delays {
    /// Reception and delay, both growing.
    queue: VecDeque<Delay>,
    latency_s: f64,
}

#[derive(Debug, Clone, Copy)]
struct Delay {
    received_s: f64,
    delay_s: f64,
}

impl Delays {
    /// Adds a frame; `latency_s` is the delay between exposure and transmission.
    pub fn push(&mut self, stamp_s: f64, received_s: f64, latency_s: f64) {
        let delay_s = received_s - stamp_s;
        self.latency_s = latency_s;
        while self
            .queue
            .back()
            .is_some_and(|last| last.delay_s >= delay_s)
        {
            self.queue.pop_back();
        }
        self.queue.push_back(Delay {
            received_s,
            delay_s,
        });
        while self.queue.len() > MOST
            || self
                .queue
                .front()
                .is_some_and(|first| received_s - first.received_s > WINDOW_S)
        {
            self.queue.pop_front();
        }
    }

    /// The camera clock at a time on the host clock; `None` before the first frame.
    pub fn camera_time(&self, host_s: f64) -> Option<f64> {
        let least = self.queue.front()?;
        Some(host_s - (least.delay_s - self.latency_s))
    }

    /// Smallest and largest difference \[s\] of host clock and camera clock, if the quickest frame was under way for at most
    /// `longest_s`, and the host clock is uncertain by `host_s`. Returns `None` before the first frame.
    pub fn bounds(&self, longest_s: f64, host_s: f64) -> Option<[f64; 2]> {
        let least = self.queue.front()?.delay_s;
        Some([least - longest_s - host_s, least + host_s])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn jitter_and_drift_leave_the_offset() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut delays = Delays::default();
        assert_eq!(delays.camera_time(0.0), None);
        for step in 0..20_000 {
            let host_s = f64::from(step) * 0.01;
            // 100 parts per million.
            let camera = |host_s: f64| 500.0 + host_s * (1.0 + 1e-4);
            let jitter: f64 = rng.random_range(0.0..0.02);
            let received_s = host_s + 0.08 + jitter;
            delays.push(camera(host_s), received_s, 0.08);
            if step > 100 {
                let error = delays.camera_time(received_s).unwrap() - camera(received_s);
                assert!((-0.002..0.004).contains(&error), "{step}: {error}");
            }
        }
        assert!(delays.queue.len() <= MOST);
    }
}
