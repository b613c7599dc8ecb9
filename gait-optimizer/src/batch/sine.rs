//! Sine and cosine as a loop wants them: without a branch.

/// Sine and cosine without a branch, by the reduction and the polynomials of `libm` (FreeBSD's `k_sin` and `k_cos`), so that they
/// are its digits but for angles next to a multiple of π/4.
#[inline(always)]
#[allow(clippy::excessive_precision)] // as in their source
pub(super) fn sin_cos(angle: f64) -> (f64, f64) {
    const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 · 2⁵²
    const HALF_PI: f64 = 1.570_796_326_734_125_614_17; // its first 33 bits
    const REST: f64 = 6.077_100_506_506_192_249_32e-11;
    let shifted = angle * std::f64::consts::FRAC_2_PI + ROUND;
    let quadrant = shifted.to_bits();
    let n = shifted - ROUND;
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
    let sin = x - ((z * (0.5 * y - v * p) - y) - v * -1.666_666_666_666_663_243_48e-1);
    let p = z
        * (4.166_666_666_666_660_190_37e-2
            + z * (-1.388_888_888_887_410_957_49e-3 + z * 2.480_158_728_947_672_941_78e-5))
        + zz * zz
            * (-2.755_731_435_139_066_330_35e-7
                + z * (2.087_572_321_298_174_827_90e-9 + z * -1.135_964_755_778_819_482_65e-11));
    let half = 0.5 * z;
    let w = 1.0 - half;
    let cos = w + (((1.0 - w) - half) + (z * p - x * y));

    // Bits, not branches: all ones where sine and cosine change places.
    let swap = (quadrant & 1).wrapping_neg();
    let exchange = (sin.to_bits() ^ cos.to_bits()) & swap;
    let s = f64::from_bits(sin.to_bits() ^ exchange);
    let c = f64::from_bits(cos.to_bits() ^ exchange);
    let sign = |flips: u64, value: f64| f64::from_bits(value.to_bits() ^ (flips << 63));
    (
        sign((quadrant >> 1) & 1, s),
        sign(((quadrant + 1) >> 1) & 1, c),
    )
}
