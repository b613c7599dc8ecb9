//! Student's t and Fisher's F with bounded work.
//!
//! Quantiles come from a bisection on the survival function. The inverse of the incomplete beta function in `statrs` (AS 109)
//! iterates until it converges, and for some degrees of freedom it never does.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Degrees of freedom from which on Student's t is the normal distribution to seven digits.
const NORMAL_FROM: f64 = 1e7;
/// Steps that bracket a quantile, and steps that halve the bracket down to rounding.
const DOUBLINGS: usize = 64;
const HALVINGS: usize = 60;

/// Half width of the central interval of this level, in standard errors. Returns `None` if the level is no share or the degrees
/// of freedom are not positive.
pub fn quantile(freedom: f64, level: f64) -> Option<f64> {
    let tail = (1.0 - level) / 2.0;
    if !(tail > 0.0 && tail < 0.5 && freedom > 0.0) {
        return None;
    }
    if freedom >= NORMAL_FROM {
        return Some(-Normal::standard().inverse_cdf(tail));
    }
    let student = StudentsT::new(0.0, 1.0, freedom).ok()?;
    let mut high = 1.0;
    for _ in 0..DOUBLINGS {
        if student.sf(high) <= tail {
            break;
        }
        high *= 2.0;
    }
    let mut low = 0.0;
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if student.sf(middle) > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(f64::midpoint(low, high))
}

/// Probability of a deviation of this many standard errors or more, to either side; NaN if either argument is NaN.
pub fn two_sided(freedom: f64, deviation: f64) -> f64 {
    if freedom.is_nan() || deviation.is_nan() {
        return f64::NAN;
    }
    let size = deviation.abs();
    if freedom >= NORMAL_FROM {
        return 2.0 * Normal::standard().sf(size);
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |student| 2.0 * student.sf(size))
}

/// Quantile of Fisher's F with two degrees of freedom over `freedom`, in closed form: P(F > f) = (1 + 2f/ν)^(−ν/2).
pub(crate) fn fisher_of_two(freedom: f64, level: f64) -> f64 {
    freedom / 2.0 * (-2.0 / freedom * (-level).ln_1p()).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::FisherSnedecor;

    /// Printed tables of Student's t, 95 % and 99.9 %.
    #[test]
    fn quantiles_are_the_printed_ones() {
        for (freedom, level, printed) in [
            (1.0, 0.95, 12.706_204_736),
            (2.0, 0.95, 4.302_652_730),
            (5.0, 0.95, 2.570_581_836),
            (30.0, 0.95, 2.042_272_456),
            (1e9, 0.95, 1.959_963_985),
            (1.0, 0.999, 636.619_249),
            (10.0, 0.999, 4.586_893_859),
        ] {
            let found = quantile(freedom, level).unwrap();
            assert!((found / printed - 1.0).abs() < 1e-8, "{freedom} {found}");
            let chance = two_sided(freedom, found);
            assert!((chance / (1.0 - level) - 1.0).abs() < 1e-9, "{chance}");
        }
    }

    /// Degrees of freedom of every size, as Satterthwaite's formula brings them: each quantile is found and none is skipped.
    #[test]
    fn every_degree_of_freedom_has_a_quantile() {
        let mut before = f64::INFINITY;
        for step in 0..4000 {
            let freedom = 1.013_f64.powi(step) * 0.9;
            let here = quantile(freedom, 0.95).unwrap();
            assert!(
                here <= before * (1.0 + 1e-9) && here > 1.9599,
                "{freedom} {here} {before}"
            );
            before = here;
        }
        assert_eq!(quantile(0.0, 0.95), None);
        assert_eq!(quantile(f64::NAN, 0.95), None);
        assert_eq!(quantile(3.0, 1.0), None);
        assert!(two_sided(3.0, f64::NAN).is_nan());
        assert!(two_sided(3.0, f64::INFINITY).abs() < 1e-300);
    }

    #[test]
    fn fisher_s_quantile_has_its_tail() {
        for freedom in [1.0, 4.5, 200.0, 1e6] {
            let found = fisher_of_two(freedom, 0.95);
            let chance = FisherSnedecor::new(2.0, freedom).unwrap().sf(found);
            assert!((chance - 0.05).abs() < 1e-8, "{freedom} {found} {chance}");
        }
    }
}
