//! Exact sums of numbers of similar magnitude.

use super::ExactSum;

/// Number of binary digits by which addends in the window may differ; together with the 53 digits of a double and 20
/// for the number of additions they fit into 128 bits.
const WIDTH: u32 = 54;
const ADDITIONS_BETWEEN_FLUSHES: u32 = 1 << 19;
/// Exponent fields at which a window may begin: such a window contains no subnormal numbers and no sum that overflows.
const BEGINS: std::ops::RangeInclusive<u32> = 1..=1800;
/// Number of digits of the window below the first addend.
const BELOW_FIRST: u32 = 40;
/// An exponent field that is far from all numbers.
const NO_WINDOW: u32 = 1 << 12;

/// An [`ExactSum`] with a window of 128 bits at the magnitude of the first non-zero addend: adding a number within the
/// window takes one addition of integers. The sum is exact in any case, and thus the same.
#[derive(Clone, Debug)]
pub(crate) struct QuickSum {
    /// Exponent field of the window's lowest digit.
    lowest: u32,
    window: i128,
    /// Number of additions since the window was last empty.
    additions: u32,
    others: ExactSum,
}

impl Default for QuickSum {
    fn default() -> Self {
        Self { lowest: NO_WINDOW, window: 0, additions: 0, others: ExactSum::default() }
    }
}

impl QuickSum {
    /// Adds a number. If one is infinite or undefined, the sum is undefined.
    #[inline(always)]
    pub(crate) fn add(&mut self, number: f64) {
        let bits = number.to_bits();
        let field = (bits >> 52) as u32 & 0x7ff;
        let place = field.wrapping_sub(self.lowest);
        if place >= WIDTH {
            self.add_other(number, field);
            return;
        }
        let magnitude = (bits & ((1 << 52) - 1) | 1 << 52) as i64;
        let signed = if number.is_sign_negative() { -magnitude } else { magnitude };
        self.window += i128::from(signed) << place;
        self.additions += 1;
        if self.additions == ADDITIONS_BETWEEN_FLUSHES {
            self.flush();
        }
    }

    /// Adds a number that is outside the window.
    #[cold]
    fn add_other(&mut self, number: f64, field: u32) {
        if number == 0.0 {
            return;
        }
        if self.lowest == NO_WINDOW && BEGINS.contains(&field) {
            self.lowest = field.saturating_sub(BELOW_FIRST).max(*BEGINS.start());
            self.add(number);
        } else {
            self.others.add(number);
        }
    }

    fn flush(&mut self) {
        self.others.add_integer(self.window, self.lowest as i32 - 1075);
        (self.window, self.additions) = (0, 0);
    }

    /// The sum.
    pub(crate) fn exact(mut self) -> ExactSum {
        if self.lowest != NO_WINDOW {
            self.flush();
        }
        self.others
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn both(numbers: &[f64]) -> [u64; 2] {
        let (mut quick, mut exact) = (QuickSum::default(), ExactSum::default());
        for &number in numbers {
            quick.add(number);
            exact.add(number);
        }
        [quick.exact().value().to_bits(), exact.value().to_bits()]
    }

    proptest! {
        #[test]
        fn sums_have_the_bits_of_exact_ones(
            numbers in prop::collection::vec(
                prop_oneof![-3.0..3.0f64, -1.0e-9..1.0e-9f64, Just(0.0), prop::num::f64::NORMAL,
                    prop::num::f64::SUBNORMAL],
                0..60,
            ),
        ) {
            let [quick, exact] = both(&numbers);
            prop_assert_eq!(quick, exact);
        }
    }

    #[test]
    fn many_additions_are_flushed_and_undefined_numbers_kept() {
        let many: Vec<f64> = (0..1_200_000).map(|k| 1.9 - f64::from(k % 7)).collect();
        let [quick, exact] = both(&many);
        assert_eq!(quick, exact);
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(f64::from_bits(both(&[1.0, odd])[0]).is_nan());
        }
        assert_eq!(both(&[1.0e300, f64::MAX, -1.0e300, -f64::MAX, 2.5])[0], 2.5_f64.to_bits());
    }
}
