//! Tracked poses of the middle link.

use nalgebra::Vector2;
use swimmer_model::wrapped_angle;

/// Tracked pose of the middle link in the tank's frame, with the standard deviations of its errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Time of the exposure \[s\].
    pub time_s: f64,
    /// Position of the middle link's centre along the tank \[m\].
    pub x_m: f64,
    /// Position across the tank \[m\].
    pub y_m: f64,
    /// Heading \[rad\].
    pub heading_rad: f64,
    /// Standard deviation of each coordinate \[m\].
    pub sigma_position_m: f64,
    /// Standard deviation of the heading \[rad\].
    pub sigma_heading_rad: f64,
}

impl Pose {
    /// The pose as an element of SE(2).
    pub fn placed(&self) -> swimmer_model::Pose<f64> {
        swimmer_model::Pose::new(self.x_m, self.y_m, self.heading_rad)
    }

    /// Returns `true` if every number is finite and the deviations are positive.
    pub fn is_valid(&self) -> bool {
        let numbers = [self.time_s, self.x_m, self.y_m, self.heading_rad];
        numbers.iter().all(|number| number.is_finite())
            && [self.sigma_position_m, self.sigma_heading_rad]
                .iter()
                .all(|sigma| sigma.is_finite() && *sigma > 0.0)
    }
}

/// Errors of neighbouring frames are correlated by the filter: this many count as one.
pub(crate) const FRAMES_PER_SAMPLE: f64 = 4.0;

/// Deviations from the median beyond which a pose of a robot at rest is an outlier.
const OUTLYING: f64 = 3.0;

/// Mean of some poses of a robot at rest, without outliers; its deviations are those of the mean. `None` without poses.
pub(crate) fn mean(poses: &[Pose]) -> Option<Pose> {
    let first = poses.first()?;
    let turned = |pose: &Pose| wrapped_angle(pose.heading_rad - first.heading_rad);
    let middle = [
        median(poses, |pose| pose.x_m)?,
        median(poses, |pose| pose.y_m)?,
        median(poses, turned)?,
    ];
    let is_near = |pose: &&Pose| {
        let off = (pose.x_m - middle[0]).hypot(pose.y_m - middle[1]);
        off <= OUTLYING * pose.sigma_position_m
            && (turned(pose) - middle[2]).abs() <= OUTLYING * pose.sigma_heading_rad
    };
    // A robot that drifts fast leaves none near the median: then all count.
    let near: Vec<&Pose> = poses.iter().filter(is_near).collect();
    let poses = if 2 * near.len() >= poses.len() {
        near
    } else {
        poses.iter().collect()
    };
    let (mut weights, mut turn_weights) = (0.0, 0.0);
    let (mut position, mut time, mut turn) = (Vector2::zeros(), 0.0, 0.0);
    for pose in poses {
        let weight = pose.sigma_position_m.powi(-2);
        let turn_weight = pose.sigma_heading_rad.powi(-2);
        weights += weight;
        turn_weights += turn_weight;
        position += Vector2::new(pose.x_m, pose.y_m) * weight;
        time += pose.time_s * weight;
        turn += turned(pose) * turn_weight;
    }
    Some(Pose {
        time_s: time / weights,
        x_m: position.x / weights,
        y_m: position.y / weights,
        heading_rad: first.heading_rad + turn / turn_weights,
        sigma_position_m: (FRAMES_PER_SAMPLE / weights).sqrt(),
        sigma_heading_rad: (FRAMES_PER_SAMPLE / turn_weights).sqrt(),
    })
}

fn median(poses: &[Pose], value: impl Fn(&Pose) -> f64) -> Option<f64> {
    let mut values: Vec<f64> = poses.iter().map(value).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
