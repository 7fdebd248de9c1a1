//! Branch-free `exp`, `sin` and `cos`.
//!
//! The library functions of the platform are calls that the compiler cannot turn into vector
//! code, and their last bits differ from platform to platform. These are short polynomials
//! (evaluated by Estrin's scheme, so that the additions do not wait for each other) after an
//! argument reduction by Cody and Waite; a loop of them over lanes becomes vector code.

/// 1.5 x 2^52: adding it leaves the nearest integer in the low bits of the sum.
const ROUND: f64 = 6_755_399_441_055_744.0;
const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
/// pi/2 in three parts of 33 bits: their products with an integer below 2^20 are exact.
const HALF_PI: [f64; 3] =
    [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Below this the result is zero (it would be subnormal), above `EXP_HIGHEST` infinite.
const EXP_LOWEST: f64 = -708.0;
const EXP_HIGHEST: f64 = 709.0;

/// e^x; relative error below 3 units in the last place, 0 below -708 and infinite above 709.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    let clamped = if x < EXP_LOWEST { EXP_LOWEST } else { x };
    let clamped = if clamped > EXP_HIGHEST { EXP_HIGHEST } else { clamped };
    let shifted = clamped * std::f64::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (clamped - n * LN_2_HIGH) - n * LN_2_LOW;
    // Taylor to r^13; |r| <= 0.347 leaves 4e-18.
    let r2 = r * r;
    let r4 = r2 * r2;
    let r8 = r4 * r4;
    let low = (1.0 + r) + r2 * (0.5 + r * (1.0 / 6.0));
    let middle = (1.0 / 24.0 + r * (1.0 / 120.0)) + r2 * (1.0 / 720.0 + r * (1.0 / 5_040.0));
    let high = (1.0 / 40_320.0 + r * (1.0 / 362_880.0))
        + r2 * (1.0 / 3_628_800.0 + r * (1.0 / 39_916_800.0));
    let top = 1.0 / 479_001_600.0 + r * (1.0 / 6_227_020_800.0);
    let series = (low + r4 * middle) + r8 * (high + r4 * top);
    // 2^n by its exponent bits: |n| <= 1023 after the clamp, so one factor is enough.
    let n_bits = shifted.to_bits().wrapping_sub(ROUND.to_bits());
    let result = series * f64::from_bits(n_bits.wrapping_add(1023) << 52);
    let result = if x < EXP_LOWEST { 0.0 } else { result };
    let result = if x > EXP_HIGHEST { f64::INFINITY } else { result };
    if x.is_nan() { x } else { result }
}

/// Sine and cosine of an angle in rad; absolute error below 2e-16 for |x| < 1e6 rad.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    let shifted = x * std::f64::consts::FRAC_2_PI + ROUND;
    let n = shifted - ROUND;
    let r = ((x - n * HALF_PI[0]) - n * HALF_PI[1]) - n * HALF_PI[2];
    let quadrant = shifted.to_bits();
    let r2 = r * r;
    let r4 = r2 * r2;
    let r8 = r4 * r4;
    // Taylor to r^17 and r^16; |r| <= pi/4 leaves 1e-19 and 2e-18.
    let sine_tail = ((-1.0 / 6.0 + r2 * (1.0 / 120.0))
        + r4 * (-1.0 / 5_040.0 + r2 * (1.0 / 362_880.0)))
        + r8 * ((-1.0 / 39_916_800.0 + r2 * (1.0 / 6_227_020_800.0))
            + r4 * (-1.0 / 1_307_674_368_000.0 + r2 * (1.0 / 355_687_428_096_000.0)));
    let sine = r + r * r2 * sine_tail;
    let cosine_tail = ((1.0 / 24.0 + r2 * (-1.0 / 720.0))
        + r4 * (1.0 / 40_320.0 + r2 * (-1.0 / 3_628_800.0)))
        + r8 * ((1.0 / 479_001_600.0 + r2 * (-1.0 / 87_178_291_200.0))
            + r4 * (1.0 / 20_922_789_888_000.0));
    let cosine = 1.0 - 0.5 * r2 + r4 * cosine_tail;
    let odd = quadrant & 1 == 1;
    let (s, c) = if odd { (cosine, sine) } else { (sine, cosine) };
    let s_negative = quadrant & 2 == 2;
    let c_negative = quadrant.wrapping_add(1) & 2 == 2;
    (if s_negative { -s } else { s }, if c_negative { -c } else { c })
}

/// Hyperbolic tangent, through e^(-2|x|).
#[inline(always)]
pub fn tanh(x: f64) -> f64 {
    let magnitude = if x < 0.0 { -x } else { x };
    let e = exp(-2.0 * magnitude);
    // Near zero 1 - e cancels: three terms of the odd series are exact to 1e-16 below 3e-3.
    let x2 = x * x;
    let small = x * (1.0 - x2 * (1.0 / 3.0 - x2 * (2.0 / 15.0)));
    let large = (1.0 - e) / (1.0 + e);
    let signed = if x < 0.0 { -large } else { large };
    if magnitude < 3e-3 { small } else { signed }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three units in the last place.
    const RELATIVE: f64 = 7e-16;
    const ABSOLUTE: f64 = 2.3e-16;

    #[test]
    fn exp_agrees_with_the_platform() {
        for k in -70_000..70_900 {
            let x = f64::from(k) * 0.01 + 0.001_234;
            let expected = x.exp();
            let error = (exp(x) - expected).abs();
            assert!(error <= RELATIVE * expected, "exp({x}): {} against {expected}", exp(x));
        }
        assert_eq!(exp(-1e9), 0.0);
        assert_eq!(exp(f64::NEG_INFINITY), 0.0);
        assert_eq!(exp(1e9), f64::INFINITY);
        assert_eq!(exp(0.0), 1.0);
        assert!(exp(f64::NAN).is_nan());
    }

    #[test]
    fn sine_and_cosine_agree_with_the_platform() {
        for k in -400_000..400_000 {
            let x = f64::from(k) * 0.37 + 0.000_7;
            let (s, c) = sin_cos(x);
            assert!((s - x.sin()).abs() <= ABSOLUTE, "sin({x}) off by {}", s - x.sin());
            assert!((c - x.cos()).abs() <= ABSOLUTE, "cos({x}) off by {}", c - x.cos());
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
    }

    #[test]
    fn tanh_agrees_with_the_platform() {
        for k in -50_000..50_000 {
            let x = f64::from(k) * 4.1e-4;
            // Cancellation just above the switch costs a few hundred units in the last place.
            assert!((tanh(x) - x.tanh()).abs() <= 3e-16 + 5e-14 * x.tanh().abs(), "tanh({x})");
        }
    }
}
