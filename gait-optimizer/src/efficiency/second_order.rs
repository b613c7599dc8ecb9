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
    let (least_determinant, at_start, reached) = sweep(flow, last, 1.0)?;
    // Which parameters move the first shape along φ₁ = φ₂ and leave x, θ and E there; how λ₁ + λ₂ answers.
    let shift = at_start
        .lu()
        .solve(&Vector5::new(1.0, 1.0, 0.0, 0.0, 0.0))?;
    let answer: f64 = reached[7..]
        .chunks_exact(7)
        .zip(shift.iter())
        .map(|(column, share)| share * (column[4] + column[5]))
        .sum();
    // J = x/κ and λ₃ = 2/κ.
    let bend_at_start = 2.0 * answer / last[6];
    let all = least_determinant.is_finite() && bend_at_start.is_finite();
    all.then_some(SecondOrder {
        least_determinant,
        bend_at_start,
    })
}

/// Follows the extremal with its neighbours back over `duration`: the least determinant, the sensitivities of φ₁, φ₂, x, θ, E
/// where that ends, and the state with its columns there.
fn sweep(flow: Flow<'_>, last: &State, duration: f64) -> Option<(f64, Matrix5<f64>, [f64; ALL])> {
    let (kappa, x) = (flow.kappa, last[6]);
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
    let reached = steps(&variation, all, duration, 1e-9, LOOK, |z, length| {
        gone += length;
        let determinant = sensitivities(z, gone).determinant();
        least = least.min(determinant / (gone * at_end));
    })?;
    Some((least, sensitivities(&reached, duration), reached))
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

#[cfg(test)]
mod tests {
    use super::super::fourier::{Ends, Grid, Objective, climb, raised, series};
    use super::super::multiple;
    use super::super::shooting::{Final, Polished, last_state, polish};
    use super::super::start::Start;
    use super::*;
    use swimmer_model::{Model, Swimmer};

    /// The extremal that multiple shooting finds from an ellipse.
    fn extremal(model: &Model<f64>, ellipse: [f64; 2]) -> Polished {
        let start = Start::of_curve(model, &|s| series(&ellipse, s), 8).unwrap();
        let solved = multiple::solve(model, &start).unwrap();
        let last = solved.states.last().unwrap();
        let flow = Flow {
            model,
            kappa: solved.kappa,
            sense: 1.0,
        };
        let energy = flow.moment(last).power;
        let at_end = Final::new(last[0], energy / solved.kappa, last[2], energy);
        polish(model, &at_end).unwrap()
    }

    fn tested(model: &Model<f64>, at_end: &Final) -> SecondOrder {
        let (flow, last) = last_state(model, at_end).unwrap();
        test(flow, &last).unwrap()
    }

    #[test]
    fn optima_pass() {
        let model = Model::new(&Swimmer::purcell().of_unit_length()).unwrap();
        let small = extremal(&model, [1.2, 1.2]).at_end;
        assert!((small[0].abs() - 0.840_201_02).abs() < 1e-8);
        assert!((small[2].abs() - 0.507_623_64).abs() < 1e-8);
        for ellipse in [[1.2, 1.2], [3.6, 3.6]] {
            let test = tested(&model, &extremal(&model, ellipse).at_end);
            assert!(
                test.least_determinant > 0.9 && test.bend_at_start < -1.0,
                "{test:?}"
            );
        }
    }

    /// An extremal of Purcell's swimmer that meets all first-order conditions and is no maximum: the test says so, and a
    /// Fourier series fitted to it (which knows no costates) climbs away from it.
    #[test]
    fn a_saddle_fails() {
        let model = Model::new(&Swimmer::purcell().of_unit_length()).unwrap();
        let saddle = extremal(&model, [1.6, 3.6]);
        assert!((saddle.efficiency() - 0.005_709_875_641).abs() < 1e-11);
        let test = tested(&model, &saddle.at_end);
        assert!(test.bend_at_start > 1.0, "{test:?}");

        let trace = super::super::trace::Trace::new(&model, &saddle.at_end, 64).unwrap();
        let shapes = trace.shapes();
        let order = 10;
        // By the trapezoidal rule over the quarter, which is spectral for these series.
        let coefficient = |n: usize, across: bool| {
            let k = (2 * n + 1) as f64;
            let sum: f64 = shapes
                .iter()
                .enumerate()
                .map(|(i, phi)| {
                    let s = std::f64::consts::FRAC_PI_2 * i as f64 / 64.0;
                    let end = if i == 0 || i == 64 { 0.5 } else { 1.0 };
                    let (along, over) = (phi.x + phi.y, phi.y - phi.x);
                    let value = if across {
                        over * (k * s).sin()
                    } else {
                        along * (k * s).cos()
                    };
                    end * value * std::f64::consts::FRAC_1_SQRT_2
                })
                .sum();
            2.0 * sum / 64.0
        };
        let fitted: Vec<f64> = (0..2 * order)
            .map(|i| coefficient(i % order, i >= order))
            .collect();
        let grid = Grid::new(64);
        let objective = Objective {
            model: &model,
            grid: &grid,
            gauge: 0.01,
        };
        let here = objective.value(&fitted);
        assert!((here.efficiency() / saddle.efficiency() - 1.0).abs() < 1e-5);
        let bends = objective.expansion(&fitted).hessian.symmetric_eigenvalues();
        assert!(bends.max() > 0.1, "{bends}");
        let ends = Ends {
            least_gain: 1e-12,
            farthest: 9.0,
        };
        let higher = climb(&objective, &raised(&fitted, order), ends).unwrap();
        assert!(higher.value.efficiency() > 1.5 * saddle.efficiency());
    }

    /// Run on beyond its quarter, an extremal meets a focal point in the end, as geodesics do: then the determinant changes
    /// its sign.
    #[test]
    fn too_long_an_extremal_has_a_focal_point() {
        let model = Model::new(&Swimmer::purcell().of_unit_length()).unwrap();
        let (flow, last) = last_state(&model, &extremal(&model, [1.2, 1.2]).at_end).unwrap();
        let least = |duration| sweep(flow, &last, duration).unwrap().0;
        assert!(least(1.0) > 0.9);
        assert!(least(4.0) < 0.0);
    }
}
