//! Cameras with every fault that trackers report.

use experiment::{FilterOptions, PoseFilter};
use pose_source::{Frame, Marker};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use swimmer_files::{PointName, Reflector, Reflectors};
use swimmer_model::Pose;

/// Distance of a reflector from the middle link's centre \[m\].
pub(crate) const REACH_M: f64 = 0.0355;

/// Faults of the cameras.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Faults {
    /// Standard deviation of a coordinate \[m\].
    pub(crate) noise_m: f64,
    /// Share of frames in which a reflector is blank, in bursts of up to 24 frames; in half of the bursts both are.
    pub(crate) blank: f64,
    /// Chance per frame that labels are exchanged for a burst.
    pub(crate) swap: f64,
    /// Chance per frame that a ghost comes; one in twenty goes per frame.
    pub(crate) ghost: f64,
    /// Chance that a reflector is unlabeled after a burst, for up to 300 frames.
    pub(crate) relabel: f64,
    /// Delay between exposure and reception \[s\], and the mean of its exponential jitter.
    pub(crate) latency_s: f64,
    pub(crate) jitter_s: f64,
}

impl Faults {
    pub(crate) const NONE: Self = Self {
        noise_m: 3e-4,
        blank: 0.0,
        swap: 0.0,
        ghost: 0.0,
        relabel: 0.0,
        latency_s: 0.08,
        jitter_s: 0.0,
    };

    pub(crate) const ALL: Self = Self {
        blank: 0.3,
        swap: 0.01,
        ghost: 0.02,
        relabel: 0.2,
        jitter_s: 0.005,
        ..Self::NONE
    };
}

/// Cameras over a robot. Their clock is 1000 s ahead of the host's.
#[derive(Debug)]
pub(crate) struct Cameras {
    faults: Faults,
    rng: ChaCha8Rng,
    blank: [u32; 2],
    unlabeled: [u32; 2],
    swapped: u32,
    ghosts: Vec<[f64; 2]>,
    last_received_s: f64,
}

impl Cameras {
    pub(crate) fn new(faults: Faults, seed: u64) -> Self {
        Self {
            faults,
            rng: ChaCha8Rng::seed_from_u64(seed ^ 0x5eed),
            blank: [0; 2],
            unlabeled: [0; 2],
            swapped: 0,
            ghosts: Vec::new(),
            last_received_s: 0.0,
        }
    }

    /// The frame of a robot at this pose, at a time on the host clock.
    pub(crate) fn expose(&mut self, host_s: f64, pose: &Pose<f64>) -> Frame {
        self.fail(pose);
        let mut markers = Vec::new();
        for (which, along) in [REACH_M, -REACH_M].into_iter().enumerate() {
            if self.blank[which] > 0 {
                continue;
            }
            let (sin, cos) = pose.theta.sin_cos();
            let called = ["Front", "Back"][if self.swapped > 0 { 1 - which } else { which }];
            let [x, y, z]: [f64; 3] = std::array::from_fn(|_| StandardNormal.sample(&mut self.rng));
            markers.push(Marker {
                name: (self.unlabeled[which] == 0).then(|| called.to_owned()),
                id: None,
                x_m: pose.x + along * cos + self.faults.noise_m * x,
                y_m: pose.y + along * sin + self.faults.noise_m * y,
                z_m: 0.05 + self.faults.noise_m * z,
            });
        }
        for [x_m, y_m] in &self.ghosts {
            markers.push(Marker {
                name: None,
                id: None,
                x_m: *x_m,
                y_m: *y_m,
                z_m: 0.05,
            });
        }
        // Lists are in no order.
        if self.rng.random::<bool>() {
            markers.reverse();
        }
        let jitter = -self.faults.jitter_s * (1.0 - self.rng.random::<f64>()).ln();
        // A stream keeps its order.
        let received_s = (host_s + self.faults.latency_s + jitter).max(self.last_received_s);
        self.last_received_s = received_s;
        Frame {
            stamp_s: 1000.0 + host_s,
            received_s,
            latency_s: None,
            markers,
            bodies: Vec::new(),
        }
    }

    /// Faults begin and end.
    fn fail(&mut self, pose: &Pose<f64>) {
        let (faults, rng) = (self.faults, &mut self.rng);
        // Bursts of 13 frames on average, in half of them both: chance per frame that one begins.
        let burst = faults.blank / (1.0 - faults.blank) / 13.0 / 1.5;
        for which in 0..2 {
            if self.blank[which] > 0 {
                self.blank[which] -= 1;
                if self.blank[which] == 0 && rng.random::<f64>() < faults.relabel {
                    self.unlabeled[which] = rng.random_range(1..300);
                }
            } else if rng.random::<f64>() < burst {
                let length = rng.random_range(2..=24);
                self.blank[which] = length;
                if rng.random::<bool>() {
                    self.blank[1 - which] = self.blank[1 - which].max(length);
                }
            }
            self.unlabeled[which] = self.unlabeled[which].saturating_sub(1);
        }
        self.swapped = match self.swapped {
            0 if rng.random::<f64>() < faults.swap => rng.random_range(1..40),
            left => left.saturating_sub(1),
        };
        self.ghosts.retain(|_| rng.random::<f64>() >= 0.05);
        if rng.random::<f64>() < faults.ghost {
            let mut away = || rng.random_range(-0.15..0.15);
            self.ghosts.push([pose.x + away(), pose.y + away()]);
        }
    }
}

/// A filter for the reflectors of these cameras and gaits of at least this period \[s\].
pub(crate) fn filter(latency_s: f64, period_s: f64, sides: Option<[Reflector; 2]>) -> PoseFilter {
    let reflectors = Reflectors {
        front: reflector("Front", REACH_M),
        back: reflector("Back", -REACH_M),
        sides,
        body: None,
    };
    let options = FilterOptions {
        latency_s,
        period_s,
        ..FilterOptions::new(reflectors, 2.0 * REACH_M)
    };
    PoseFilter::new(options).unwrap()
}

/// A reflector on a link's line.
pub(crate) fn reflector(name: &str, along: f64) -> Reflector {
    Reflector {
        point: PointName::Named(name.to_owned()),
        at: [along, 0.0],
    }
}
