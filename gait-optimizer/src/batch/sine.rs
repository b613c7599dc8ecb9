//! Branch-free sine and cosine for vectorised loops, equal to those of `libm` to the last digit.

use swimmer_model::Scalar;

/// Sines and cosines of some angles \[rad\].
#[inline(always)]
pub(super) fn sines_and_cosines<const N: usize>(angles: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    let mut all_plain = true;
    for k in 0..N {
        let (sin, cos, plain) = sin_cos(angles[k]);
        (sines[k], cosines[k]) = (sin, cos);
        all_plain &= plain;
    }
    if !all_plain {
        for k in 0..N {
            if !sin_cos(angles[k]).2 {
                (sines[k], cosines[k]) = Scalar::sin_cos(angles[k]);
            }
        }
    }
    (sines, cosines)
}

/// Sine and cosine by the reduction and the polynomials of `libm` (FreeBSD's `e_rem_pio2`, `k_sin` and `k_cos`). The flag is `false` if
/// the angle is too large or too near a multiple of π/4, for which `libm` takes another path.
#[inline(always)]
#[allow(clippy::excessive_precision)] // as in their source
fn sin_cos(angle: f64) -> (f64, f64, bool) {
    const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 · 2⁵²
    const HALF_PI: f64 = 1.570_796_326_734_125_614_17; // its first 33 bits
    const REST: f64 = 6.077_100_506_506_192_249_32e-11;
    const S1: f64 = -1.666_666_666_666_663_243_48e-1;
    let quarters = angle * std::f64::consts::FRAC_2_PI;
    let shifted = quarters + ROUND;
    let quadrant = shifted.to_bits();
    let n = shifted - ROUND;
    let off = (quarters - n).abs();
    let plain = angle.abs() < 32.0 && off > 1e-3 && off < 0.4999;
    let r = angle - n * HALF_PI;
    let w = n * REST;
    let x = r - w;
    let y = (r - x) - w;

    let z = x * x;
    let zz = z * z;
    let p = 8.333_333_333_322_489_461_24e-3
        + z * (-1.984_126_982_985_794_931_34e-4 + z * 2.755_731_370_707_006_767_89e-6)
        + z * zz * (-2.505_076_025_340_686_341_95e-8 + z * 1.589_690_995_211_550_102_21e-10);
    let v = z * x;
    // Without a reduction `libm` sums in another order.
    let within = x + v * (S1 + z * p);
    let reduced = x - ((z * (0.5 * y - v * p) - y) - v * S1);
    let sin = if n == 0.0 { within } else { reduced };
    let p = z
        * (4.166_666_666_666_660_190_37e-2
            + z * (-1.388_888_888_887_410_957_49e-3 + z * 2.480_158_728_947_672_941_78e-5))
        + zz * zz
            * (-2.755_731_435_139_066_330_35e-7
                + z * (2.087_572_321_298_174_827_90e-9 + z * -1.135_964_755_778_819_482_65e-11));
    let half = 0.5 * z;
    let w = 1.0 - half;
    let cos = w + (((1.0 - w) - half) + (z * p - x * y));

    // Bit mask instead of a branch: all ones if sine and cosine are exchanged.
    let swap = (quadrant & 1).wrapping_neg();
    let exchange = (sin.to_bits() ^ cos.to_bits()) & swap;
    let s = f64::from_bits(sin.to_bits() ^ exchange);
    let c = f64::from_bits(cos.to_bits() ^ exchange);
    let sign = |flips: u64, value: f64| f64::from_bits(value.to_bits() ^ (flips << 63));
    (
        sign((quadrant >> 1) & 1, s),
        sign(((quadrant + 1) >> 1) & 1, c),
        plain,
    )
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]
        #[test]
        fn they_are_libms(angle in -40.0..40.0_f64, eighths in -40..40, off in -1e-3..1e-3_f64) {
            let near = f64::from(eighths) * std::f64::consts::FRAC_PI_4 + off;
            let angles = [angle, 0.2 * angle, near, 1e-6 * near, 1e-9 * off];
            let (sines, cosines) = sines_and_cosines(&angles);
            for ((angle, sin), cos) in angles.into_iter().zip(sines).zip(cosines) {
                let (s, c) = Scalar::sin_cos(angle);
                prop_assert_eq!((sin.to_bits(), cos.to_bits()), (s.to_bits(), c.to_bits()), "{}", angle);
            }
        }
    }

    #[test]
    fn they_are_libms_where_it_is_special() {
        let quarter = std::f64::consts::FRAC_PI_4;
        let angles = [
            0.0,
            -0.0,
            1e-300,
            quarter,
            -quarter,
            2.0 * quarter,
            1e5,
            f64::INFINITY,
        ];
        let (sines, cosines) = sines_and_cosines(&angles);
        for ((angle, sin), cos) in angles.into_iter().zip(sines).zip(cosines) {
            let (s, c) = Scalar::sin_cos(angle);
            assert_eq!(sin.to_bits() << 1, s.to_bits() << 1, "{angle}");
            assert_eq!(cos.to_bits() << 1, c.to_bits() << 1, "{angle}");
            assert!(
                s.is_nan() || sin.is_sign_negative() == s.is_sign_negative(),
                "{angle}"
            );
        }
    }
}
