//! Gains and drift of the robot, estimated from cycle to cycle by a Kalman filter.

use nalgebra::{Matrix3, Matrix3x5, Matrix5, Vector2, Vector3, Vector5};
use swimmer_model::{Pose, wrapped_angle};

/// Deviations before the first cycle: of each gain, and of the drift \[m/s\].
const PRIOR_GAIN: f64 = 0.1;
const PRIOR_DRIFT: f64 = 3e-4;
/// Drift changes from cycle to cycle by about this \[m/s\].
const DRIFT_CHANGE: f64 = 1e-5;
/// Errors of a cycle that gains do not take up: share of its motion, and position \[m\] and heading \[rad\] by dead bands.
const UNMODELLED: f64 = 0.03;
const BY_DEAD_BAND: [f64; 2] = [4e-4, 3e-3];
/// Gains stay within this of 1.
const LARGEST_CORRECTION: f64 = 0.4;

/// Estimated gains of the three kinds of gait (forward, left, turn), and drift in the tank's frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Learning {
    state: Vector5<f64>,
    covariance: Matrix5<f64>,
}

/// One tracked cycle between two rests.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TrackedCycle {
    /// Number of the kind of gait.
    pub(crate) kind: usize,
    /// Measured poses at the two rests.
    pub(crate) before: Pose<f64>,
    pub(crate) after: Pose<f64>,
    /// Time between them \[s\].
    pub(crate) seconds: f64,
    /// Deviations of their difference \[m, rad\].
    pub(crate) sigmas: [f64; 2],
}

impl Default for Learning {
    fn default() -> Self {
        let [gain, drift] = [PRIOR_GAIN.powi(2), PRIOR_DRIFT.powi(2)];
        Self {
            state: Vector5::new(1.0, 1.0, 1.0, 0.0, 0.0),
            covariance: Matrix5::from_diagonal(&Vector5::new(gain, gain, gain, drift, drift)),
        }
    }
}

impl Learning {
    pub(crate) fn gains(&self) -> [f64; 3] {
        [0, 1, 2]
            .map(|kind| self.state[kind].clamp(1.0 - LARGEST_CORRECTION, 1.0 + LARGEST_CORRECTION))
    }

    /// Drift \[m/s\].
    pub(crate) fn drift(&self) -> Vector2<f64> {
        Vector2::new(self.state[3], self.state[4])
    }

    /// Learns from a cycle. `net`: its predicted motion at a gain.
    pub(crate) fn learn(&mut self, cycle: &TrackedCycle, net: impl Fn(f64) -> Pose<f64>) {
        const STEP: f64 = 1e-3;
        let gain = self.state[cycle.kind];
        let led = |gain: f64| cycle.before * net(gain);
        let predicted = led(gain);
        let drift = self.drift() * cycle.seconds;
        let innovation = Vector3::new(
            cycle.after.x - predicted.x - drift.x,
            cycle.after.y - predicted.y - drift.y,
            wrapped_angle(cycle.after.theta - predicted.theta),
        );
        let (above, below) = (led(gain + STEP), led(gain - STEP));
        let mut slopes = Matrix3x5::zeros();
        slopes[(0, cycle.kind)] = (above.x - below.x) / (2.0 * STEP);
        slopes[(1, cycle.kind)] = (above.y - below.y) / (2.0 * STEP);
        slopes[(2, cycle.kind)] = (above.theta - below.theta) / (2.0 * STEP);
        slopes[(0, 3)] = cycle.seconds;
        slopes[(1, 4)] = cycle.seconds;
        for index in [3, 4] {
            self.covariance[(index, index)] += DRIFT_CHANGE.powi(2);
        }
        let motion = net(gain);
        let [sigma, turn_sigma] = cycle.sigmas;
        let along = (UNMODELLED * motion.position().norm()).hypot(BY_DEAD_BAND[0]);
        let turn = (UNMODELLED * motion.theta).hypot(BY_DEAD_BAND[1]);
        let along = sigma.powi(2) + along.powi(2);
        let turn = turn_sigma.powi(2) + turn.powi(2);
        let noise = Matrix3::from_diagonal(&Vector3::new(along, along, turn));
        let Some(inverse) = (slopes * self.covariance * slopes.transpose() + noise).try_inverse()
        else {
            return;
        };
        let factor = self.covariance * slopes.transpose() * inverse;
        self.state += factor * innovation;
        self.covariance = (Matrix5::identity() - factor * slopes) * self.covariance;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A robot that does 5 % less forward, 3 % more in a turn, and drifts: all of it is learned from twelve cycles.
    #[test]
    fn gains_and_drift_are_learned() {
        let truth = [0.95, 1.0, 1.03];
        let drift = Vector2::new(1.5e-4, -1e-4);
        let net = |kind: usize, gain: f64| match kind {
            0 => Pose::new(0.025 * gain, 0.0, 0.0),
            _ => Pose::new(0.003 * gain, 0.0, 0.08 * gain),
        };
        let mut learning = Learning::default();
        let mut before = Pose::identity();
        for cycle in 0..24 {
            let kind = if cycle % 4 == 3 { 0 } else { 2 };
            let seconds = 5.0;
            let mut after = before * net(kind, truth[kind]);
            after.x += drift.x * seconds;
            after.y += drift.y * seconds;
            let tracked = TrackedCycle {
                kind,
                before,
                after,
                seconds,
                sigmas: [1e-4, 1e-3],
            };
            learning.learn(&tracked, |gain| net(kind, gain));
            before = after;
        }
        let gains = learning.gains();
        assert!((gains[0] - truth[0]).abs() < 0.01, "{gains:?}");
        assert!((gains[2] - truth[2]).abs() < 0.01, "{gains:?}");
        assert!(
            (learning.drift() - drift).norm() < 3e-5,
            "{:?}",
            learning.drift()
        );
    }
}
