//! The paper's own way to an efficiency gait (section V.B): one shot backwards from φ₁ = −φ₂, with its costates, and Jacobi's
//! test along it. By Runge–Kutta steps and differences, so that it shares nothing with the optimiser but A and W.
//!
//! Units: L = `c_t` = `t_f` = 1. Over λ₃ = 2/κ with κ = E/x the control is u = κ W⁻¹ (λ + Aᵀm), m = (cos θ, −sin θ, `y − y_f`).

use nalgebra::{Matrix4, Matrix5, Vector2, Vector3, Vector4, Vector5};
use swimmer_model::Model;

/// φ₁, φ₂, x, θ, `y − y_f`, λ₁/λ₃, λ₂/λ₃.
type State = [f64; 7];

const STEPS: usize = 768;
/// Jacobi's determinant is looked at this often.
const LOOKS: usize = 48;

/// Result of the paper's method for a gait that it starts from.
#[derive(Debug)]
pub(crate) struct Shot {
    /// φ₁, x, θ and E at `t_f`.
    pub(crate) at_end: Vector4<f64>,
    /// Max-norm of φ₁ − φ₂, x, θ and λ₁ + λ₂ at `t₀`.
    pub(crate) residual: f64,
    /// The least determinant of ∂(φ₁, φ₂, x, θ, E)/∂(φ₁, x, θ, E, λ₁ at `t_f`) over `1 − t` and its value near `t_f`.
    pub(crate) least_determinant: f64,
    /// d² ln (x²/E)/dφ² where the first shape moves along φ₁ = φ₂.
    pub(crate) bend: f64,
}

/// Newton's method from the final values of a gait. Returns `None` if it does not converge.
pub(crate) fn shoot(model: &Model<f64>, start: Vector4<f64>) -> Option<Shot> {
    let mut at_end = start;
    for _ in 0..12 {
        let residual = conditions(model, &at_end);
        if residual.amax() < 1e-10 {
            let (least_determinant, bend) = jacobi(model, &at_end)?;
            return Some(Shot {
                at_end,
                residual: residual.amax(),
                least_determinant,
                bend,
            });
        }
        let mut slopes = Matrix4::zeros();
        for j in 0..4 {
            let h = 1e-6 * at_end[j].abs();
            let moved = |by: f64| {
                let mut moved = at_end;
                moved[j] += by;
                conditions(model, &moved)
            };
            slopes.set_column(j, &((moved(h) - moved(-h)) / (2.0 * h)));
        }
        at_end -= slopes.lu().solve(&residual)?;
    }
    None
}

fn conditions(model: &Model<f64>, at_end: &Vector4<f64>) -> Vector4<f64> {
    let first = backwards(model, &at_end.push(0.0)).pop().unwrap().1;
    Vector4::new(first[0] - first[1], first[2], first[3], first[5] + first[6])
}

/// The states backwards from φ₁, x, θ, E at `t_f` and what λ₁ = λ₂ has there beyond the optimum's, with 1 − t, and E.
fn backwards(model: &Model<f64>, from: &Vector5<f64>) -> Vec<(f64, State, f64)> {
    let [[phi, x, theta, energy, beyond]] = from.data.0;
    let kappa = energy / x;
    let (a, w) = model.connection_and_power(&Vector2::new(phi, -phi));
    let w = w / model.side_drag();
    let control = Vector2::repeat(-(energy / w.sum()).sqrt());
    let costate = w * control / kappa - a.transpose() * body_momentum(theta, 0.0);
    let mut here = [
        phi,
        -phi,
        x,
        theta,
        0.0,
        costate.x + beyond,
        costate.y + beyond,
    ];
    let power = moment(model, kappa, &here).1;
    let length = 1.0 / STEPS as f64;
    let mut states = Vec::new();
    for step in 0..=STEPS {
        let gone = step as f64 * length;
        states.push((gone, here, energy - gone * power));
        let rate = |z: &State| moment(model, kappa, z).0;
        let moved = |rate: &State, by: f64| std::array::from_fn(|i| here[i] - by * rate[i]);
        let first = rate(&here);
        let second = rate(&moved(&first, 0.5 * length));
        let third = rate(&moved(&second, 0.5 * length));
        let fourth = rate(&moved(&third, length));
        let mean = std::array::from_fn(|i| {
            (first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i]) / 6.0
        });
        here = moved(&mean, length);
    }
    states
}

fn body_momentum(theta: f64, y: f64) -> Vector3<f64> {
    Vector3::new(theta.cos(), -theta.sin(), y)
}

/// Rates and power at a state.
fn moment(model: &Model<f64>, kappa: f64, z: &State) -> (State, f64) {
    let first = model.first_derivatives(&Vector2::new(z[0], z[1]));
    let m = body_momentum(z[3], z[4]);
    let over = 1.0 / model.side_drag();
    let pushed = Vector2::new(z[5], z[6]) + first.connection.transpose() * m;
    let u = first.power.try_inverse().unwrap() * pushed * (kappa / over);
    let body = first.connection * u;
    let (sin, cos) = z[3].sin_cos();
    let costate = |k: usize| {
        0.5 * over * u.dot(&(first.d_power[k] * u)) / kappa - m.dot(&(first.d_connection[k] * u))
    };
    let rates = [
        u.x,
        u.y,
        cos * body.x - sin * body.y,
        body.z,
        sin * body.x + cos * body.y,
        costate(0),
        costate(1),
    ];
    (rates, over * u.dot(&(first.power * u)))
}

/// The extremals that end on φ₁ = −φ₂ cover the states once while the determinant keeps its sign; then the best that can
/// still be reached is a smooth function, which must be concave along φ₁ = φ₂.
fn jacobi(model: &Model<f64>, at_end: &Vector4<f64>) -> Option<(f64, f64)> {
    let base = at_end.push(0.0);
    let (x, energy) = (at_end[1].abs(), at_end[3]);
    let scale = Vector5::new(1.0, x, 1.0, energy, x / energy);
    let columns: Vec<_> = (0..5)
        .map(|j| {
            let h = 1e-6 * scale[j];
            let moved = |by: f64| {
                let mut moved = base;
                moved[j] += by;
                backwards(model, &moved)
            };
            (moved(h), moved(-h), 2.0 * h)
        })
        .collect();
    let slopes = |step: usize| {
        Matrix5::from_fn(|row, j| {
            let (up, down, width) = &columns[j];
            let value = |(_, z, energy): &(f64, State, f64)| [z[0], z[1], z[2], z[3], *energy][row];
            (value(&up[step]) - value(&down[step])) / width
        })
    };
    let look = STEPS / LOOKS;
    let over_time = |step: usize| slopes(step).determinant() * STEPS as f64 / step as f64;
    let near_end = over_time(1);
    let least = (1..=LOOKS)
        .map(|k| over_time(k * look) / near_end)
        .fold(f64::INFINITY, f64::min);
    let shift = slopes(STEPS)
        .lu()
        .solve(&Vector5::new(1.0, 1.0, 0.0, 0.0, 0.0))?;
    let answer: f64 = columns
        .iter()
        .zip(shift.iter())
        .map(|((up, down, width), share)| {
            let sum = |states: &[(f64, State, f64)]| states[STEPS].1[5] + states[STEPS].1[6];
            share * (sum(up) - sum(down)) / width
        })
        .sum();
    Some((least, 2.0 * answer / at_end[1]))
}
