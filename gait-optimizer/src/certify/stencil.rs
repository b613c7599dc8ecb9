//! Weights of the polynomial through a few neighbouring samples: its value, slope, bend, and integral.
//!
//! A certificate needs the slopes of a curve that is known by its samples only. Polynomials of two degrees give each slope twice,
//! and their difference estimates the uncertainty of the sampling.

use swimmer_model::GaussLegendre;

/// Samples that the finer polynomial takes.
pub(super) const MOST: usize = 9;
/// Difference in samples between the finer and the coarser polynomial.
pub(super) const FEWER: usize = 2;

/// One weight for each sample of a stencil; those beyond the stencil are zero.
pub(super) type Weights = [f64; MOST];

/// Weights of value, slope and bend, the first `ORDERS` of them, at `at`, of the polynomial through the samples at `places` (at
/// most [`MOST`]).
///
/// B. Fornberg, *Generation of finite difference formulas on arbitrarily spaced grids*, Math. Comp. 51 (1988).
pub(super) fn derivatives<const ORDERS: usize>(places: &[f64], at: f64) -> [Weights; ORDERS] {
    let mut weights = [[0.0; MOST]; ORDERS];
    let (mut product, mut ahead) = (1.0, places.first().map_or(0.0, |first| first - at));
    weights[0][0] = 1.0;
    for (i, &place) in places.iter().enumerate().take(MOST).skip(1) {
        let mut new_product = 1.0;
        let behind = ahead;
        ahead = place - at;
        for (j, &other) in places.iter().enumerate().take(i) {
            let apart = place - other;
            let closer = apart.recip();
            new_product *= apart;
            if j + 1 == i {
                for k in (1..ORDERS).rev() {
                    weights[k][i] = product
                        * (k as f64 * weights[k - 1][i - 1] - behind * weights[k][i - 1])
                        / new_product;
                }
                weights[0][i] = -product * behind * weights[0][i - 1] / new_product;
            }
            for k in (1..ORDERS).rev() {
                weights[k][j] = (ahead * weights[k][j] - k as f64 * weights[k - 1][j]) * closer;
            }
            weights[0][j] *= ahead * closer;
        }
        product = new_product;
    }
    weights
}

/// Integral of the same polynomial from one place to another, exactly.
pub(super) fn integral(places: &[f64], from: f64, to: f64) -> Weights {
    // Gauss–Legendre with five points is exact to degree nine.
    type Rule = GaussLegendre<5>;
    let (middle, half) = (f64::midpoint(from, to), 0.5 * (to - from));
    let mut sum = [0.0; MOST];
    for (place, weight) in Rule::NODES.into_iter().zip(Rule::WEIGHTS) {
        let [value] = derivatives(places, middle + half * place);
        for (total, part) in sum.iter_mut().zip(value) {
            *total += half * weight * part;
        }
    }
    sum
}

/// First sample and number of samples of the stencil around the stretch `from..=to`, within `0..count`, with `fewer` samples less
/// than the finer polynomial takes.
pub(super) fn around(from: usize, to: usize, count: usize, fewer: usize) -> (usize, usize) {
    let width = (MOST.min(count).saturating_sub(fewer)).max(2).min(count);
    let beside = width.saturating_sub(to + 1 - from) / 2;
    (
        from.saturating_sub(beside).min(count.saturating_sub(width)),
        width,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Degree eight goes through nine samples, wherever they lie.
    #[test]
    fn polynomials_are_met_exactly() {
        let places: Vec<f64> = (0..9).map(|i| (f64::from(i) / 8.0).powf(1.3)).collect();
        let value = |x: f64| x.powi(8) - 2.0 * x.powi(3) + 0.3;
        let samples: Vec<f64> = places.iter().map(|&x| value(x)).collect();
        let weigh =
            |weights: &Weights| -> f64 { weights.iter().zip(&samples).map(|(w, s)| w * s).sum() };
        for at in [0.0, 0.4, 1.0] {
            let [zeroth, first, second] = derivatives(&places, at);
            assert!((weigh(&zeroth) - value(at)).abs() < 1e-12);
            assert!((weigh(&first) - (8.0 * at.powi(7) - 6.0 * at * at)).abs() < 1e-10);
            assert!((weigh(&second) - (56.0 * at.powi(6) - 12.0 * at)).abs() < 1e-8);
        }
        let antiderivative = |x: f64| x.powi(9) / 9.0 - 0.5 * x.powi(4) + 0.3 * x;
        let expected = antiderivative(0.9) - antiderivative(0.2);
        assert!((weigh(&integral(&places, 0.2, 0.9)) - expected).abs() < 1e-13);
    }

    #[test]
    fn stencils_stay_within_their_piece() {
        assert_eq!(around(0, 0, 20, 0), (0, 9));
        assert_eq!(around(10, 10, 20, 0), (6, 9));
        assert_eq!(around(10, 11, 20, 0), (7, 9));
        assert_eq!(around(19, 19, 20, 0), (11, 9));
        assert_eq!(around(2, 3, 4, 0), (0, 4));
        assert_eq!(around(10, 10, 20, FEWER), (7, 7));
        assert_eq!(around(1, 2, 4, FEWER), (1, 2));
    }
}
