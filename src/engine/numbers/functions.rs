//! Elementary functions that affect the state, with the same bits on every machine.

use std::f64::consts::{FRAC_1_SQRT_2, LN_2, LOG2_E};

/// sin(x), x in radians.
pub(crate) fn sine(x: f64) -> f64 {
    libm::sin(x)
}

/// x^y for normal x > 0 and results that are normal numbers; relative error below 1e-14 while x^y lies within
/// 1e-3 to 1e3, growing with |ln x^y|.
///
/// It consists of additions, multiplications and one division, without branches, so that loops over it are vectorised;
/// a call into a library takes longer than all contacts of a particle. Every operation is rounded once, so the bits do
/// not depend on the machine.
///
/// log2 is computed from the series of artanh((m - 1)/(m + 1)), 2^f from its Taylor series. Both are truncated where
/// the next term is below 2^-53, and evaluated in independent parts by Estrin's scheme (Muller, "Elementary Functions",
/// 3rd ed., chapters 3, 5 and 11).
#[inline(always)]
pub(crate) fn power(x: f64, y: f64) -> f64 {
    exp2(y * log2(x))
}

/// Powers of several numbers, in short loops. A processor examines 100 to 250 instructions ahead, and can therefore
/// execute several of these independent iterations at once.
#[inline(always)]
pub(crate) fn powers<const N: usize>(mut numbers: [f64; N], exponent: f64) -> [f64; N] {
    let mut binary_exponents = [0.0; N];
    for (number, binary) in numbers.iter_mut().zip(&mut binary_exponents) {
        [*binary, *number] = split(*number);
    }
    for (number, binary) in numbers.iter_mut().zip(binary_exponents) {
        *number = exponent * log2_of_split([binary, *number]);
    }
    for number in &mut numbers {
        *number = exp2(*number);
    }
    numbers
}

const MANTISSA: u64 = (1 << 52) - 1;
const ONE: u64 = 1023 << 52;
const SQRT_HALF: u64 = FRAC_1_SQRT_2.to_bits();
/// 2^52: numbers in [2^52, 2^53) hold an integer in their mantissa.
const TWO_TO_52: f64 = 4_503_599_627_370_496.0;

/// The integer x from 0 to 2^32 - 1, computed by vector instructions, unlike a cast with its checks.
#[inline(always)]
pub(crate) fn whole(x: f64) -> u32 {
    (x + TWO_TO_52).to_bits() as u32
}

#[inline(always)]
fn log2(x: f64) -> f64 {
    log2_of_split(split(x))
}

/// The exponent e and s = (m - 1)/(m + 1) of x = m 2^e, sqrt(1/2) <= m < sqrt(2).
#[inline(always)]
fn split(x: f64) -> [f64; 2] {
    // The bits are taken relative to those of sqrt(1/2), so that the mantissa m lies in [sqrt(1/2), sqrt(2)).
    let bits = x.to_bits().wrapping_add(ONE.wrapping_sub(SQRT_HALF));
    let exponent = f64::from_bits((bits >> 52) | TWO_TO_52.to_bits()) - (TWO_TO_52 + 1023.0);
    let m = f64::from_bits((bits & MANTISSA) + SQRT_HALF);
    [exponent, (m - 1.0) / (m + 1.0)]
}

#[inline(always)]
fn log2_of_split([exponent, s]: [f64; 2]) -> f64 {
    let q = s * s; // |s| < 0.1716
    let q4 = (q * q) * (q * q);
    let [first, second] = [0, 4].map(|from| four_terms(&ARTANH, from, q));
    let last = ARTANH[8] + ARTANH[9] * q;
    let series = (first + second * q4) + last * (q4 * q4);
    exponent + 2.0 * LOG2_E * s * series
}

#[inline(always)]
fn exp2(t: f64) -> f64 {
    let shifted = t + 1.5 * TWO_TO_52;
    let whole = shifted - 1.5 * TWO_TO_52;
    let f = t - whole; // |f| <= 0.5
    let f4 = (f * f) * (f * f);
    let [first, second, third] = [0, 4, 8].map(|from| four_terms(&EXP2, from, f));
    let last = EXP2[12] + EXP2[13] * f;
    let series = (first + second * f4) + (third + last * f4) * (f4 * f4);
    let scale = f64::from_bits((shifted.to_bits().wrapping_add(1023)) << 52);
    series * scale
}

/// Coefficients of artanh(s) / s = sum q^n / (2n + 1), q = s^2.
const ARTANH: [f64; 10] = {
    let mut coefficients = [1.0; 10];
    let mut n = 1;
    while n < 10 {
        coefficients[n] = 1.0 / (2 * n + 1) as f64;
        n += 1;
    }
    coefficients
};

/// Coefficients of 2^f = sum (f ln 2)^n / n!.
const EXP2: [f64; 14] = {
    let mut coefficients = [1.0; 14];
    let mut n = 1;
    while n < 14 {
        coefficients[n] = coefficients[n - 1] * LN_2 / n as f64;
        n += 1;
    }
    coefficients
};

/// c_n + c_n+1 x + c_n+2 x^2 + c_n+3 x^3, n = `from`.
#[inline(always)]
fn four_terms(coefficients: &[f64], from: usize, x: f64) -> f64 {
    let c = &coefficients[from..from + 4];
    (c[0] + c[1] * x) + (c[2] + c[3] * x) * (x * x)
}

#[cfg(test)]
mod tests {
    use super::{power, powers, whole};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn powers_agree_with_the_library(x in 0.02..50.0f64, y in -3.0..3.0f64) {
            let (ours, theirs) = (power(x, y), libm::pow(x, y));
            // The rounding of y log2 x, up to 17 in magnitude here, enters as 17 * 2^-53 * ln 2 per rounding.
            prop_assert!((ours / theirs - 1.0).abs() < 1.0e-14, "{ours} {theirs}");
            prop_assert_eq!(powers([1.0, x], y), [1.0, ours]);
        }
    }

    #[test]
    fn integers_are_themselves() {
        for x in [0, 1, 77, u32::MAX] {
            assert_eq!(whole(f64::from(x)), x);
        }
    }

    #[test]
    fn simple_powers_are_right() {
        assert_eq!(power(1.0, -2.65), 1.0);
        assert_eq!(power(4.0, 0.5), 2.0);
        assert_eq!(power(2.0, -3.0), 0.125);
        assert!((power(0.37, -2.65) / power(0.37, -2.6) - 1.0).abs() > 1.0e-2); // a control
    }
}
