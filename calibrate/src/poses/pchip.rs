//! The monotone cubic through knots (Fritsch and Carlson's, as SciPy's `PchipInterpolator`): between two knots it never leaves
//! their range, so that a gap is filled without overshoot.

/// The cubic's value at `at` through knots of rising `x`; beyond the knots, the nearest knot's value. `None` without knots.
pub(super) fn pchip(knots: &[(f64, f64)], at: f64) -> Option<f64> {
    let after = knots.partition_point(|(x, _)| *x <= at);
    let (Some(left), Some(right)) = (after.checked_sub(1), knots.get(after)) else {
        return knots.get(after.saturating_sub(1)).map(|(_, y)| *y);
    };
    let (x0, y0) = *knots.get(left)?;
    let (width, rise) = (right.0 - x0, right.1 - y0);
    let (d0, d1) = (slope(knots, left)?, slope(knots, after)?);
    let t = (at - x0) / width;
    // Hermite's form about the left knot.
    let bend = 3.0 * rise - width * (2.0 * d0 + d1);
    let twist = width * (d0 + d1) - 2.0 * rise;
    Some(y0 + t * (width * d0 + t * (bend + t * twist)))
}

/// The slope at a knot: the weighted harmonic mean of the slopes to both neighbours, or 0 where they differ in sign; at an end,
/// that of the parabola through three knots, held back where it would overshoot.
fn slope(knots: &[(f64, f64)], index: usize) -> Option<f64> {
    let secant = |i: usize| {
        let ((x0, y0), (x1, y1)) = (knots.get(i)?, knots.get(i + 1)?);
        Some((x1 - x0, (y1 - y0) / (x1 - x0)))
    };
    match (index.checked_sub(1).and_then(secant), secant(index)) {
        (Some((h0, m0)), Some((h1, m1))) => {
            if m0 * m1 <= 0.0 {
                return Some(0.0);
            }
            let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
            Some((w0 + w1) / (w0 / m0 + w1 / m1))
        }
        (None, Some(near)) => Some(secant(index + 1).map_or(near.1, |far| end_slope(near, far))),
        (Some(near), None) => {
            let far = index.checked_sub(2).and_then(secant);
            Some(far.map_or(near.1, |far| end_slope(near, far)))
        }
        (None, None) => None,
    }
}

fn end_slope((h0, m0): (f64, f64), (h1, m1): (f64, f64)) -> f64 {
    let slope = ((2.0 * h0 + h1) * m0 - h0 * m1) / (h0 + h1);
    if slope * m0 <= 0.0 {
        0.0
    } else if m0 * m1 <= 0.0 && slope.abs() > 3.0 * m0.abs() {
        3.0 * m0
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::pchip;

    #[test]
    fn the_values_are_scipys() {
        // scipy.interpolate.PchipInterpolator(x, y)(at)
        let many = [
            (0.0, 1.0),
            (0.01, 1.2),
            (0.02, 1.5),
            (0.09, 3.1),
            (0.10, 3.0),
            (0.13, 3.4),
        ];
        let few = [(0.0, 0.0), (1.0, 1.0), (3.0, 0.5)];
        let two = [(0.0, 0.0), (1.0, 2.0)];
        let of_many = [
            (0.0, 1.0),
            (0.004, 1.068_960_000_000_000_1),
            (0.03, 1.785_918_163_469_183_9),
            (0.055, 2.534_965_034_965_035),
            (0.085, 3.085_581_765_173_602_6),
            (0.097, 3.0216),
            (0.12, 3.159_259_259_259_259),
            (0.13, 3.4),
        ];
        let of_few = [
            (0.5, 0.677_083_333_333_333_4),
            (1.5, 0.992_187_5),
            (2.5, 0.789_062_5),
        ];
        let cases = [
            (&many[..], &of_many[..]),
            (&few, &of_few),
            (&two, &[(0.5, 1.0)]),
        ];
        for (knots, values) in cases {
            for (at, value) in values {
                let ours = pchip(knots, *at).unwrap();
                assert!((ours - value).abs() < 1e-14, "at {at}: {ours}, not {value}");
            }
        }
        assert_eq!(
            (pchip(&[], 1.0), pchip(&two, -1.0), pchip(&two, 5.0)),
            (None, Some(0.0), Some(2.0))
        );
    }
}
