//! Scalar numerics: bisection, roots by regula falsi and Newton's method, damped steps (line search), and reductions that
//! propagate NaN.

/// The larger, and NaN rather than either.
pub(crate) fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

/// The smaller, and NaN rather than either.
pub(crate) fn lesser(a: f64, b: f64) -> f64 {
    -worse(-a, -b)
}

/// The ends of an interval halved so often, the lower one the last place where a property is seen to hold that is taken to hold at
/// its beginning and not at its end.
pub(crate) fn halved(
    [mut low, mut high]: [f64; 2],
    times: usize,
    mut holds: impl FnMut(f64) -> bool,
) -> [f64; 2] {
    for _ in 0..times {
        let middle = f64::midpoint(low, high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    [low, high]
}

/// A root between two places with values of different sign: regula falsi (Illinois) with occasional bisection, until a value is
/// below `small`. Returns `None` if a value is unknown, or at a jump.
pub(crate) fn root(
    [mut a, mut b]: [(f64, f64); 2],
    small: f64,
    value: impl Fn(f64) -> Option<f64>,
) -> Option<f64> {
    for step in 0..60 {
        let secant = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
        let at = if step % 6 == 5 || !secant.is_finite() {
            f64::midpoint(a.0, b.0)
        } else {
            secant
        };
        let here = value(at)?;
        if here.abs() < small {
            return Some(at);
        }
        if here.signum() * b.1.signum() < 0.0 {
            a = b;
        } else {
            a.1 *= 0.5;
        }
        b = (at, here);
    }
    None
}

/// First zero of a value that is positive at the start of a path: the point there and the path length up to it. Newton's method
/// from a `guess`, kept between the start and the `longest` length, until its next step would be shorter than `tolerance`.
///
/// `at` follows the path over a length; `value` is the value with its slope over the length. Returns `None` if `at` fails.
pub(crate) fn locate<P>(
    [guess, longest]: [f64; 2],
    tolerance: f64,
    at: impl Fn(f64) -> Option<P>,
    value: impl Fn(&P) -> (f64, f64),
) -> Option<(P, f64)> {
    let (mut low, mut high) = (0.0, longest);
    let mut length = guess;
    let mut there = at(length)?;
    for _ in 0..60 {
        let (here, slope) = value(&there);
        if here > 0.0 {
            low = length;
        } else {
            high = length;
        }
        let newton = length - here / slope;
        let within = newton > low && newton < high;
        let next = if within { newton } else { 0.5 * (low + high) };
        let step = (next - length).abs();
        if here == 0.0 || step < tolerance {
            break;
        }
        length = next;
        there = at(length)?;
        // The error after a Newton step is about the square of the step.
        if within && SQUARED * step * step < tolerance {
            break;
        }
    }
    Some((there, length))
}

/// Ratio allowed between the error after a Newton step and the square of the step.
const SQUARED: f64 = 100.0;

/// Position of a value among increasing places: the index of the place before it, and its fraction of the way to the next one.
pub(crate) fn between(places: &[f64], at: f64) -> (usize, f64) {
    let last = places.len().saturating_sub(1).max(1);
    let after = places.partition_point(|&place| place <= at).clamp(1, last);
    let place = |i: usize| places.get(i).copied().unwrap_or(0.0);
    let (from, to) = (place(after - 1), place(after));
    let share = if to > from {
        (at - from) / (to - from)
    } else {
        0.0
    };
    (after - 1, share)
}

/// Shares of a step to try, each half of the one before.
pub(crate) fn damped(most: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(most), |share| Some(0.5 * share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_hides_one_that_is_none() {
        for values in [[f64::NAN, 1.0], [1.0, f64::NAN]] {
            assert!(values.into_iter().fold(0.0, worse).is_nan());
            assert!(values.into_iter().fold(f64::INFINITY, lesser).is_nan());
        }
        assert!((worse(1.0, 2.0) - 2.0).abs() + (lesser(1.0, 2.0) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_root_is_found_and_a_jump_is_none() {
        let cubic = |at: f64| Some(at.powi(3) - 0.2);
        let found = root([(0.0, -0.2), (1.0, 0.8)], 1e-15, cubic).unwrap();
        assert!((found - 0.2_f64.cbrt()).abs() < 1e-14, "{found}");
        let jump = |at: f64| Some(if at < 0.3 { -1.0 } else { 1.0 });
        assert_eq!(root([(0.0, -1.0), (1.0, 1.0)], 1e-9, jump), None);
        let [low, high] = halved([0.0, 1.0], 40, |at| at < 0.3);
        assert!(low < 0.3 && 0.3 <= high && high - low < 1e-11);
    }
}
