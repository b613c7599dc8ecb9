//! Cameras over the tank: two reflectors on the middle link and two ghosts, with the faults of real recordings.
//!
//! Axes of Motive: Y points up, and the tank's (x, y), seen from above, is (Z, X).

mod motive;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use swimmer_model::Pose;

pub use motive::{MotiveFile, TrackError};

/// Longest burst of drop-outs, frames.
const LONGEST_BURST: u32 = 12;
/// Largest distance of ghosts from the robot, m.
const GHOST_RANGE: f64 = 0.4;
/// Probability per frame that an absent ghost appears, and that a present one vanishes.
const GHOST_CHANCES: (f64, f64) = (0.004, 0.02);

/// Parameters of the cameras.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraConfig {
    /// Standard deviation of each coordinate, m.
    pub noise_sd: f64,
    /// Probability that a reflector is missing in one frame.
    pub single_dropout: f64,
    /// Probability per frame that a reflector is lost for 2 to 12 frames.
    pub burst_dropout: f64,
    /// Height of the reflectors above the bottom, m.
    pub height: f64,
    /// Name of the take.
    pub take: String,
    /// Capture time in Motive's format. It is a fixed text, so that equal runs give equal bytes.
    pub capture_start: String,
}

impl Default for CameraConfig {
    /// Good cameras: noise of 0.3 mm, a reflector missing in about 0.5 % of the frames.
    fn default() -> Self {
        Self {
            noise_sd: 3e-4,
            single_dropout: 0.002,
            burst_dropout: 0.0005,
            height: 0.05,
            take: "Virtual tank".to_owned(),
            capture_start: "2026-01-01 12.00.00.000 PM".to_owned(),
        }
    }
}

impl CameraConfig {
    /// Cameras without noise and drop-outs; the ghosts stay.
    pub fn perfect() -> Self {
        Self {
            noise_sd: 0.0,
            single_dropout: 0.0,
            burst_dropout: 0.0,
            ..Self::default()
        }
    }
}

/// Point in Motive's axes (X, Y up, Z), m; `None` if it is missing.
pub type Point = Option<[f64; 3]>;

/// Frame: front reflector, back reflector, two ghosts.
pub type Frame = [Point; 4];

/// State of the cameras during one recording.
///
/// ```
/// use swimmer_model::Pose;
/// use twin::{Camera, CameraConfig};
///
/// let mut camera = Camera::new(CameraConfig::perfect(), 0.3, 1, 0);
/// let frame = camera.expose(&Pose::identity());
/// assert!(frame.iter().flatten().count() >= 2, "it sees both reflectors");
/// ```
#[derive(Debug, Clone)]
pub struct Camera {
    config: CameraConfig,
    /// Distance of each reflector from the middle link's centre, m.
    reach: f64,
    noise: ChaCha8Rng,
    gaps: ChaCha8Rng,
    ghosts_rng: ChaCha8Rng,
    /// Remaining frames for which each reflector is lost.
    lost: [u32; 2],
    ghosts: [Point; 2],
}

impl Camera {
    /// Frame rate, Hz.
    pub const RATE_HZ: u32 = 100;

    /// Returns cameras for reflectors at ±`reach` \[m\] on the middle link. The number of the recording selects the noise, so
    /// that no two recordings share it.
    pub fn new(config: CameraConfig, reach: f64, seed: u64, recording: u64) -> Self {
        let stream = |number: u64| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(100 + 4 * recording + number);
            rng
        };
        Self {
            config,
            reach,
            noise: stream(0),
            gaps: stream(1),
            ghosts_rng: stream(2),
            lost: [0; 2],
            ghosts: [None; 2],
        }
    }

    /// Records one frame of a robot at `pose` (tank's frame).
    pub fn expose(&mut self, pose: &Pose<f64>) -> Frame {
        let reflectors = [self.reach, -self.reach].map(|along| {
            let (sin, cos) = pose.theta.sin_cos();
            [pose.x + along * cos, pose.y + along * sin]
        });
        let mut frame = [None; 4];
        for (place, (reflector, lost)) in
            frame.iter_mut().zip(reflectors.iter().zip(&mut self.lost))
        {
            // Every frame draws the same number of random values, so that one more fault does not change the later ones.
            let (single, burst): (f64, f64) = (self.gaps.random(), self.gaps.random());
            let length = self.gaps.random_range(2..=LONGEST_BURST);
            if *lost == 0 && burst < self.config.burst_dropout {
                *lost = length;
            }
            let [dx, dy, dz]: [f64; 3] =
                std::array::from_fn(|_| StandardNormal.sample(&mut self.noise));
            let sd = self.config.noise_sd;
            if *lost > 0 {
                *lost -= 1;
            } else if single >= self.config.single_dropout {
                let [x, y] = reflector;
                *place = Some([y + sd * dy, self.config.height + sd * dz, x + sd * dx]);
            }
        }
        self.haunt(pose);
        frame[2..].copy_from_slice(&self.ghosts);
        frame
    }

    /// Updates the ghosts: they appear, stay in place except for the noise, and vanish.
    fn haunt(&mut self, pose: &Pose<f64>) {
        let (appear, vanish) = GHOST_CHANCES;
        for ghost in &mut self.ghosts {
            let chance: f64 = self.ghosts_rng.random();
            let [across, height, along]: [f64; 3] =
                std::array::from_fn(|_| self.ghosts_rng.random_range(-1.0..1.0));
            let jitter = 2.0 * self.config.noise_sd;
            *ghost = match *ghost {
                None if chance < appear => Some([
                    pose.y + GHOST_RANGE * across,
                    self.config.height * (1.0 + height),
                    pose.x + GHOST_RANGE * along,
                ]),
                Some([x, y, z]) if chance >= vanish => {
                    Some([x + jitter * across, y + jitter * height, z + jitter * along])
                }
                _ => None,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statistics(values: &[f64]) -> (f64, f64) {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
        (mean, variance.sqrt())
    }

    #[test]
    fn noise_has_the_stated_deviation_and_no_bias() {
        let mut camera = Camera::new(CameraConfig::default(), 0.0355, 3, 0);
        let pose = Pose::new(0.1, -0.2, 0.7);
        let frames: Vec<Frame> = (0..40_000).map(|_| camera.expose(&pose)).collect();
        let (sin, cos) = 0.7_f64.sin_cos();
        let truth = [-0.2 + 0.0355 * sin, 0.05, 0.1 + 0.0355 * cos];
        for (axis, truth) in truth.iter().enumerate() {
            let seen: Vec<f64> = frames
                .iter()
                .filter_map(|frame| frame[0].map(|point| point[axis]))
                .collect();
            let (mean, sd) = statistics(&seen);
            assert!(
                (mean - truth).abs() < 5.0 * 3e-4 / 200.0,
                "axis {axis}: {mean} for {truth}"
            );
            assert!((sd / 3e-4 - 1.0).abs() < 0.02, "axis {axis}: {sd}");
        }
    }

    #[test]
    fn drop_outs_come_single_and_in_bursts_at_their_rate() {
        let mut camera = Camera::new(CameraConfig::default(), 0.0355, 3, 0);
        let pose = Pose::identity();
        let mut missing = [0_u32; 2];
        let (mut run, mut longest) = (0, 0);
        for _ in 0..1_000_000 {
            let frame = camera.expose(&pose);
            run = if frame[0].is_none() { run + 1 } else { 0 };
            longest = longest.max(run);
            for (missing, point) in missing.iter_mut().zip(&frame[..2]) {
                *missing += u32::from(point.is_none());
            }
        }
        // 0.2 % single and 0.05 % bursts of 7 on average: 0.55 %, within five standard deviations.
        for missing in missing {
            assert!((4600..6400).contains(&missing), "{missing}");
        }
        assert!((4..=2 * LONGEST_BURST).contains(&longest), "{longest}");
    }

    #[test]
    fn ghosts_come_and_go() {
        let mut camera = Camera::new(CameraConfig::default(), 0.0355, 3, 0);
        let frames: Vec<Frame> = (0..10_000)
            .map(|_| camera.expose(&Pose::identity()))
            .collect();
        for ghost in [2, 3] {
            let present = frames.iter().filter(|frame| frame[ghost].is_some()).count();
            let changes = frames
                .windows(2)
                .filter(|pair| pair[0][ghost].is_some() != pair[1][ghost].is_some())
                .count();
            assert!(present > 500 && present < 4000, "{present}");
            assert!(changes > 10, "{changes}");
        }
    }

    #[test]
    fn recordings_differ_and_repeat() {
        let first = |seed, recording| {
            Camera::new(CameraConfig::default(), 0.03, seed, recording).expose(&Pose::identity())
        };
        assert_eq!(first(1, 0), first(1, 0));
        assert_ne!(first(1, 0), first(1, 1));
        assert_ne!(first(1, 0), first(2, 0));
    }
}
