//! Two reflectors followed while their frames come.

use std::collections::VecDeque;

use nalgebra::Vector3;

use super::pairs::{Candidate, Pairs};
use super::walk::Walker;
use crate::PoseOptions;
use crate::median::median;

/// Frames whose distances and predictions set the limits after a gap.
const RECENT: usize = 500;
/// Number of frames between updates of the limits.
const LEARNED_EVERY: usize = 100;
/// Largest number of candidates in a frame.
const MOST: usize = 64;
/// A reflector may move by the distance of both in this time \[s\], even if it was slower so far: a robot that rested may start while
/// it is hidden.
const SLOWEST_S: f64 = 1.0;
/// Numbers of the candidates that are called front and back; others follow.
const FRONT: usize = 0;
const BACK: usize = 1;

/// End of the middle link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The front end.
    Front,
    /// The back end.
    Back,
}

/// A point of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// End whose reflector has this name; a hint.
    pub label: Option<End>,
    /// Its place \[m\].
    pub place: Vector3<f64>,
}

/// Both reflectors of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowedPair {
    /// The continuation of the previous frame's front point.
    pub front: Vector3<f64>,
    /// The other point.
    pub back: Vector3<f64>,
    /// `true` if the labels agree with this order, `false` if they contradict it; `None` without labels.
    pub labels: Option<bool>,
    /// A new segment begins: since the frame before, both could have changed places unseen.
    pub begins: bool,
}

/// Follows two reflectors through swaps, ghosts and drop-outs, frame by frame, as [`poses`](crate::poses()) does with a recording.
///
/// ```
/// use calibrate::{End, PairFollower, Sighting};
/// use nalgebra::Vector3;
///
/// let mut follower = PairFollower::new(0.1).unwrap();
/// for step in 0..100 {
///     let along = 1e-3 * f64::from(step);
///     let at = |x: f64, label| Sighting { label, place: Vector3::new(x + along, 0.0, 0.0) };
///     // Labels are exchanged for some frames.
///     let (a, b) = if (50..60).contains(&step) { (End::Back, End::Front) } else { (End::Front, End::Back) };
///     let pair = follower.push(0.01 * f64::from(step), &[at(0.1, Some(a)), at(0.0, Some(b)), at(0.3, None)]).unwrap();
///     assert!((pair.front.x - along - 0.1).abs() < 1e-12);
/// }
/// ```
#[derive(Debug)]
pub struct PairFollower {
    pairs: Pairs,
    walker: Walker,
    frames: usize,
    last_s: Option<f64>,
    steps: VecDeque<f64>,
    distances: VecDeque<f64>,
    misses: VecDeque<f64>,
}

impl PairFollower {
    /// For reflectors at this distance \[m\]; `None` if that is not positive.
    pub fn new(distance_m: f64) -> Option<Self> {
        let mut pairs = Pairs::new(distance_m, PoseOptions::default().distance_tolerance);
        (pairs.fronts, pairs.backs) = (vec![FRONT], vec![BACK]);
        (distance_m.is_finite() && distance_m > 0.0).then(|| Self {
            pairs,
            walker: Walker::at_speed(distance_m / SLOWEST_S),
            frames: 0,
            last_s: None,
            steps: VecDeque::new(),
            distances: VecDeque::new(),
            misses: VecDeque::new(),
        })
    }

    /// Median distance of both reflectors in recent frames \[m\].
    pub fn distance_m(&self) -> f64 {
        self.pairs.distance
    }

    /// Takes the points of a frame; times must grow. Returns `None` if it does not show both reflectors.
    pub fn push(&mut self, time_s: f64, sightings: &[Sighting]) -> Option<FollowedPair> {
        if let Some(last_s) = self.last_s.replace(time_s) {
            keep(&mut self.steps, time_s - last_s);
        }
        let candidates: Vec<Candidate> = sightings
            .iter()
            .take(MOST)
            .zip(BACK + 1..)
            .map(|(sighting, other)| {
                let number = match sighting.label {
                    Some(End::Front) => FRONT,
                    Some(End::Back) => BACK,
                    None => other,
                };
                (number, sighting.place)
            })
            .collect();
        if self.frames.is_multiple_of(LEARNED_EVERY) {
            self.learn();
        }
        let rows = self
            .walker
            .step(&self.pairs, self.frames, time_s, &candidates);
        self.frames += 1;
        // Only the last of a frame jump's rows is of now.
        let begins = rows.iter().any(|row| row.begins);
        let row = rows.last()?;
        keep(&mut self.distances, (row.front - row.back).norm());
        if let Some(miss) = row.miss {
            keep(&mut self.misses, miss);
        }
        Some(FollowedPair {
            front: row.front,
            back: row.back,
            labels: row.labels,
            begins,
        })
    }

    fn learn(&mut self) {
        self.pairs.step_s = median(self.steps.iter().copied()).unwrap_or(0.0);
        self.pairs
            .learn(self.distances.iter().copied(), self.misses.iter().copied());
    }
}

fn keep(recent: &mut VecDeque<f64>, value: f64) {
    if recent.len() >= RECENT {
        recent.pop_front();
    }
    recent.push_back(value);
}
