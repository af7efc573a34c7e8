//! Exact sums of doubles, for diagnostics that must not depend on the number of ranks.

use super::Quantum;

const CHUNK_BITS: i32 = 32;
/// Exponent of the lowest bit of a double: the smallest subnormal is 2^-1074.
const LOWEST_EXPONENT: i32 = -1074;
/// Number of 32-bit chunks: 2098 bits of doubles, and room for sums of 2^60 of them.
const CHUNKS: usize = 69;
/// Number of additions before a carry: each changes a chunk by less than 2^32.
const ADDITIONS_BETWEEN_CARRIES: u32 = 1 << 29;

/// A superaccumulator: it holds any sum of finite doubles as one long fixed-point number.
///
/// The result does not depend on the order of additions or the distribution over ranks; only `value` rounds, once. The
/// method follows R. M. Neal, "Fast exact summation using small and large superaccumulators", arXiv:1505.05571.
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::numbers::ExactSum;
/// let mut sum = ExactSum::default();
/// for x in [1.0e300, 1.0, -1.0e300] {
///     sum.add(x);
/// }
/// assert_eq!(sum.value(), 1.0);
/// ```
#[derive(Clone, Debug)]
pub struct ExactSum {
    chunks: [i64; CHUNKS],
    additions: u32,
    not_finite: bool,
}

impl Default for ExactSum {
    fn default() -> Self {
        Self { chunks: [0; CHUNKS], additions: 0, not_finite: false }
    }
}

impl ExactSum {
    /// Adds a number. If one is infinite or undefined, the sum is undefined.
    pub fn add(&mut self, number: f64) {
        if !number.is_finite() {
            self.not_finite = true;
            return;
        }
        let bits = number.to_bits();
        let exponent_field = ((bits >> 52) & 0x7ff) as i32;
        let fraction = (bits & ((1 << 52) - 1)) as i64;
        let (mantissa, exponent) = match exponent_field {
            0 => (fraction, LOWEST_EXPONENT),
            field => (fraction | (1 << 52), field - 1075),
        };
        let offset = exponent - LOWEST_EXPONENT;
        let (chunk, shift) = ((offset / CHUNK_BITS) as usize, offset % CHUNK_BITS);
        let shifted = i128::from(mantissa) << shift; // below 2^85: three chunks
        let sign = if number.is_sign_negative() { -1 } else { 1 };
        for part in 0..3 {
            let low = ((shifted >> (CHUNK_BITS * part)) & 0xffff_ffff) as i64;
            self.chunks[chunk + part as usize] += sign * low;
        }
        self.additions += 1;
        if self.additions == ADDITIONS_BETWEEN_CARRIES {
            self.carry();
        }
    }

    /// Adds an integer times 2^exponent, exactly; the exponent must be at least -1074, and the product no larger than
    /// the largest double.
    pub(crate) fn add_integer(&mut self, integer: i128, exponent: i32) {
        let mut rest = integer;
        for part in 0..4 {
            // The last part carries the sign.
            let digits = if part == 3 { rest } else { rest & 0xffff_ffff };
            self.add(scale(digits as f64, exponent + part * CHUNK_BITS));
            rest >>= CHUNK_BITS;
        }
    }

    /// Adds another sum, exactly.
    pub fn add_sum(&mut self, other: &Self) {
        let mut carried = other.clone();
        carried.carry();
        self.carry();
        self.chunks.iter_mut().zip(carried.chunks).for_each(|(sum, chunk)| *sum += chunk);
        self.additions += 1;
        self.not_finite |= other.not_finite;
    }

    /// This sum with the other sign.
    #[must_use]
    pub fn negated(&self) -> Self {
        let mut negated = self.clone();
        negated.chunks.iter_mut().for_each(|chunk| *chunk = -*chunk);
        negated.carry();
        negated
    }

    /// Adds `count` times a quantum, exactly.
    pub fn add_count(&mut self, count: i64, quantum: Quantum) {
        const SPLIT: i64 = 1 << 32;
        self.add((count.div_euclid(SPLIT) * SPLIT) as f64 * quantum.spacing());
        self.add(count.rem_euclid(SPLIT) as f64 * quantum.spacing());
    }

    /// The sum, with a relative rounding error below 2^-52; undefined (NaN) if an addend was infinite or undefined.
    pub fn value(&self) -> f64 {
        if self.not_finite {
            return f64::NAN;
        }
        let mut carried = self.clone();
        carried.carry();
        let negative = carried.chunks[CHUNKS - 1] < 0;
        if negative {
            for chunk in &mut carried.chunks {
                *chunk = -*chunk;
            }
            carried.carry();
        }
        let Some(top) = carried.chunks.iter().rposition(|&chunk| chunk != 0) else { return 0.0 };
        let mut magnitude = 0.0;
        // Four chunks, the smallest first: at least 97 significant bits.
        for index in top.saturating_sub(3)..=top {
            magnitude +=
                scale(carried.chunks[index] as f64, index as i32 * CHUNK_BITS + LOWEST_EXPONENT);
        }
        if negative { -magnitude } else { magnitude }
    }

    /// The accumulator as integers that may be added over ranks; [`ExactSum::from_integers`] converts the sums back.
    pub fn to_integers(&self) -> Vec<i64> {
        let mut carried = self.clone();
        carried.carry();
        let mut integers = carried.chunks.to_vec();
        integers.push(i64::from(self.not_finite));
        integers
    }

    /// Number of integers in [`ExactSum::to_integers`].
    pub const INTEGERS: usize = CHUNKS + 1;

    /// The inverse of [`ExactSum::to_integers`], also after adding up to 2^30 of them element by element.
    pub fn from_integers(integers: &[i64]) -> Self {
        let mut sum = Self::default();
        sum.chunks.copy_from_slice(&integers[..CHUNKS]);
        sum.not_finite = integers[CHUNKS] != 0;
        sum.carry();
        sum
    }

    /// Carries over, so that all chunks but the last lie in 0..2^32.
    fn carry(&mut self) {
        for index in 0..CHUNKS - 1 {
            let carry = self.chunks[index] >> CHUNK_BITS;
            self.chunks[index] -= carry << CHUNK_BITS;
            self.chunks[index + 1] += carry;
        }
        self.additions = 0;
    }
}

/// x 2^exponent. The power is split into two factors, neither of which overflows or underflows.
fn scale(x: f64, exponent: i32) -> f64 {
    let half = exponent / 2;
    x * 2.0_f64.powi(half) * 2.0_f64.powi(exponent - half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sum_of(values: &[f64]) -> ExactSum {
        let mut sum = ExactSum::default();
        values.iter().for_each(|&value| sum.add(value));
        sum
    }

    proptest! {
        #[test]
        fn sums_distributed_over_ranks_have_the_same_bits(values in prop::collection::vec(-1.0e9..1.0e9f64, 1..50), split in 0usize..50) {
            let whole = sum_of(&values);
            let (left, right) = values.split_at(split.min(values.len()));
            let integers: Vec<i64> = sum_of(left).to_integers().iter()
                .zip(sum_of(right).to_integers()).map(|(a, b)| a + b).collect();
            prop_assert_eq!(ExactSum::from_integers(&integers).value().to_bits(), whole.value().to_bits());
            let plain: f64 = values.iter().sum();
            // 50 additions of numbers below 1e9 round by at most 50 * 50e9 * 2^-53.
            prop_assert!((whole.value() - plain).abs() < 3.0e-4);
        }

        #[test]
        fn the_sum_of_one_number_is_that_number(x in prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO) {
            prop_assert_eq!(sum_of(&[x]).value(), x);
        }
    }

    #[test]
    fn sums_are_added_and_negated_exactly() {
        let mut sum = sum_of(&[1.0e16, 1.0]);
        sum.add_sum(&sum_of(&[-2.5, 3.0e-300]));
        sum.add_sum(&sum_of(&[1.0e16, 0.25]).negated());
        assert_eq!(sum.value(), -1.75);
        sum.add_sum(&sum_of(&[-1.75]).negated());
        assert_eq!(sum.value(), 3.0e-300);
        sum.add_sum(&sum_of(&[f64::NAN]));
        assert!(sum.value().is_nan());
    }

    #[test]
    fn cancellation_is_exact() {
        assert_eq!(sum_of(&[1.0e16, 1.0, -1.0e16]).value(), 1.0);
        assert_eq!(1.0e16 + 1.0 - 1.0e16, 0.0); // the ordinary sum
        assert_eq!(sum_of(&[-3.5, 1.0]).value(), -2.5);
        assert!(sum_of(&[f64::INFINITY]).value().is_nan());
    }

    #[test]
    fn multiples_of_a_quantum_are_added_exactly() {
        let quantum = Quantum::spanning(1.0);
        let mut sum = ExactSum::default();
        sum.add_count(i64::MAX, quantum);
        sum.add_count(-(i64::MAX - 3), quantum);
        assert_eq!(sum.value(), 3.0 * quantum.spacing());
    }
}
