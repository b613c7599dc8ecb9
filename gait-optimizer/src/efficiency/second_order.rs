//! The second-order test of an efficiency extremal: is it a local maximum, and not only stationary?
//!
//! The conditions at `t_f` leave five parameters: φ₁ = −φ₂, x, θ, E there, and ν = λ₁ = λ₂. The extremals that they send
//! backwards cover the states (φ₁, φ₂, x, θ, E) once as long as the determinant of ∂(state)/∂(parameters) keeps its sign;
//! then the best J = x²/E that can still be reached is a smooth function of state and time, with the costates for a
//! gradient, and the extremal is better than every other curve from its own first shape. Where the determinant vanishes
//! inside the quarter there is a conjugate (focal) point, and the extremal is not even a weak maximum. What is left is the
//! first shape itself: along φ₁ = φ₂ the function must be concave, d²J/dφ₀² < 0. Both conditions are necessary, and together
//! sufficient, among the gaits with the two symmetries.

use nalgebra::{Matrix5, Vector2, Vector3, Vector5};

use super::flow::{Flow, State, Variation, body_momentum, inverse, steps};

/// What the test found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SecondOrder {
    /// Smallest determinant of the sensitivities inside the quarter, over the time to the end and the value there: 1 at `t_f`,
    /// and positive throughout where no point is conjugate.
    pub(crate) least_determinant: f64,
    /// d² ln J/dφ₀² at the first shape.
    pub(crate) bend_at_start: f64,
}

/// Columns for φ₁ = −φ₂, x, θ, E and ν beside the state.
const ALL: usize = 42;
/// Determinants are looked at this often, at least, in units of `t_f`.
const LOOK: f64 = 1.0 / 48.0;

/// Tests the extremal that ends in this state; none where it cannot be followed.
pub(crate) fn test(flow: Flow<'_>, last: &State) -> Option<SecondOrder> {
    let (kappa, x) = (flow.kappa, last[6]);
    let energy = kappa * x;
    let mut all = [0.0; ALL];
    all[..7].copy_from_slice(last);
    let columns: [State; 5] = [
        [1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        [0.0; 7],
        [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0],
    ];
    for (into, column) in all[7..].chunks_exact_mut(7).zip(&columns) {
        into.copy_from_slice(column);
    }
    let d_kappa = [0.0, -kappa / x, 0.0, 1.0 / x, 0.0];
    // E(t) = E_f − (1 − t) P, and P is the same along each extremal.
    let (_, slopes) = flow.power_slopes(last);
    let mut d_power = [0.0; 5];
    for ((d_power, column), d_kappa) in d_power.iter_mut().zip(&columns).zip(&d_kappa) {
        let by_state: f64 = slopes.iter().zip(&column[..6]).map(|(s, c)| s * c).sum();
        *d_power = by_state + slopes[6] * d_kappa;
    }
    let d_energy = [0.0, 0.0, 0.0, 1.0, 0.0];
    let sensitivities = |z: &[f64; ALL], gone: f64| {
        Matrix5::from_fn(|row, column| {
            let of = |i: usize| z.get(7 * (column + 1) + i).copied().unwrap_or(f64::NAN);
            match row {
                0 | 1 => of(row),
                2 => of(6),
                3 => of(2),
                _ => d_energy[column] - gone * d_power[column],
            }
        })
    };
    // Just before t_f only ν still moves the shape, by −(1 − t) κ W⁻¹ (1, 1); the other columns are what they are at t_f.
    let at_end = {
        let (_, w) = flow.connection_and_power(&Vector2::new(last[0], last[1]));
        let push = inverse(&w) * Vector2::repeat(-kappa);
        let mut matrix = sensitivities(&all, 0.0);
        matrix.set_column(4, &Vector5::new(push.x, push.y, 0.0, 0.0, 0.0));
        matrix.determinant()
    };
    let variation = Variation { flow, d_kappa };
    let mut least = f64::INFINITY;
    let mut gone = 0.0;
    let reached = steps(&variation, all, 1.0, 1e-9, LOOK, |z, length| {
        gone += length;
        let determinant = sensitivities(z, gone).determinant();
        least = least.min(determinant / (gone * at_end));
    })?;
    // Which parameters move the first shape along φ₁ = φ₂ and leave x, θ and E there; how λ₁ + λ₂ answers.
    let shift = sensitivities(&reached, 1.0)
        .lu()
        .solve(&Vector5::new(1.0, 1.0, 0.0, 0.0, 0.0))?;
    let answer: f64 = reached[7..]
        .chunks_exact(7)
        .zip(shift.iter())
        .map(|(column, share)| share * (column[4] + column[5]))
        .sum();
    let (lambda3, worth) = (2.0 / kappa, x * x / energy);
    let found = SecondOrder {
        least_determinant: least,
        bend_at_start: lambda3 * answer / worth,
    };
    found.least_determinant.is_finite().then_some(found)
}

/// The smallest eigenvalue of `−λ₅W` along the way over the largest: the strict Legendre condition.
pub(crate) fn legendre(flow: &Flow<'_>, states: &[State]) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for state in states {
        let (_, w) = flow.connection_and_power(&Vector2::new(state[0], state[1]));
        let eigenvalues = w.symmetric_eigenvalues();
        least = least.min(eigenvalues.min());
        most = most.max(eigenvalues.max());
    }
    least / most
}

/// λ₁/λ₃ and λ₂/λ₃ as `H_u = 0` asks them to be where the curve moves with `control`.
pub(crate) fn costate(flow: &Flow<'_>, state: &State, control: &Vector2<f64>) -> Vector2<f64> {
    let (a, w) = flow.connection_and_power(&Vector2::new(state[0], state[1]));
    let momentum: Vector3<f64> = body_momentum(state[2], state[3]);
    w * control / flow.kappa - a.transpose() * momentum
}
