//! Legendre polynomials on \[−1, 1\]: orthonormal, with their derivatives, and Gauss points to integrate them.

/// Writes the orthonormal Legendre polynomials `p_k = √(k + ½) P_k` at `s`, and their derivatives, for as many k as the
/// slices hold.
pub(super) fn polynomials(s: f64, values: &mut [f64], slopes: &mut [f64]) {
    // P and P′ by their three-term recurrences.
    let (mut before, mut here) = ([0.0, 0.0], [1.0, 0.0]);
    for (k, (value, slope)) in values.iter_mut().zip(slopes).enumerate() {
        let k = k as f64;
        let norm = (k + 0.5).sqrt();
        *value = here[0] * norm;
        *slope = here[1] * norm;
        let next = [
            ((2.0 * k + 1.0) * s * here[0] - k * before[0]) / (k + 1.0),
            (2.0 * k + 1.0) * here[0] + before[1],
        ];
        before = here;
        here = next;
    }
}

/// The Gauss–Legendre rule with `count` points: nodes in rising order, and weights.
pub(crate) fn gauss(count: usize) -> (Vec<f64>, Vec<f64>) {
    let n = count as f64;
    let node = |i: usize| {
        // Tricomi's guess, then Newton: it converges quadratically, four rounds reach rounding.
        let mut s = -((i as f64 + 0.75) / (n + 0.5) * std::f64::consts::PI).cos();
        let mut slope = 1.0;
        for _ in 0..6 {
            let values = legendre(count, s);
            let (value, below) = (values[count], values[count - 1]);
            slope = n * (below - s * value) / (1.0 - s * s);
            s -= value / slope;
        }
        (s, 2.0 / ((1.0 - s * s) * slope * slope))
    };
    (0..count).map(node).unzip()
}

/// `P_0` … `P_most` at `x`.
pub(crate) fn legendre(most: usize, x: f64) -> Vec<f64> {
    let mut values = Vec::with_capacity(most + 1);
    let (mut below, mut here) = (0.0, 1.0);
    for k in 0..=most {
        values.push(here);
        let k = k as f64;
        (below, here) = (here, ((2.0 * k + 1.0) * x * here - k * below) / (k + 1.0));
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_integrates_polynomials_and_finds_them_orthonormal() {
        let (nodes, weights) = gauss(20);
        let mut gram = [[0.0; 12]; 12];
        for (s, w) in nodes.iter().zip(&weights) {
            let (mut p, mut d) = ([0.0; 12], [0.0; 12]);
            polynomials(*s, &mut p, &mut d);
            for j in 0..12 {
                for k in 0..12 {
                    gram[j][k] += w * p[j] * p[k];
                }
            }
        }
        for (j, row) in gram.iter().enumerate() {
            for (k, value) in row.iter().enumerate() {
                let want = f64::from(u8::from(j == k));
                assert!((value - want).abs() < 1e-13, "{j} {k} {value}");
            }
        }
    }

    #[test]
    fn slopes_are_derivatives() {
        let at = |s: f64| {
            let (mut p, mut d) = ([0.0; 9], [0.0; 9]);
            polynomials(s, &mut p, &mut d);
            (p, d)
        };
        let h = 1e-5;
        let ((above, _), (below, _), (_, slopes)) = (at(0.3 + h), at(0.3 - h), at(0.3));
        for k in 0..9 {
            let numeric = (above[k] - below[k]) / (2.0 * h);
            assert!((numeric - slopes[k]).abs() < 1e-6, "{k}");
        }
    }
}
