//! Transcendental functions built only from operations that IEEE 754 defines exactly, so bakes are bit-identical on
//! every machine. The standard library's `powf`, `exp` and `sin` may differ between platforms.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

use glam::Vec2;

/// Returns `base` to the power of `exponent`, correctly rounded except for about one input in millions; 0 if `base` is
/// not positive.
pub fn power(base: f32, exponent: f32) -> f32 {
    power_f64(base, f64::from(exponent)) as f32
}

/// Same as [`power`] with an f64 exponent and result.
pub fn power_f64(base: f32, exponent: f64) -> f64 {
    if base > 0.0 { exp2(exponent * log2(f64::from(base))) } else { 0.0 }
}

/// Returns e to the power of `x`, rounded as in [`power`].
pub fn exp(x: f32) -> f32 {
    exp2(f64::from(x) * std::f64::consts::LOG2_E) as f32
}

/// Returns the natural logarithm of a positive normal number, rounded as in [`power`].
pub fn ln(x: f32) -> f32 {
    (log2(f64::from(x)) * std::f64::consts::LN_2) as f32
}

/// Fast approximation of exp(-x). Relative error is 1e-6 at x = 3 and 5e-3 at x = 16, where the value is below 2e-7.
pub fn fast_exp_neg(x: f32) -> f32 {
    let x = x * (1.0 / 32.0);
    let mut power = 1.0 / (1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x * (1.0 / 24.0)))));
    for _ in 0..5 {
        power *= power;
    }
    power
}

/// Returns (cos, sin) of an angle in radians, at most a few turns, rounded as in [`power`].
pub fn cos_sin(angle: f32) -> Vec2 {
    let angle = f64::from(angle);
    let quarters = (angle * FRAC_2_PI).round();
    let t = angle - quarters * FRAC_PI_2;
    // |t| < 0.786; the last term, t^18 / 18!, is already below the last bit.
    let series = |first: i32| {
        let step = |sum: f64, term: i32| 1.0 - sum * t * t / f64::from((2 * term + first - 1) * (2 * term + first));
        (1..10).rev().fold(1.0, step)
    };
    let cos = series(0) as f32;
    let sin = (series(1) * t) as f32;
    match (quarters as i64).rem_euclid(4) {
        0 => Vec2::new(cos, sin),
        1 => Vec2::new(-sin, cos),
        2 => Vec2::new(-cos, -sin),
        _ => Vec2::new(sin, -cos),
    }
}

/// Base-2 logarithm of a positive normal number.
fn log2(x: f64) -> f64 {
    const BIAS: i64 = 1023;
    // The mantissa is in 0.707 to 1.414, so logarithms of numbers near 1 keep their precision.
    let bits = x.to_bits() as i64;
    let half = i64::from(bits & ((1 << 52) - 1) > 0x6_a09e_667f_3bcd);
    let exponent = (bits >> 52) - BIAS + half;
    let mantissa = f64::from_bits((bits - (exponent << 52)) as u64);
    // ln m = 2 artanh s; |s| < 0.172, so s^23 is below the last bit.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let series = (0..11).rev().fold(0.0, |sum, term| sum * s * s + 1.0 / f64::from(2 * term + 1));
    exponent as f64 + 2.0 * s * series * std::f64::consts::LOG2_E
}

fn exp2(x: f64) -> f64 {
    let x = x.clamp(-1000.0, 1000.0);
    let whole = x.round();
    let t = (x - whole) * std::f64::consts::LN_2;
    // |t| < 0.347; the first omitted term, t^15 / 15!, is below the last bit.
    let series = (1..15).rev().fold(1.0, |sum, term| 1.0 + sum * t / f64::from(term));
    series * f64::from_bits(((whole as i64 + 1023) << 52) as u64)
}

/// Tests, and a hash that tests of bakes share.
#[cfg(test)]
pub mod tests {
    use super::*;

    /// FNV-1a hash, for comparing a bake with the expected hash in a test.
    pub fn hash(samples: impl IntoIterator<Item = impl Into<u64>>) -> u64 {
        let step = |hash: u64, sample: u64| (hash ^ sample).wrapping_mul(0x0100_0000_01b3);
        samples.into_iter().map(Into::into).fold(0xcbf2_9ce4_8422_2325, step)
    }

    #[test]
    fn powers_match_the_standard_library() {
        for step in 1..4000 {
            let base = 2.0_f32.powf(step as f32 / 100.0 - 20.0);
            for exponent in [2.4_f32, 1.0 / 2.4, 1.0 / 3.0, -1.5] {
                let expected = f64::from(base).powf(f64::from(exponent));
                let off = power_f64(base, f64::from(exponent)) / expected - 1.0;
                assert!(off.abs() < 1.0e-13, "{base}^{exponent}: {off:e}");
            }
        }
        assert_eq!((power(1.0, 2.4), power(0.0, 2.4), power(-1.0, 2.4)), (1.0, 0.0, 0.0));
        assert_eq!((power(f32::NAN, 2.4), power(1.0e-30, 30.0)), (0.0, 0.0));
    }

    #[test]
    fn angles_and_exponentials_match_the_standard_library() {
        for step in -2000..2000 {
            let x = step as f32 / 100.0;
            let (sin, cos) = f64::from(x).sin_cos();
            let expected = (Vec2::new(cos as f32, sin as f32), f64::from(x).exp() as f32);
            assert_eq!((cos_sin(x), exp(x)), expected, "{x}");
        }
    }
}
