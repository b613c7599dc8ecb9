//! Fit of the robot's clock to the host's: a straight line through the fastest pings, with its uncertainty, so that camera
//! frames can be placed on the robot's time.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::time::Duration;

use link_protocol::Pong;

/// Number of stored pings: at one per second, about four minutes.
const REMEMBERED: usize = 256;
/// Number of initial pings that are all stored, for a first fit.
const QUICK_PINGS: usize = 8;
const PING_EVERY: Duration = Duration::from_secs(1);

/// Linear map from the host's clock to the robot's: `robot = robot_at_origin + rate · (host − origin)`, seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ClockFit {
    /// Host time near the middle of the pings, s.
    pub origin: f64,
    /// Robot time at the origin, s.
    pub robot_at_origin: f64,
    /// Robot seconds per host second.
    pub rate: f64,
    /// Error bound of a converted time within the span of the pings, s: half of the shortest round trip (its division into the
    /// two directions is unknown) plus the scatter about the line.
    pub uncertainty: f64,
    /// Number of pings in the fit.
    pub pings: usize,
}

impl ClockFit {
    /// Robot time at a time of the host's clock, s.
    pub fn robot_time(&self, host: Duration) -> f64 {
        self.robot_at_origin + self.rate * (host.as_secs_f64() - self.origin)
    }

    /// Host time at a time of the robot's clock, s.
    pub fn host_time(&self, robot: f64) -> f64 {
        self.origin + (robot - self.robot_at_origin) / self.rate
    }
}

#[derive(Debug, Clone, Copy)]
struct Sample {
    /// Host clock at the middle of the round trip, s.
    host: f64,
    /// Robot clock at the middle of the robot's processing, s.
    robot: f64,
    /// Round trip without the robot's processing time, s.
    trip: f64,
}

/// Collector of pongs, for a session or an observer of one.
#[derive(Debug, Default)]
pub struct ClockSamples {
    samples: VecDeque<Sample>,
    /// Time at which the last stored ping was sent.
    last_sent: Duration,
}

impl ClockSamples {
    /// Adds a pong that arrived at `now` on the host's clock. After the first ones, only the fastest of each second is kept.
    /// Returns its round trip.
    pub fn push(&mut self, pong: &Pong, now: Duration) -> Option<Duration> {
        let sent = Duration::from_micros(pong.host_us);
        let trip = Self::time_under_way(pong, now)?;
        // Keep-alives and telemetry beat against each other, and some pings wait for telemetry, so only the fastest of each
        // second counts.
        let within = self.samples.len() > QUICK_PINGS && sent < self.last_sent + PING_EVERY;
        match self.samples.back() {
            Some(last) if within && trip.as_secs_f64() >= last.trip => return Some(trip),
            Some(_) if within => drop(self.samples.pop_back()),
            _ => self.last_sent = sent,
        }
        if self.samples.len() == REMEMBERED {
            self.samples.pop_front();
        }
        self.samples.push_back(Sample {
            host: f64::midpoint(sent.as_secs_f64(), now.as_secs_f64()),
            robot: f64::midpoint(pong.received_us as f64, pong.sent_us as f64) * 1e-6,
            trip: trip.as_secs_f64(),
        });
        Some(trip)
    }

    /// Discards all samples: the robot has restarted, or the port's clock has changed.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.last_sent = Duration::ZERO;
    }

    /// Round trip of a pong that arrived at `now` on the host's clock. Returns `None` if its times are inconsistent.
    fn time_under_way(pong: &Pong, now: Duration) -> Option<Duration> {
        let sent = Duration::from_micros(pong.host_us);
        let stay = Duration::from_micros(pong.sent_us.checked_sub(pong.received_us)?);
        now.checked_sub(sent)?.checked_sub(stay)
    }

    /// Line through the fastest half of the pings. Returns `None` before the first.
    pub fn fit(&self) -> Option<ClockFit> {
        let mut quickest: Vec<Sample> = self.samples.iter().copied().collect();
        quickest.sort_by(|a, b| a.trip.total_cmp(&b.trip));
        let shortest = quickest.first()?.trip;
        quickest.truncate(quickest.len().div_ceil(2).max(2));
        let count = quickest.len() as f64;
        let origin = quickest.iter().map(|s| s.host).sum::<f64>() / count;
        let robot = quickest.iter().map(|s| s.robot).sum::<f64>() / count;
        let spread: f64 = quickest.iter().map(|s| (s.host - origin).powi(2)).sum();
        let slope: f64 = quickest
            .iter()
            .map(|s| (s.host - origin) * (s.robot - robot))
            .sum::<f64>()
            / spread;
        // Two crystals differ by far less than a thousandth; a short span does not determine the rate.
        let rate = if slope.is_finite() && (slope - 1.0).abs() < 1e-3 {
            slope
        } else {
            1.0
        };
        let scatter: f64 = quickest
            .iter()
            .map(|s| (s.robot - robot - rate * (s.host - origin)).powi(2))
            .sum();
        Some(ClockFit {
            origin,
            robot_at_origin: robot,
            rate,
            uncertainty: 0.5 * shortest + (scatter / count).sqrt(),
            pings: quickest.len(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn the_line_holds_within_its_uncertainty() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut samples = ClockSamples::default();
        // The robot's clock runs 40 ppm fast and started 3.5 s before the host's.
        let robot = |host: f64| 3.5 + host * 1.000_04;
        for second in 0..120 {
            let sent = f64::from(second);
            let there = 0.005 + rng.random::<f64>() * 0.05;
            let back = 0.005 + rng.random::<f64>() * 0.2;
            let us = |s: f64| u64::try_from(Duration::from_secs_f64(s).as_micros()).unwrap();
            let pong = Pong {
                host_us: us(sent),
                received_us: us(robot(sent + there)),
                sent_us: us(robot(sent + there + 0.001)),
            };
            samples.push(&pong, Duration::from_secs_f64(sent + there + 0.001 + back));
        }
        let fit = samples.fit().unwrap();
        for second in [0, 60, 120] {
            let error = fit.robot_time(Duration::from_secs(second)) - robot(second as f64);
            assert!(
                error.abs() < fit.uncertainty,
                "{error} against {}",
                fit.uncertainty
            );
        }
        assert!(fit.uncertainty < 0.06);
        assert!((fit.host_time(fit.robot_time(Duration::from_secs(7))) - 7.0).abs() < 1e-9);
    }

    #[test]
    fn pongs_from_the_future_are_no_samples() {
        let mut samples = ClockSamples::default();
        let pong = Pong {
            host_us: 10,
            received_us: 5,
            sent_us: 4,
        };
        assert_eq!(samples.push(&pong, Duration::from_secs(1)), None);
        assert!(samples.fit().is_none());
    }
}
