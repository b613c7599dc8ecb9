//! Flow maps of the reduced equations with their exact Jacobians.

use swimmer_model::Model;

use super::equations::{Motion, RATES, STATE, State, linear, rate};
use crate::runge_kutta::{Point, StepControl, advance};

/// Number of entries of a state with q and their sensitivities.
const WIDE: usize = RATES + RATES * STATE;

/// End of an integrated piece with its sensitivities.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mapped {
    /// State at the end.
    pub(crate) end: State,
    /// Change of q.
    pub(crate) gain: f64,
    /// Rates of state and q at the end: derivatives with respect to the length.
    pub(crate) rate: [f64; RATES],
    /// Derivatives of the end and of the gain with respect to the start.
    pub(crate) by_start: [[f64; STATE]; RATES],
}

/// Local tolerance of results.
pub(crate) const FINE: f64 = 1e-13;

/// Rates of the state, of q and of their sensitivities.
fn variational(model: &Model<f64>, motion: &Motion, z: &[f64; WIDE]) -> [f64; WIDE] {
    let local = linear(model, motion, &state(z));
    let mut out = [0.0; WIDE];
    let (rates, slopes) = out.split_at_mut(RATES);
    rates.copy_from_slice(&local.rate);
    let (_, sensitivity) = z.split_at(RATES);
    for (row, by) in slopes.chunks_exact_mut(STATE).zip(&local.by_state) {
        for (factor, from) in by.iter().zip(sensitivity.chunks_exact(STATE)) {
            for (value, part) in row.iter_mut().zip(from) {
                *value += factor * part;
            }
        }
    }
    out
}

fn state(z: &[f64]) -> State {
    std::array::from_fn(|i| z.get(i).copied().unwrap_or(f64::NAN))
}

/// Integrates over a length with the Jacobian, to a local `tolerance`. Returns `None` if the steps become too small. A negative
/// length integrates backwards.
pub(crate) fn mapped(
    model: &Model<f64>,
    motion: &Motion,
    start: &State,
    length: f64,
    tolerance: f64,
) -> Option<Mapped> {
    let mut z = [0.0; WIDE];
    for (i, value) in start.iter().enumerate() {
        z[i] = *value;
        z[RATES + i * STATE + i] = 1.0;
    }
    let sign = if length < 0.0 { -1.0 } else { 1.0 };
    let system = |z: &[f64; WIDE]| variational(model, motion, z).map(|value| sign * value);
    let control = StepControl::to(tolerance);
    let end = advance(&system, Point::new(&system, z), length.abs(), control)?;
    let mut by_start = [[0.0; STATE]; RATES];
    for (row, from) in by_start.iter_mut().zip(end.z[RATES..].chunks_exact(STATE)) {
        row.copy_from_slice(from);
    }
    Some(Mapped {
        end: state(&end.z),
        gain: end.z[STATE],
        rate: std::array::from_fn(|i| sign * end.rate[i]),
        by_start,
    })
}

/// Integrates over a length ≥ 0 without the Jacobian. Returns the state and the change of q.
pub(crate) fn flowed(
    model: &Model<f64>,
    motion: &Motion,
    start: &State,
    length: f64,
) -> Option<(State, f64)> {
    let system = |z: &[f64; RATES]| rate(model, motion, &state(z));
    let mut z = [0.0; RATES];
    for (value, from) in z.iter_mut().zip(start) {
        *value = *from;
    }
    let end = advance(
        &system,
        Point::new(&system, z),
        length,
        StepControl::to(FINE),
    )?;
    Some((state(&end.z), end.z[STATE]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Swimmer;

    #[test]
    fn the_jacobian_is_the_derivative_of_the_flow() {
        let model = Model::new(&Swimmer::<f64>::purcell()).unwrap();
        let z = [1.1, 0.9, 2.2, 30.0, -4.0, 1.0];
        for length in [0.3, -0.2] {
            let exact = mapped(&model, &Motion::Free, &z, length, FINE).unwrap();
            let at = |column: usize, by: f64| {
                let mut moved = z;
                moved[column] += by;
                mapped(&model, &Motion::Free, &moved, length, FINE).unwrap()
            };
            for column in 0..STATE {
                let h = 1e-5;
                let (up, down) = (at(column, h), at(column, -h));
                for row in 0..STATE {
                    let numeric = (up.end[row] - down.end[row]) / (2.0 * h);
                    let found = exact.by_start[row][column];
                    assert!((numeric - found).abs() < 1e-6 * (1.0 + found.abs()));
                }
                let numeric = (up.gain - down.gain) / (2.0 * h);
                let found = exact.by_start[STATE][column];
                assert!((numeric - found).abs() < 1e-6 * (1.0 + found.abs()));
            }
            let h = 1e-5;
            let longer = mapped(&model, &Motion::Free, &z, length + h, FINE).unwrap();
            let shorter = mapped(&model, &Motion::Free, &z, length - h, FINE).unwrap();
            for row in 0..STATE {
                let numeric = (longer.end[row] - shorter.end[row]) / (2.0 * h);
                assert!((numeric - exact.rate[row]).abs() < 1e-6 * (1.0 + numeric.abs()));
            }
        }
        let there = mapped(&model, &Motion::Free, &z, 0.3, FINE).unwrap();
        let (plain, gain) = flowed(&model, &Motion::Free, &z, 0.3).unwrap();
        assert!((gain - there.gain).abs() < 1e-11);
        for (a, b) in plain.iter().zip(&there.end) {
            assert!((a - b).abs() < 1e-10);
        }
    }
}
