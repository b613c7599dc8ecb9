//! Dynamics of an arc of greatest displacement, along the zero of the height or along a bound.

use nalgebra::{Matrix2, Matrix3x2, Vector2};
use swimmer_model::Model;

use super::{Height, Momentum, Motion};
use crate::runge_kutta::System;

/// State along an arc: φ₁, φ₂, x, y, θ (lengths over L) and the power length ∫√P of the arc.
pub(crate) type State = [f64; 6];

/// Joint angles of a state.
pub(crate) fn shape(z: &[f64]) -> Vector2<f64> {
    match z {
        [phi1, phi2, ..] => Vector2::new(*phi1, *phi2),
        _ => Vector2::zeros(),
    }
}

/// x, y, θ of a state.
pub(crate) fn pose(z: &[f64]) -> [f64; 3] {
    match z {
        [_, _, x, y, theta, ..] => [*x, *y, *theta],
        _ => [0.0; 3],
    }
}

/// Rates of x, y, θ and of the power length for a direction in the plane of joint angles.
pub(crate) fn pose_rates(
    connection: &Matrix3x2<f64>,
    power: &Matrix2<f64>,
    theta: f64,
    direction: &Vector2<f64>,
) -> [f64; 4] {
    let body = connection * direction;
    let (sin, cos) = theta.sin_cos();
    let speed = direction.dot(&(power * direction)).max(0.0).sqrt();
    [
        cos * body.x - sin * body.y,
        sin * body.x + cos * body.y,
        body.z,
        speed,
    ]
}

/// Dynamics of an arc with |u| = 1 (paper, constraint on the rate of the shape).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Flow<'a> {
    /// Model of the swimmer with L = 1.
    pub(crate) model: &'a Model<f64>,
    pub(crate) momentum: Momentum,
    pub(crate) motion: Motion,
}

impl Flow<'_> {
    /// Height at a state.
    pub(crate) fn height(&self, z: &State) -> Height {
        self.momentum.evaluate(self.model, &shape(z), &pose(z)).0
    }

    /// Unit direction of motion at a state.
    pub(crate) fn direction(&self, z: &State) -> Vector2<f64> {
        match self.motion {
            Motion::Singular => self.height(z).singular_direction(),
            Motion::Along(track) => track.direction(&shape(z)),
        }
    }
}

impl System<6> for Flow<'_> {
    fn rate(&self, z: &State) -> State {
        let phi = shape(z);
        let (direction, connection, power) = match self.motion {
            Motion::Singular => {
                let (height, connection, power) =
                    self.momentum.evaluate(self.model, &phi, &pose(z));
                (height.singular_direction(), connection, power)
            }
            Motion::Along(track) => {
                let (connection, power) = self.model.connection_and_power(&phi);
                (track.direction(&phi), connection, power)
            }
        };
        let [x, y, theta, speed] = pose_rates(&connection, &power, z[4], &direction);
        [direction.x, direction.y, x, y, theta, speed]
    }
}
