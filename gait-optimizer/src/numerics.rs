//! Where something changes along a line: halving, and roots by regula falsi.

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

/// A root between two places with values of different sign: regula falsi (Illinois), now and then a halving, until a value is below
/// `small`. None where a value is not known, or at a jump.
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
