//! Efficiency gaits as symmetric truncated Fourier series of any order (paper, Appendix C).

mod ascent;
mod objective;

use nalgebra::DMatrix;
use swimmer_model::Model;

pub(crate) use ascent::{FARTHEST, Maximum, climb};
pub(crate) use objective::{Expansion, Objective, Value, series};

/// Number of panels per quarter for circles and ellipses.
const PANELS: usize = 11;
/// First and last amplitude \[rad\] and number of the circles that are evaluated first.
const AMPLITUDES: (f64, f64, usize) = (0.3, 4.6, 44);

/// Number of lengths of each axis of the ellipses.
const ELLIPSES: usize = 18;

/// Amplitudes at which circles have a local maximum of X/S with this sign of X, in rising order.
pub(crate) fn best_circles(model: &Model<f64>, sign: f64) -> Vec<f64> {
    let mut objective = Objective::new(model, 1, PANELS);
    let (low, high, count) = AMPLITUDES;
    let amplitude = |i: usize| low + (high - low) * i as f64 / (count - 1) as f64;
    let worth: Vec<f64> = (0..count)
        .map(|i| sign * objective.value(&[amplitude(i); 2]).ratio())
        .collect();
    let is_top = |[before, here, after]: [f64; 3]| here > 0.0 && here >= before && here > after;
    let places = worth.array_windows().zip(1..);
    let tops = places.filter_map(|(three, i)| is_top(*three).then_some(i));
    tops.map(amplitude).collect()
}

/// Half axes at which ellipses have a local maximum of X/S with this sign of X, in order of size, and the largest |X|/S. Used for
/// swimmers whose circles have no maximum.
pub(crate) fn best_ellipses(model: &Model<f64>, sign: f64) -> (Vec<[f64; 2]>, f64) {
    let mut objective = Objective::new(model, 1, PANELS);
    let (low, high, _) = AMPLITUDES;
    let axis = |i: usize| low + (high - low) * i as f64 / (ELLIPSES - 1) as f64;
    let worth = DMatrix::from_fn(ELLIPSES, ELLIPSES, |i, j| {
        sign * objective.value(&[axis(i), axis(j)]).ratio()
    });
    let inner = || 1..ELLIPSES - 1;
    let places = inner().flat_map(|i| inner().map(move |j| (i, j)));
    let top = |&(i, j): &(usize, usize)| {
        let around = worth.view((i - 1, j - 1), (3, 3));
        worth[(i, j)] > 0.0 && around.iter().all(|other| worth[(i, j)] >= *other)
    };
    let found = places.filter(top).map(|(i, j)| [axis(i), axis(j)]);
    (found.collect(), worth.max().max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Swimmer;

    /// Gradient and Hessian agree with central differences.
    #[test]
    fn derivatives_are_exact() {
        let model = Model::new(&Swimmer::robot().of_unit_length()).unwrap();
        let here = [1.9, 1.4, 0.2, 0.3, -0.05, 0.08];
        let mut objective = Objective::new(&model, 3, 16);
        let expansion = objective.expansion(&here);
        let value = objective.value(&here);
        assert!((expansion.value.objective - value.objective).abs() < 1e-13);
        assert!((expansion.value.x - value.x).abs() < 1e-14);
        let h = 1e-5;
        for i in 0..here.len() {
            let mut moved = |h: f64| {
                let mut moved = here;
                moved[i] += h;
                objective.expansion(&moved)
            };
            let (up, down) = (moved(h), moved(-h));
            let slope = (up.value.objective - down.value.objective) / (2.0 * h);
            assert!((slope - expansion.gradient[i]).abs() < 1e-8, "{i}");
            for j in 0..here.len() {
                let bend = (up.gradient[j] - down.gradient[j]) / (2.0 * h);
                assert!((bend - expansion.hessian[(i, j)]).abs() < 1e-7, "{i} {j}");
            }
        }
    }
}
