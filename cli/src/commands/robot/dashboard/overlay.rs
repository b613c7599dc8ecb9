//! Tracked poses over the predicted ones, in the frame of the prediction.

use std::collections::VecDeque;

use nalgebra::Vector2;
use swimmer_model::Pose;

use super::TRAIL;

/// Tracked path. The first pose of a play lies on the predicted one: the prediction does not know where in the tank it began.
#[derive(Debug, Default)]
pub(super) struct Overlay {
    /// From the tank's frame to that of the prediction; `None` until a pose of this play is tracked.
    to_prediction: Option<Pose<f64>>,
    trail: VecDeque<Vector2<f64>>,
    /// The latest pose in the frame of the prediction.
    latest: Option<Pose<f64>>,
}

impl Overlay {
    /// A new play begins.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Takes a tracked pose in the tank's frame, with the one that is predicted at the time.
    pub(super) fn push(&mut self, tracked: &Pose<f64>, predicted: &Pose<f64>) {
        let to_prediction = *self
            .to_prediction
            .get_or_insert_with(|| *predicted * tracked.inverse());
        let pose = to_prediction * *tracked;
        if self.trail.len() == TRAIL {
            self.trail.pop_front();
        }
        self.trail.push_back(pose.position());
        self.latest = Some(pose);
    }

    /// Positions of this play.
    pub(super) fn trail(&self) -> impl Iterator<Item = Vector2<f64>> {
        self.trail.iter().copied()
    }

    /// The latest pose.
    pub(super) fn latest(&self) -> Option<Pose<f64>> {
        self.latest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tracked_motion_is_shown_in_the_frame_of_the_prediction() {
        let (start, predicted) = (Pose::new(0.4, -0.2, 2.0), Pose::new(0.01, 0.0, 0.1));
        let motion = Pose::new(0.03, 0.004, -0.2);
        let mut overlay = Overlay::default();
        assert!(overlay.latest().is_none());
        overlay.push(&start, &predicted);
        let first = overlay.latest().unwrap();
        assert!((first.position() - predicted.position()).norm() < 1e-12);
        // The prediction goes elsewhere; the tracked motion is the robot's own.
        overlay.push(&(start * motion), &Pose::new(0.5, 0.5, 0.0));
        let (last, expected) = (overlay.latest().unwrap(), predicted * motion);
        assert!((last.position() - expected.position()).norm() < 1e-12);
        assert!((last.theta - expected.theta).abs() < 1e-12);
        assert_eq!(overlay.trail().count(), 2);
        overlay.clear();
        assert_eq!(overlay.trail().count(), 0);
    }
}
