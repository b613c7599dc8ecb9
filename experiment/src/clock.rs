//! Match of the clocks of robot and cameras.
//!
//! Two sources: frames arrive after their exposure by at most a known delay, which bounds the offset ([`Delays`](crate::Delays)); and
//! the heading oscillates within a cycle as the model predicts from the robot's own clock, which gives the offset within that bound
//! (cross-correlation, with a line taken out and the amplitude left free).

use nalgebra::{Matrix3, Vector3};

use crate::{Course, Pose};

/// Steps of the scan over the bound \[s\].
const SCAN_STEP: f64 = 0.004;
/// More poses than this are thinned, so that the match takes milliseconds: the link is not kept alive meanwhile.
const MOST_POSES: usize = 1500;
/// Fewer poses than this give no match.
const FEWEST_POSES: usize = 24;
/// A match with a larger uncertainty is rejected \[s\].
const LARGEST_UNCERTAINTY: f64 = 0.05;
/// Longest delay of the quickest frames that is searched \[s\].
const LONGEST_DELAY: f64 = 0.3;
/// Uncertainty of the link's clock fit \[s\].
const LINK_UNCERTAINTY: f64 = 0.03;
/// A match that is more uncertain does not date poses \[s\].
const USEFUL_UNCERTAINTY: f64 = 0.02;
/// Scatter of the start of a play by the link \[s\].
const PLAYS_DIFFER: f64 = 0.005;
/// Amplitudes of the measured oscillation over the predicted one that count as the predicted gait.
const AMPLITUDES: std::ops::RangeInclusive<f64> = 0.6..=1.6;

/// Difference of the robot's clock and the cameras' clock: robot time = camera time + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockMatch {
    /// Offset \[s\].
    pub offset_s: f64,
    /// Standard deviation of the offset \[s\], by the scatter of the headings.
    pub uncertainty_s: f64,
    /// Amplitude of the measured oscillation over the predicted one.
    pub amplitude: f64,
    /// Poses used.
    pub poses: usize,
}

/// Delay of the cameras that their frames do not state, measured by the plays of the robot.
///
/// Poses are dated by the quickest frames ([`Delays`](crate::Delays)), so all of them are late by the time that even those were under
/// way. Each play shows that time: its heading oscillates when the robot's clock says. Estimates of several plays are averaged.
#[derive(Debug, Default)]
pub struct CameraDelay {
    cycle: Option<FirstCycle>,
    /// Mean delay \[s\] and its weight \[1/s²\].
    mean: Option<WeightedDelay>,
}

/// First cycle of a play under way.
#[derive(Debug)]
struct FirstCycle {
    course: Course,
    began_s: f64,
    poses: Vec<Pose>,
}

#[derive(Debug, Clone, Copy)]
struct WeightedDelay {
    delay_s: f64,
    weight: f64,
}

impl CameraDelay {
    /// A play began at a time \[s\] on the clock that dates the poses; its first cycle takes this course.
    pub fn began(&mut self, course: Course, began_s: f64) {
        self.cycle = Some(FirstCycle {
            course,
            began_s,
            poses: Vec::new(),
        });
    }

    /// Drops the cycle under way: the play was interrupted.
    pub fn interrupt(&mut self) {
        self.cycle = None;
    }

    /// Takes a pose, and dates it earlier by the delay that is known.
    pub fn dated(&mut self, pose: &Pose) -> Pose {
        if let Some(cycle) = &mut self.cycle {
            let time_s = pose.time_s - cycle.began_s;
            if time_s > cycle.course.duration_s() {
                self.measure();
            } else if time_s >= 0.0 {
                cycle.poses.push(*pose);
            }
        }
        Pose {
            time_s: pose.time_s - self.delay_s().unwrap_or(0.0),
            ..*pose
        }
    }

    /// The delay \[s\]; `None` until a play has shown it.
    pub fn delay_s(&self) -> Option<f64> {
        self.mean.map(|mean| mean.delay_s)
    }

    fn measure(&mut self) {
        let Some(cycle) = self.cycle.take() else {
            return;
        };
        let bounds = [-LONGEST_DELAY, LINK_UNCERTAINTY];
        let thinned = cycle.poses.len().div_ceil(MOST_POSES).max(1);
        let poses: Vec<Pose> = cycle.poses.iter().step_by(thinned).copied().collect();
        let matched = match_clocks(&poses, &cycle.course, cycle.began_s, bounds);
        let Some(matched) = matched.filter(|matched| matched.uncertainty_s < USEFUL_UNCERTAINTY)
        else {
            return;
        };
        let weight = 1.0 / matched.uncertainty_s.hypot(PLAYS_DIFFER).powi(2);
        let before = self.mean.unwrap_or(WeightedDelay {
            delay_s: 0.0,
            weight: 0.0,
        });
        let total = before.weight + weight;
        self.mean = Some(WeightedDelay {
            delay_s: (before.delay_s * before.weight - matched.offset_s * weight) / total,
            weight: total,
        });
    }
}

/// The offset within `bounds` \[s\] at which the headings of some poses, on the cameras' clock, fit a course that began at
/// `began_s` on the robot's clock best. Returns `None` if there are too few poses, if the heading shows too little oscillation, or
/// if the best offset lies at a bound.
pub fn match_clocks(
    poses: &[Pose],
    course: &Course,
    began_s: f64,
    bounds: [f64; 2],
) -> Option<ClockMatch> {
    let headings = unwrapped(poses);
    if headings.len() < FEWEST_POSES || bounds[1] <= bounds[0] {
        return None;
    }
    let fit = |offset: f64| regression(&headings, course, began_s - offset);
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a count, bounded below"
    )]
    let steps = ((bounds[1] - bounds[0]) / SCAN_STEP)
        .ceil()
        .clamp(2.0, 20_000.0) as usize;
    let step = (bounds[1] - bounds[0]) / steps as f64;
    let scanned = (0..=steps).filter_map(|i| {
        let offset = bounds[0] + step * i as f64;
        Some((offset, fit(offset)?.squares))
    });
    let (rough, _) = scanned.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut offset = rough;
    // Newton's method on the sum of squares, by differences over a scan's step.
    let mut bend = 0.0;
    for _ in 0..6 {
        let [below, here, above] = [-step, 0.0, step].map(|by| fit(offset + by));
        let (below, here, above) = (below?.squares, here?.squares, above?.squares);
        bend = (above - 2.0 * here + below) / (step * step);
        if bend <= 0.0 {
            return None;
        }
        let slope = (above - below) / (2.0 * step);
        offset -= (slope / bend).clamp(-step, step);
    }
    if offset < bounds[0] - step || offset > bounds[1] + step {
        return None;
    }
    let best = fit(offset)?;
    let variance = best.squares / (headings.len() as f64 - 4.0);
    let uncertainty_s = (2.0 * crate::pose::FRAMES_PER_SAMPLE * variance / bend).sqrt();
    let plausible = uncertainty_s < LARGEST_UNCERTAINTY && AMPLITUDES.contains(&best.amplitude);
    plausible.then_some(ClockMatch {
        offset_s: offset,
        uncertainty_s,
        amplitude: best.amplitude,
        poses: headings.len(),
    })
}

/// Times and headings without jumps of whole turns.
fn unwrapped(poses: &[Pose]) -> Vec<(f64, f64)> {
    let mut headings: Vec<(f64, f64)> = Vec::with_capacity(poses.len());
    for pose in poses.iter().filter(|pose| pose.is_valid()) {
        let before = headings.last().map_or(pose.heading_rad, |(_, last)| *last);
        let turn = swimmer_model::wrapped_angle(pose.heading_rad - before);
        headings.push((pose.time_s, before + turn));
    }
    headings
}

/// Least squares of the headings by a constant, a line and the course's heading.
struct Regression {
    squares: f64,
    amplitude: f64,
}

/// `None` if the course's heading is constant over the poses.
fn regression(headings: &[(f64, f64)], course: &Course, began_s: f64) -> Option<Regression> {
    let first = headings.first()?.0;
    let row = |time: f64| Vector3::new(1.0, time - first, course.at(time - began_s).theta);
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for &(time, heading) in headings {
        let row = row(time);
        normal += row * row.transpose();
        right += row * heading;
    }
    let found = normal.cholesky()?.solve(&right);
    let squares = headings
        .iter()
        .map(|&(time, heading)| (heading - row(time).dot(&found)).powi(2))
        .sum();
    Some(Regression {
        squares,
        amplitude: found.z,
    })
}
