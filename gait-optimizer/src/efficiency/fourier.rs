//! Efficiency gaits as symmetric truncated Fourier series of any order (paper, Appendix C).

mod ascent;
mod objective;

use swimmer_model::Model;

pub(crate) use ascent::{Ends, Maximum, climb};
pub(crate) use objective::{Objective, series};

/// Panels of the quarter that circles and ellipses are looked at in.
const PANELS: usize = 11;
/// Circles of these amplitudes are tried first \[rad\].
const AMPLITUDES: (f64, f64, usize) = (0.3, 4.6, 44);

/// Ellipses are tried with so many lengths of each axis.
const ELLIPSES: usize = 18;

/// Amplitudes where circles have a local maximum of X/S with this sign of X, in order.
pub(crate) fn best_circles(model: &Model<f64>, sign: f64) -> Vec<f64> {
    let mut objective = Objective::new(model, 1, PANELS);
    let (low, high, count) = AMPLITUDES;
    let amplitude = |i: usize| low + (high - low) * i as f64 / (count - 1) as f64;
    let worth: Vec<f64> = (0..count)
        .map(|i| {
            let value = objective.value(&[amplitude(i), amplitude(i)]);
            sign * value.x / value.power_length
        })
        .collect();
    (1..count - 1)
        .filter(|&i| {
            let at = |i: usize| worth.get(i).copied().unwrap_or(f64::NAN);
            at(i) > 0.0 && at(i) >= at(i - 1) && at(i) > at(i + 1)
        })
        .map(amplitude)
        .collect()
}

/// Half axes of ellipses where X/S with this sign of X has a local maximum over both, in order of size, and the largest
/// |X|/S seen: for swimmers whose circles have none.
pub(crate) fn best_ellipses(model: &Model<f64>, sign: f64) -> (Vec<[f64; 2]>, f64) {
    let mut objective = Objective::new(model, 1, PANELS);
    let (low, high, _) = AMPLITUDES;
    let axis = |i: usize| low + (high - low) * i as f64 / (ELLIPSES - 1) as f64;
    let worth: Vec<Vec<f64>> = (0..ELLIPSES)
        .map(|i| {
            (0..ELLIPSES)
                .map(|j| {
                    let value = objective.value(&[axis(i), axis(j)]);
                    sign * value.x / value.power_length
                })
                .collect()
        })
        .collect();
    let at = |i: usize, j: usize| worth.get(i).and_then(|row| row.get(j)).copied();
    let mut found = Vec::new();
    for i in 1..ELLIPSES - 1 {
        for j in 1..ELLIPSES - 1 {
            let here = at(i, j).unwrap_or(f64::NAN);
            let around = (i - 1..=i + 1).flat_map(|k| (j - 1..=j + 1).map(move |l| (k, l)));
            let top = around
                .filter(|&place| place != (i, j))
                .all(|(k, l)| at(k, l).is_some_and(|other| here >= other));
            if here > 0.0 && top {
                found.push([axis(i), axis(j)]);
            }
        }
    }
    let best = worth.iter().flatten().copied().fold(0.0, f64::max);
    (found, best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Swimmer;

    /// Gradient and Hessian against central differences.
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
