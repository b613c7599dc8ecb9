//! A polished extremal, sampled at equal times, and what can be seen along it.

use nalgebra::Vector2;
use swimmer_model::Model;

use super::flow::{Flow, State, advance};
use super::second_order::costate;
use super::shooting::{Final, last_state};

/// The quarter at equal times, which is at equal energies, from φ₁ = φ₂ to φ₁ = −φ₂.
#[derive(Debug, Clone)]
pub(crate) struct Trace<'a> {
    pub(crate) flow: Flow<'a>,
    pub(crate) states: Vec<State>,
    /// dΦ/dt at each state by the derivative of the trigonometric interpolant of the whole cycle: it knows nothing of the
    /// equations of motion, and sees a kink where the quarter meets its image.
    pub(crate) controls: Vec<Vector2<f64>>,
}

/// Largest deviations along the quarter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Deviations {
    /// `|H_u|` over λ₃ and L, λ₁ and λ₂ integrated, the control from the samples.
    pub(crate) h_u: f64,
    /// `|H/H₀ − 1|` with `H₀ = x_f²/(E_f t_f)`.
    pub(crate) hamiltonian: f64,
    /// (max − min)/mean of the power.
    pub(crate) power_variation: f64,
    /// |u₁ + u₂|/|u| at `t₀` and |u₁ − u₂|/|u| at `t_f`, the larger.
    pub(crate) rough_ends: f64,
}

const TOLERANCE: f64 = 1e-13;

impl<'a> Trace<'a> {
    /// Samples the quarter with these final values `intervals + 1` times; none where it cannot be followed.
    pub(crate) fn new(model: &'a Model<f64>, at_end: &Final, intervals: usize) -> Option<Self> {
        let (flow, mut here) = last_state(model, at_end)?;
        let mut states = vec![here];
        for _ in 0..intervals {
            here = advance(&flow, here, 1.0 / intervals as f64, TOLERANCE)?;
            states.push(here);
        }
        states.reverse();
        let mut trace = Self {
            flow,
            states,
            controls: Vec::new(),
        };
        trace.controls = trace.spectral_controls();
        Some(trace)
    }

    /// The shapes of the quarter.
    pub(crate) fn shapes(&self) -> Vec<Vector2<f64>> {
        let shape = |z: &State| Vector2::new(z[0], z[1]);
        self.states.iter().map(shape).collect()
    }

    fn spectral_controls(&self) -> Vec<Vector2<f64>> {
        let quarter = self.states.len() - 1;
        let half = 2 * quarter;
        // Half a cycle; the other half is its negative.
        let shapes: Vec<Vector2<f64>> = (0..half)
            .map(|i| {
                let image = if i <= quarter { i } else { half - i };
                let z = self.states.get(image).copied().unwrap_or([f64::NAN; 7]);
                if i <= quarter {
                    Vector2::new(z[0], z[1])
                } else {
                    Vector2::new(-z[1], -z[0])
                }
            })
            .collect();
        let at = |i: usize| {
            let shape = shapes.get(i % half).copied().unwrap_or_default();
            if (i / half).is_multiple_of(2) {
                shape
            } else {
                -shape
            }
        };
        let weights: Vec<f64> = (1..half)
            .map(|k| {
                let cotangent = 1.0 / (std::f64::consts::FRAC_PI_2 * k as f64 / half as f64).tan();
                // Half the alternating cotangent, times 2π for the cycle and over the four quarters.
                let sign = if k.is_multiple_of(2) { -1.0 } else { 1.0 };
                std::f64::consts::FRAC_PI_4 * sign * cotangent
            })
            .collect();
        (0..=quarter)
            .map(|i| {
                weights
                    .iter()
                    .zip(1..)
                    .map(|(weight, k)| (at(i + k) - at(i + 2 * half - k)) * *weight)
                    .sum()
            })
            .collect()
    }

    /// What deviates, against `x_f²/E_f` = `worth`.
    pub(crate) fn deviations(&self, worth: f64) -> Deviations {
        let flow = &self.flow;
        let mut deviations = Deviations {
            h_u: 0.0,
            hamiltonian: 0.0,
            power_variation: 0.0,
            rough_ends: f64::NAN,
        };
        let (mut least, mut most, mut sum) = (f64::INFINITY, 0.0_f64, 0.0);
        for (z, control) in self.states.iter().zip(&self.controls) {
            let h_u = costate(flow, z, control) - Vector2::new(z[4], z[5]);
            deviations.h_u = deviations.h_u.max(h_u.amax());
            let (a, w) = flow.connection_and_power(&Vector2::new(z[0], z[1]));
            let power = control.dot(&(w * control));
            let momentum = super::flow::body_momentum(z[2], z[3]);
            let hamiltonian = Vector2::new(z[4], z[5]).dot(control) + momentum.dot(&(a * control))
                - 0.5 * power / flow.kappa;
            let off = hamiltonian * (2.0 / flow.kappa) / worth - 1.0;
            deviations.hamiltonian = deviations.hamiltonian.max(off.abs());
            least = least.min(power);
            most = most.max(power);
            sum += power;
        }
        deviations.power_variation = (most - least) * self.states.len() as f64 / sum;
        if let (Some(first), Some(last)) = (self.controls.first(), self.controls.last()) {
            let start = (first.x + first.y).abs() / first.norm();
            let end = (last.x - last.y).abs() / last.norm();
            deviations.rough_ends = start.max(end);
        }
        deviations
    }
}
