//! From any symmetric curve to the start of a shooting method: its poses at constant power, and the costates that follow.
//!
//! With the pose known along a curve so are the costates (physics: `λ₄ = λ₃ (y − y_f)` holds by itself, λ₁ and λ₂ follow from
//! `H_u = 0`), up to how far the curve is from an extremal.

use nalgebra::Vector2;
use swimmer_model::Model;

use super::flow::{State, advance, body_momentum};
use crate::displacement::height::pose_rates;

/// States at chosen instants of the quarter, in units of `t_f`, and κ.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Start {
    /// From 0 to 1.
    pub(crate) times: Vec<f64>,
    pub(crate) states: Vec<State>,
    pub(crate) kappa: f64,
}

impl Start {
    /// Of a curve over s ∈ (0, π/2) from φ₁ = φ₂ to φ₁ = −φ₂, cut into `segments` of equal length in s. None where it cannot
    /// be integrated, or swims nowhere.
    pub(crate) fn of_curve(
        model: &Model<f64>,
        curve: &impl Fn(f64) -> (Vector2<f64>, Vector2<f64>),
        segments: usize,
    ) -> Option<Self> {
        // φ₁ and φ₂ lead, so that a curve that runs away is given up; s itself, then x, y, θ, ∫√P.
        let rates = |z: &[f64; 7]| {
            let (phi, rate) = curve(z[2]);
            let (a, w) = model.connection_and_power(&phi);
            let [x, y, theta, speed] = pose_rates(&a, &w, z[5], &rate);
            [rate.x, rate.y, 1.0, x, y, theta, speed]
        };
        let first = curve(0.0).0;
        let mut here = [first.x, first.y, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut poses = vec![here];
        let part = std::f64::consts::FRAC_PI_2 / segments as f64;
        for _ in 0..segments {
            here = advance(&rates, here, part, 1e-10)?;
            poses.push(here);
        }
        // Over c_t, the power of a quarter that lasts 1.
        let root_power = here[6] / model.side_drag().sqrt();
        let kappa = root_power * root_power / here[3];
        if !(kappa.is_finite() && kappa != 0.0) {
            return None;
        }
        let states = poses
            .iter()
            .map(|pose| {
                let (phi, rate) = curve(pose[2]);
                let (a, w) = model.connection_and_power(&phi);
                let speed = rate.dot(&(w * rate)).sqrt() / model.side_drag().sqrt();
                let control = rate * (root_power / speed);
                let y = pose[4] - here[4];
                let costate = w * control / (model.side_drag() * kappa)
                    - a.transpose() * body_momentum(pose[5], y);
                [phi.x, phi.y, pose[5], y, costate.x, costate.y, pose[3]]
            })
            .collect();
        Some(Self {
            times: poses.iter().map(|pose| pose[6] / here[6]).collect(),
            states,
            kappa,
        })
    }
}
