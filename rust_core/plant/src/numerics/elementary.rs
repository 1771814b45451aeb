//! Fused operations, exponential function and logarithm, inlined: a call of the library costs more than its arithmetic, because
//! everything at hand has to be put aside for it.
//!
//! Within 1e-15 of the library's values (see the tests).

use std::f64::consts::LOG2_E;

/// The logarithm of two in two parts; the first has zeros at its end, so that its product with a small whole number is
/// exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// Added to a number and taken away again, this rounds it; in between its last bits are the whole number.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Bits of a fraction; what stands before them is the exponent, with this much added.
const FRACTION_BITS: u32 = 52;
const EXPONENT_BIAS: u64 = 1023;

/// Exponents beyond which nothing is told apart: powers of two that are no subnormal numbers.
const LARGEST_EXPONENT: f64 = 700.0;

/// `a * b + c`, in one operation that rounds once where the processor has it.
#[inline(always)]
#[must_use]
pub fn fused(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(any(target_feature = "fma", target_arch = "aarch64")) { a.mul_add(b, c) } else { a * b + c }
}

/// `exp(x)`; held beyond 700 and below -700.
#[inline]
#[must_use]
pub fn exp(x: f64) -> f64 {
    let (power, rest) = split(x);
    fused(power, exp_m1_of_small(rest), power)
}

/// `exp(x) - 1`, as exact near 0 as elsewhere; held beyond 700 and below -700.
#[inline]
#[must_use]
pub fn exp_m1(x: f64) -> f64 {
    let (power, rest) = split(x);
    fused(power, exp_m1_of_small(rest), power - 1.0)
}

/// `x` to a power; of a positive number.
#[inline]
#[must_use]
pub fn power(x: f64, exponent: f64) -> f64 {
    exp(exponent * ln(x))
}

/// A power of two and a rest of at most half the logarithm of two: `exp(x)` is the one times `exp` of the other.
#[inline]
fn split(x: f64) -> (f64, f64) {
    let x = x.clamp(-LARGEST_EXPONENT, LARGEST_EXPONENT);
    let rounded = fused(x, LOG2_E, ROUNDING);
    let power =
        f64::from_bits((rounded.to_bits() << FRACTION_BITS).wrapping_add(EXPONENT_BIAS << FRACTION_BITS));
    let whole = rounded - ROUNDING;
    (power, fused(-whole, LN_2[1], fused(-whole, LN_2[0], x)))
}

/// `exp(x) - 1` for `x` up to 0.35: its series, in pairs that do not wait for one another.
#[inline]
fn exp_m1_of_small(x: f64) -> f64 {
    const C: [f64; 11] = {
        let mut coefficients = [0.5; 11];
        let mut k = 1;
        while k < coefficients.len() {
            coefficients[k] = coefficients[k - 1] / (k + 2) as f64;
            k += 1;
        }
        coefficients
    };
    let square = x * x;
    let fourth = square * square;
    let pair = |k: usize| fused(C[k + 1], x, C[k]);
    let low = fused(square, pair(2), pair(0));
    let middle = fused(square, pair(6), pair(4));
    let high = fused(square, C[10], pair(8));
    fused(square, fused(fourth, fused(fourth, high, middle), low), x)
}

/// Natural logarithm.
#[inline]
#[must_use]
pub fn ln(x: f64) -> f64 {
    /// Square root of one half: from here on the fraction is near enough to 1.
    const LOWEST: u64 = 0x3fe6_a09e_0000_0000;
    // The best polynomial for what the series in `s` leaves (Sun's fdlibm, e_log.c).
    const L: [f64; 7] = [
        6.666_666_666_666_735e-1,
        3.999_999_999_940_942e-1,
        2.857_142_874_366_239e-1,
        2.222_219_843_214_978_4e-1,
        1.818_357_216_161_805e-1,
        1.531_383_769_920_937_3e-1,
        1.479_819_860_511_658_6e-1,
    ];
    if !(f64::MIN_POSITIVE..=f64::MAX).contains(&x) {
        return x.ln();
    }
    let above = x.to_bits().wrapping_sub(LOWEST).cast_signed() >> FRACTION_BITS;
    let fraction = f64::from_bits(x.to_bits().wrapping_sub((above << FRACTION_BITS).cast_unsigned()));
    let exponent = above as f64;
    let f = fraction - 1.0;
    let s = f / (2.0 + f);
    let (z, half) = (s * s, 0.5 * f * f);
    let w = z * z;
    let even = w * fused(w, fused(w, L[5], L[3]), L[1]);
    let odd = z * fused(w, fused(w, fused(w, L[6], L[4]), L[2]), L[0]);
    exponent * LN_2[0] - ((half - (s * (half + even + odd) + exponent * LN_2[1])) - f)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BOUND: f64 = 1e-15;

    proptest! {
        #[test]
        fn exponentials_are_those_of_the_library(x in -690.0..690.0_f64, small in -3.0..3.0_f64, tiny in -1e-3..1e-3_f64) {
            for x in [x, small, tiny] {
                prop_assert!((exp(x) / x.exp() - 1.0).abs() < BOUND, "{x}");
                prop_assert!((exp_m1(x) / x.exp_m1() - 1.0).abs() < BOUND, "{x}");
            }
        }

        #[test]
        fn logarithms_are_those_of_the_library(exponent in -690.0..690.0_f64, near_one in 0.5..2.0_f64) {
            for x in [exponent.exp(), near_one] {
                prop_assert!((ln(x) - x.ln()).abs() <= BOUND * x.ln().abs(), "{x}");
            }
        }

        #[test]
        fn powers_are_those_of_the_library(x in 1e-3..1e9_f64, exponent in -2.0..2.0_f64) {
            prop_assert!((power(x, exponent) / x.powf(exponent) - 1.0).abs() < 2e-14, "{x} {exponent}");
        }
    }

    #[test]
    fn ends_are_held_and_what_is_no_number_stays_none() {
        assert_eq!(exp(0.0), 1.0);
        assert_eq!((exp_m1(0.0), ln(1.0)), (0.0, 0.0));
        assert_eq!(exp(-1e9), exp(-700.0));
        assert_eq!(exp(f64::INFINITY), exp(700.0));
        assert_eq!(exp_m1(f64::NEG_INFINITY), -1.0);
        assert_eq!(ln(0.0), f64::NEG_INFINITY);
        assert_eq!(ln(f64::INFINITY), f64::INFINITY);
        for value in [exp(f64::NAN), exp_m1(f64::NAN), ln(f64::NAN), ln(-1.0)] {
            assert!(value.is_nan());
        }
    }
}
