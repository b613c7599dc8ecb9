//! The golden section: for what has one minimum and no derivative worth the name.

/// Minimum of a function of one hump in an interval, and its value there: each look narrows it to 0.618 of what it was.
pub(crate) fn golden(mut a: f64, mut b: f64, looks: usize, f: impl Fn(f64) -> f64) -> (f64, f64) {
    let ratio = 0.618_033_988_749_894_9;
    let (mut c, mut d) = (b - ratio * (b - a), a + ratio * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    for _ in 0..looks {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - ratio * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + ratio * (b - a);
            fd = f(d);
        }
    }
    if fc < fd { (c, fc) } else { (d, fd) }
}

#[cfg(test)]
mod tests {
    use super::golden;

    #[test]
    fn the_minimum_is_found() {
        let (x, value) = golden(-1.0, 4.0, 40, |x| (x - 1.3).abs() + 2.0);
        assert!((x - 1.3).abs() < 1e-7 && (value - 2.0).abs() < 1e-7);
    }
}
