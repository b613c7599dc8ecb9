//! Where the model says the robot is: the commanded angles, swum on board in f32. One evaluation of the local
//! connection a tick, at the middle of the step (second order), because trigonometry is dear without floating point.

use nalgebra::Vector2;
use swimmer_model::{Model, Pose};

/// Adds up the swimmer's steps.
#[derive(Clone, Debug)]
pub(crate) struct Odometer {
    pose: Pose<f32>,
}

impl Odometer {
    pub(crate) fn new() -> Self {
        Self {
            pose: Pose::identity(),
        }
    }

    /// Starts again at the origin.
    pub(crate) fn reset(&mut self) {
        self.pose = Pose::identity();
    }

    /// The joints went from one shape to another.
    pub(crate) fn step(&mut self, model: &Model<f32>, from: [f32; 2], to: [f32; 2]) {
        let (from, to) = (Vector2::from(from), Vector2::from(to));
        let turn = to - from;
        if turn.x == 0.0 && turn.y == 0.0 {
            return;
        }
        let connection = model.local_connection(&((from + to) * 0.5));
        self.pose = self.pose * Pose::exp(&(connection * turn));
    }

    pub(crate) fn pose(&self) -> link_protocol::Pose {
        link_protocol::Pose {
            x: self.pose.x,
            y: self.pose.y,
            theta: self.pose.theta,
        }
    }
}
