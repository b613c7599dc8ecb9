//! The paper's single shooting: backwards from φ₁ = −φ₂, with exact sensitivities (section V.B).
//!
//! Unknown are φ₁, x, θ and E at `t_f`. They fix κ = E/x, the control `u₁ = u₂ = −√(E/ΣW)` and with it all costates; what must
//! come out at `t₀` is φ₁ = φ₂, x = 0, θ = 0 and λ₁ + λ₂ = 0. Units: L = `c_t` = `t_f` = 1.

use nalgebra::{Matrix4, Vector2, Vector4};
use swimmer_model::Model;

use super::flow::{Flow, State, Variation, advance, body_momentum};

/// φ₁, x, θ and E at `t_f`.
pub(crate) type Final = Vector4<f64>;

/// Conditions are met to this.
pub(crate) const RESIDUAL: f64 = 1e-10;
/// What the iteration tries for, as far as rounding lets it.
const BEYOND: f64 = 1e-12;
const TOLERANCE: f64 = 2e-14;
const MOST_STEPS: usize = 30;

/// A quarter that meets the conditions at both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Polished {
    pub(crate) at_end: Final,
    /// Max-norm of the conditions at `t₀`.
    pub(crate) residual: f64,
}

impl Polished {
    /// `ξ = x_f²/E_f` in these units.
    pub(crate) fn efficiency(&self) -> f64 {
        self.at_end[1] * self.at_end[1] / self.at_end[3]
    }
}

/// The last state that belongs to final values; none where they belong to no gait.
pub(crate) fn last_state<'a>(model: &'a Model<f64>, at_end: &Final) -> Option<(Flow<'a>, State)> {
    let (flow, state, _) = ending(model, at_end)?;
    Some((flow, state))
}

/// The last state with its derivatives in the four final values, and those of κ.
#[expect(
    clippy::type_complexity,
    reason = "used in one place, where it is taken apart"
)]
fn ending<'a>(
    model: &'a Model<f64>,
    at_end: &Final,
) -> Option<(Flow<'a>, State, [(State, f64); 4])> {
    let [[phi, x, theta, energy]] = at_end.data.0;
    if !(energy > 0.0 && x != 0.0 && at_end.iter().all(|value| value.is_finite())) {
        return None;
    }
    let kappa = energy / x;
    let flow = Flow {
        model,
        kappa,
        sense: -1.0,
    };
    let first = model.first_derivatives(&Vector2::new(phi, -phi));
    let over_drag = 1.0 / model.side_drag();
    let w = first.power * over_drag;
    let d_power = (first.d_power[0] - first.d_power[1]) * over_drag;
    let d_connection = first.d_connection[0] - first.d_connection[1];
    let total = w.sum();
    let control = Vector2::repeat(-(energy / total).sqrt());
    let m = body_momentum(theta, 0.0);
    let pushed = w * control / kappa;
    let costate = pushed - first.connection.transpose() * m;
    let state = [phi, -phi, theta, 0.0, costate.x, costate.y, x];
    let with = |state: [f64; 4], costate: Vector2<f64>, d_kappa: f64| {
        let [phi1, phi2, theta, x] = state;
        ([phi1, phi2, theta, 0.0, costate.x, costate.y, x], d_kappa)
    };
    let by_phi = (d_power * control - pushed * (0.5 * kappa * d_power.sum() / total)) / kappa
        - d_connection.transpose() * m;
    let turned = nalgebra::Vector3::new(m.y, -m.x, 0.0);
    let columns = [
        with([1.0, -1.0, 0.0, 0.0], by_phi, 0.0),
        with([0.0, 0.0, 0.0, 1.0], pushed / x, -kappa / x),
        with(
            [0.0, 0.0, 1.0, 0.0],
            -first.connection.transpose() * turned,
            0.0,
        ),
        with([0.0; 4], pushed * (-0.5 / energy), 1.0 / x),
    ];
    Some((flow, state, columns))
}

/// The conditions at `t₀` and their derivatives in the final values.
fn conditions(model: &Model<f64>, at_end: &Final) -> Option<(Vector4<f64>, Matrix4<f64>)> {
    let (flow, state, columns) = ending(model, at_end)?;
    let variation = Variation {
        flow,
        d_kappa: columns.map(|(_, d_kappa)| d_kappa),
    };
    let mut all = [0.0; 35];
    all[..7].copy_from_slice(&state);
    for (into, (column, _)) in all[7..].chunks_exact_mut(7).zip(&columns) {
        into.copy_from_slice(column);
    }
    let reached = advance(&variation, all, 1.0, TOLERANCE)?;
    let lambda3 = 2.0 / flow.kappa;
    let condition = |z: &[f64]| Vector4::new(z[0] - z[1], z[6], z[2], lambda3 * (z[4] + z[5]));
    let residual = condition(&reached[..7]);
    let mut jacobian = Matrix4::zeros();
    for (j, (column, d_kappa)) in reached[7..]
        .chunks_exact(7)
        .zip(&variation.d_kappa)
        .enumerate()
    {
        let mut slope = condition(column);
        slope[3] -= residual[3] * d_kappa / flow.kappa;
        jacobian.set_column(j, &slope);
    }
    residual
        .iter()
        .chain(jacobian.iter())
        .all(|value| value.is_finite())
        .then_some((residual, jacobian))
}

/// Damped Newton's method; none where it does not reach [`RESIDUAL`].
pub(crate) fn polish(model: &Model<f64>, start: &Final) -> Option<Polished> {
    let mut here = *start;
    let (mut residual, mut jacobian) = conditions(model, &here)?;
    for _ in 0..MOST_STEPS {
        let step = jacobian.lu().solve(&-residual)?;
        let mut share = 1.0;
        let mut next = None;
        while share > 1e-3 {
            let trial = here + step * share;
            if let Some((reached, slope)) = conditions(model, &trial)
                && reached.norm() < (1.0 - 1e-4 * share) * residual.norm()
            {
                next = Some((trial, reached, slope));
                break;
            }
            share *= 0.5;
        }
        let Some((trial, reached, slope)) = next else {
            break;
        };
        (here, residual, jacobian) = (trial, reached, slope);
        // Beyond the goal: what is left of the conditions becomes a kink where the quarter meets its image.
        if residual.amax() < BEYOND {
            break;
        }
    }
    let residual = residual.amax();
    (residual <= RESIDUAL).then_some(Polished {
        at_end: here,
        residual,
    })
}
