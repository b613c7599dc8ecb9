//! Dead reckoning on board: integrates the model along the commanded angles in f32. One evaluation of the local connection per
//! tick, at the midpoint (second order), because trigonometry is slow without an FPU.

use nalgebra::Vector2;
use swimmer_model::{Model, Pose};

/// Integrator of the swimmer's pose.
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

    /// Resets the pose to the origin.
    pub(crate) fn reset(&mut self) {
        self.pose = Pose::identity();
    }

    /// Integrates one step between two shapes.
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
