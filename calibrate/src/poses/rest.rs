//! Drift of the resting robot: before and after its cycles only the fluid moves it, or the frame of the cameras.

use nalgebra::Vector2;

use super::{Origin, PoseSample};
use crate::median::median;

/// A velocity at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Along the tank's x and y \[m/s\].
    pub velocity_m_s: [f64; 2],
    /// Standard error of either \[m/s\].
    pub error_m_s: f64,
    /// Duration of the rest \[s\].
    pub rest_s: f64,
}

/// Least duration of a rest that is used \[s\].
const LEAST_S: f64 = 0.8;
/// Margin next to the motion that is left out \[s\].
const MARGIN_S: f64 = 0.2;
/// Deviations of the noise within which a heading stands, and a centre goes straight.
const STANDS: f64 = 5.0;
/// Number of samples that determine a position before the first motion.
const FIRST: usize = 7;

/// Velocity, its variance, seconds.
type Rest = (Vector2<f64>, f64, f64);

/// The mean of both rests by their variances.
pub(super) fn drift(samples: &[PoseSample]) -> Option<Drift> {
    let noise = heading_noise(samples)?;
    let seen = |sample: &&PoseSample| sample.origin == Origin::Seen;
    let forwards: Vec<&PoseSample> = samples.iter().filter(seen).collect();
    let backwards: Vec<&PoseSample> = forwards.iter().rev().copied().collect();
    let rests = [rest(&forwards, noise), rest(&backwards, noise)];
    let (mut sum, mut weight, mut rest_s) = (Vector2::zeros(), 0.0, 0.0);
    for (velocity, variance, seconds) in rests.into_iter().flatten() {
        sum += velocity / variance;
        weight += 1.0 / variance;
        rest_s += seconds;
    }
    (weight > 0.0).then(|| Drift {
        velocity_m_s: (sum / weight).into(),
        error_m_s: (1.0 / weight).sqrt(),
        rest_s,
    })
}

/// Standard deviation of a heading by steps from sample to sample, of which noise is most.
fn heading_noise(samples: &[PoseSample]) -> Option<f64> {
    let steps = samples.windows(2).filter_map(|pair| match pair {
        [a, b] => Some((b.pose.theta - a.pose.theta).abs()),
        _ => None,
    });
    // The median of |a − b| is 0.954 standard deviations of either.
    median(steps).map(|step| step / 0.954)
}

/// The motion of the centre from the first sample on, as long as the heading stands and the centre goes straight: joints that
/// start together, as to a symmetric shape, move the centre without a turn.
fn rest(samples: &[&PoseSample], noise: f64) -> Option<Rest> {
    let heading = median(samples.iter().take(FIRST).map(|s| s.pose.theta))?;
    let stands = |s: &&&PoseSample| (s.pose.theta - heading).abs() < STANDS * noise;
    let mut still: Vec<&PoseSample> = samples.iter().take_while(stands).copied().collect();
    loop {
        let line = EvenMotion::through(&still)?;
        if line.seconds < LEAST_S + MARGIN_S {
            return None;
        }
        if line.worst < STANDS * place_noise(&still) {
            break;
        }
        still.truncate(still.len() * 19 / 20);
    }
    let end_s = still.last()?.time_s;
    still.retain(|s| (s.time_s - end_s).abs() > MARGIN_S);
    let line = EvenMotion::through(&still)?;
    Some((line.velocity, line.variance, line.seconds))
}

/// Standard deviation of a coordinate, by steps from sample to sample.
fn place_noise(samples: &[&PoseSample]) -> f64 {
    let steps = samples.windows(2).filter_map(|pair| match pair {
        [a, b] => Some((b.pose.x - a.pose.x).abs().max((b.pose.y - a.pose.y).abs())),
        _ => None,
    });
    // The median of the larger of two |a − b| is 1.48 standard deviations of one coordinate.
    median(steps).unwrap_or(0.0) / 1.48
}

/// Even motion through samples.
struct EvenMotion {
    velocity: Vector2<f64>,
    /// Variance of either coordinate of the velocity.
    variance: f64,
    /// The largest distance of a sample from it \[m\].
    worst: f64,
    seconds: f64,
}

impl EvenMotion {
    fn through(samples: &[&PoseSample]) -> Option<Self> {
        if samples.len() < 2 * FIRST {
            return None;
        }
        let count = samples.len() as f64;
        let mean_s = samples.iter().map(|s| s.time_s).sum::<f64>() / count;
        let places = samples.iter().map(|s| s.pose.position());
        let mean = places.sum::<Vector2<f64>>() / count;
        let (mut spread, mut moment) = (0.0, Vector2::zeros());
        for sample in samples {
            let since = sample.time_s - mean_s;
            spread += since * since;
            moment += (sample.pose.position() - mean) * since;
        }
        let velocity = moment / spread;
        let (mut squares, mut worst) = (0.0, 0.0_f64);
        for sample in samples {
            let expected = mean + velocity * (sample.time_s - mean_s);
            let left = (sample.pose.position() - expected).norm();
            squares += left * left;
            worst = worst.max(left);
        }
        // Two coordinates share the residual.
        let variance = squares / (2.0 * (count - 2.0)) / spread;
        Some(Self {
            velocity,
            variance: variance.max(1e-18),
            worst,
            seconds: (samples.last()?.time_s - samples.first()?.time_s).abs(),
        })
    }
}
