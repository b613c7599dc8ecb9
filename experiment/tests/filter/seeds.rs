//! Error bounds over many seeds, measured against the truth at the moment of use.

use experiment::{FilterEvent, PoseFilter};
use nalgebra::Vector2;
use swimmer_model::{Pose, wrapped_angle};

use crate::cameras::{self, Faults, reflector};
use crate::swum::{RATE_HZ, SIDE_M, filmed, swum};

/// A filter that also follows the side links; reflectors there are from the joint outwards.
pub(crate) fn filter(latency_s: f64) -> PoseFilter {
    cameras::filter(
        latency_s,
        4.0,
        Some([reflector("Tip", SIDE_M), reflector("Tail", SIDE_M)]),
    )
}

/// Errors at the times at which frames are received, extrapolated over the latency.
#[derive(Debug, Default)]
pub(crate) struct Errors {
    pub(crate) position_m: Vec<f64>,
    pub(crate) heading_rad: Vec<f64>,
    /// Squared errors over the stated variances.
    position_ratio: f64,
    heading_ratio: f64,
    pub(crate) without: usize,
    /// Time until the front is known \[s\].
    pub(crate) known_s: f64,
    pub(crate) events: Vec<FilterEvent>,
}

impl Errors {
    /// Filters frames, and compares every pose with the truth then.
    pub(crate) fn of(poses: &[Pose<f64>], faults: Faults, seed: u64) -> Self {
        let mut filter = filter(faults.latency_s);
        let mut errors = Self::default();
        for frame in filmed(poses, faults, seed) {
            let knew_front = filter.knows_front();
            let event = filter.push(&frame);
            let host_s = frame.received_s;
            // Names may be wrong at first; the front is not known then.
            errors
                .events
                .extend(event.filter(|event| knew_front || *event != FilterEvent::TurnedRound));
            if !filter.knows_front() {
                errors.known_s = host_s;
                continue;
            }
            let Some(truth) = truth_at(poses, host_s) else {
                continue;
            };
            // The first second is for the filter to settle.
            if host_s < 1.0 {
                continue;
            }
            let Some(pose) = filter.pose_now(host_s) else {
                errors.without += 1;
                continue;
            };
            let off = (pose.x_m - truth.x).hypot(pose.y_m - truth.y);
            let turned = wrapped_angle(pose.heading_rad - truth.theta).abs();
            errors.position_ratio += (off / pose.sigma_position_m).powi(2) / 2.0;
            errors.heading_ratio += (turned / pose.sigma_heading_rad).powi(2);
            errors.position_m.push(off);
            errors.heading_rad.push(turned);
        }
        errors
    }
}

fn truth_at(poses: &[Pose<f64>], host_s: f64) -> Option<Pose<f64>> {
    let at = host_s * RATE_HZ;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let before = at.floor() as usize;
    let (a, b) = (poses.get(before)?, poses.get(before + 1)?);
    let part = at - before as f64;
    Some(Pose::new(
        a.x + part * (b.x - a.x),
        a.y + part * (b.y - a.y),
        a.theta + part * wrapped_angle(b.theta - a.theta),
    ))
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let index = (share * (values.len() - 1) as f64) as usize;
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}

/// Bounds of the error: 95 %, 99.9 % and the largest, in mm and degrees.
struct Bounds {
    position_mm: [f64; 3],
    heading_deg: [f64; 3],
}

#[track_caller]
fn check(name: &str, faults: Faults, seeds: u64, bounds: &Bounds) {
    let mut all = Errors::default();
    for seed in 0..seeds {
        let poses = swum(2000, 6.0, seed);
        let errors = Errors::of(&poses, faults, seed);
        assert_eq!(errors.events, [FilterEvent::Found], "seed {seed}");
        all.known_s = all.known_s.max(errors.known_s);
        all.position_m.extend(errors.position_m);
        all.heading_rad.extend(errors.heading_rad);
        all.position_ratio += errors.position_ratio;
        all.heading_ratio += errors.heading_ratio;
        all.without += errors.without;
    }
    let count = all.position_m.len() as f64;
    let ratios = [all.position_ratio, all.heading_ratio].map(|sum| sum / count);
    let shares = [0.95, 0.999, 1.0];
    let position = shares.map(|share| 1e3 * quantile(&mut all.position_m, share));
    let heading = shares.map(|share| quantile(&mut all.heading_rad, share).to_degrees());
    println!(
        "{name}: {count} poses, position {position:.2?} mm, heading {heading:.2?}°, error/stated {ratios:.2?}, front known after {:.2} s",
        all.known_s
    );
    assert!(all.known_s < 8.0, "{} s", all.known_s);
    assert_eq!(all.without, 0);
    for (measured, bound) in position.iter().zip(bounds.position_mm) {
        assert!(*measured <= bound, "position {position:?}");
    }
    for (measured, bound) in heading.iter().zip(bounds.heading_deg) {
        assert!(*measured <= bound, "heading {heading:?}");
    }
    // Stated deviations are neither boasts nor excuses.
    assert!(
        ratios.iter().all(|ratio| (0.1..2.0).contains(ratio)),
        "{ratios:?}"
    );
}

#[test]
fn good_cameras() {
    let bounds = Bounds {
        position_mm: [0.8, 1.3, 1.6],
        heading_deg: [0.9, 1.5, 2.0],
    };
    check("good cameras", Faults::NONE, 10, &bounds);
}

/// 30 % blank frames in bursts, swaps, ghosts, relabelling, 80 ms latency with jitter.
#[test]
fn bad_cameras() {
    let bounds = Bounds {
        position_mm: [1.5, 4.0, 6.0],
        heading_deg: [1.6, 5.0, 10.0],
    };
    check("bad cameras", Faults::ALL, 40, &bounds);
}

/// The controller decides by the mean of a robot at rest: bounds of its error after a cycle, under all faults.
#[test]
fn mean_at_rest() {
    let (mut position_mm, mut heading_deg): (f64, f64) = (0.0, 0.0);
    for seed in 0..40 {
        let mut poses = swum(1400, 6.0, seed);
        let rest = *poses.last().unwrap();
        poses.resize(1600, rest);
        let mut filter = filter(Faults::ALL.latency_s);
        let (mut off, mut turned) = (Vector2::zeros(), 0.0);
        let (mut weights, mut turn_weights) = (0.0, 0.0);
        for (number, frame) in filmed(&poses, Faults::ALL, seed).iter().enumerate() {
            let event = filter.push(frame);
            assert!(number < 500 || event.is_none(), "seed {seed}: {event:?}");
            // After 0.2 s at rest, as long as the controller takes the mean.
            if number >= 1420 {
                let pose = filter.pose().unwrap();
                let weight = pose.sigma_position_m.powi(-2);
                let turn_weight = pose.sigma_heading_rad.powi(-2);
                off += Vector2::new(pose.x_m - rest.x, pose.y_m - rest.y) * weight;
                turned += wrapped_angle(pose.heading_rad - rest.theta) * turn_weight;
                weights += weight;
                turn_weights += turn_weight;
            }
        }
        position_mm = position_mm.max(1e3 * off.norm() / weights);
        heading_deg = heading_deg.max((turned / turn_weights).to_degrees().abs());
    }
    println!("mean at rest: at most {position_mm:.3} mm, {heading_deg:.3}°");
    assert!(position_mm < 0.15, "{position_mm} mm");
    assert!(heading_deg < 0.2, "{heading_deg}°");
}
