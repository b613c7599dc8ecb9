//! Estimated pose of the middle link: a Kalman filter for each coordinate.

use std::f64::consts::TAU;

use swimmer_model::wrapped_angle;

use super::kinematics::{Agility, Coordinate};
use crate::pose::Pose;

/// Amplitudes of heading and position within a cycle: radians, and shares of the reflectors' distance.
const SWING: (f64, f64) = (0.5, 0.4);

/// Variances of a measured pose: each coordinate \[m²\] and the heading \[rad²\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Variances {
    pub(super) position: f64,
    pub(super) heading: f64,
}

/// Position and heading, as estimated at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimate {
    pub(super) time_s: f64,
    pub(super) x: Coordinate,
    pub(super) y: Coordinate,
    pub(super) heading: Coordinate,
}

impl Estimate {
    /// At rest at a measured pose, for gaits of this period \[s\] and reflectors at this distance \[m\].
    pub(super) fn at(
        time_s: f64,
        pose: &swimmer_model::Pose<f64>,
        variances: Variances,
        period_s: f64,
        distance_m: f64,
    ) -> Self {
        let omega = TAU / period_s;
        let agility = |swing: f64| Agility {
            acceleration: swing * omega * omega,
            lasts_s: 1.0 / omega,
        };
        let sway = agility(SWING.1 * distance_m);
        Self {
            time_s,
            x: Coordinate::at(pose.x, variances.position, sway),
            y: Coordinate::at(pose.y, variances.position, sway),
            heading: Coordinate::at(pose.theta, variances.heading, agility(SWING.0)),
        }
    }

    /// Takes a measured pose.
    #[must_use]
    pub(super) fn updated(mut self, pose: &swimmer_model::Pose<f64>, variances: Variances) -> Self {
        let before = self.heading.position();
        let near = before + wrapped_angle(pose.theta - before);
        self.x.measure(pose.x, variances.position);
        self.y.measure(pose.y, variances.position);
        self.heading.measure(near, variances.heading);
        // Headings stay within a turn of zero.
        let wrapped = wrapped_angle(self.heading.position());
        self.heading.shift(wrapped - self.heading.position());
        self
    }

    /// Distance \[m\] and angle \[rad\] of a pose from the estimate.
    pub(super) fn off(&self, pose: &swimmer_model::Pose<f64>) -> [f64; 2] {
        [
            (pose.x - self.x.position()).hypot(pose.y - self.y.position()),
            wrapped_angle(pose.theta - self.heading.position()),
        ]
    }

    pub(super) fn after(&self, time_s: f64) -> Self {
        let dt = (time_s - self.time_s).max(0.0);
        Self {
            time_s: time_s.max(self.time_s),
            x: self.x.after(dt),
            y: self.y.after(dt),
            heading: self.heading.after(dt),
        }
    }

    pub(super) fn pose(&self) -> Pose {
        Pose {
            time_s: self.time_s,
            x_m: self.x.position(),
            y_m: self.y.position(),
            heading_rad: self.heading.position(),
            sigma_position_m: self.x.variance().max(self.y.variance()).sqrt(),
            sigma_heading_rad: self.heading.variance().sqrt(),
        }
    }
}
