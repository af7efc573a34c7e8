//! Rounding to multiples of a quantum, which makes floating-point sums exact and so independent of their order.
//!
//! # Vocabulary
//!
//! * A **quantum** is a power of two; numbers are rounded to integer multiples of it. Another name is the *unit* of a
//!   fixed-point number; the multiple is its *count*.
//! * The **range** of a quantum is the magnitude up to which numbers are rounded correctly: 2^51 quanta.
//! * **Pre-rounding** is this rounding of all terms before they are added. It was introduced as the extraction of
//!   high-order parts by Rump, Ogita and Oishi \[Rump2008\]; sums of pre-rounded terms are reproducible for any order and
//!   any distribution over ranks \[Demmel2015\]. Their quantum follows from the largest term; Talcum's follow from
//!   physical bounds given by the case, so that no reduction is needed.
//!
//! References:
//!
//! * Demmel2015: J. Demmel, H. D. Nguyen, "Parallel reproducible summation", IEEE Trans. Comput. 64 (2015) 2060-2070.
//! * Rump2008: S. M. Rump, T. Ogita, S. Oishi, "Accurate floating-point summation part I: faithful rounding", SIAM J. Sci.
//!   Comput. 31 (2008) 189-224.

use super::F64x4;
use nalgebra::Vector3;

/// A quantum: numbers are rounded to `k * spacing`, with an integer k and a power of two `spacing`.
///
/// Multiples of one quantum are added and subtracted **exactly** in double precision as long as the result stays below
/// 2^53 quanta. Their sum is therefore the same for any order and any distribution over ranks. Talcum rounds positions
/// to one quantum: the displacement between two particles then does not depend on the periodic face or the rank border
/// across which it is computed. Forces are rounded to another quantum: the force on a particle then does not depend on
/// the order in which its contacts are evaluated.
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::numbers::Quantum;
/// let quantum = Quantum::spanning(1.0e3);
/// let (a, b, c) = (quantum.round(0.1), quantum.round(-700.3), quantum.round(1.0e-7));
/// assert_eq!((a + b) + c, a + (b + c)); // the sums of unrounded doubles differ in the last digit
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantum {
    spacing: f64,
    /// 1 / spacing, exact.
    inverse: f64,
    shift: f64,
}

impl Quantum {
    /// The smallest quantum with which all numbers of magnitude up to `largest` are rounded correctly.
    ///
    /// # Panics
    /// If `largest` is not positive and finite.
    pub fn spanning(largest: f64) -> Self {
        assert!(largest > 0.0 && largest.is_finite(), "a quantum needs a positive, finite range");
        let mut range = 1.0_f64;
        while range < largest {
            range *= 2.0;
        }
        while range * 0.5 >= largest {
            range *= 0.5;
        }
        let spacing = range * 0.5_f64.powi(51);
        // Adding 1.5 * 2^52 quanta rounds to multiples of the quantum; subtracting them again is exact.
        Self { spacing, inverse: 1.0 / spacing, shift: 1.5 * 2.0_f64.powi(52) * spacing }
    }

    /// The quantum itself: the distance between two neighbouring multiples.
    pub fn spacing(self) -> f64 {
        self.spacing
    }

    /// The range, 2^51 quanta: numbers up to this magnitude are rounded correctly.
    pub fn range(self) -> f64 {
        2.0_f64.powi(51) * self.spacing
    }

    /// The multiple nearest to `value`; `round(-x)` is `-round(x)`.
    #[inline(always)]
    pub fn round(self, value: f64) -> f64 {
        (value + self.shift) - self.shift
    }

    /// Number that is added to a value, and subtracted again, to round it: 1.5 * 2^52 quanta.
    pub(crate) fn shift(self) -> f64 {
        self.shift
    }

    /// Rounds each of four numbers.
    #[inline(always)]
    pub(crate) fn round_four<Q: F64x4>(self, values: Q) -> Q {
        let shift = Q::splat(self.shift);
        values.plus(shift).minus(shift)
    }

    /// Rounds each component.
    #[inline(always)]
    pub fn round_vector(self, value: Vector3<f64>) -> Vector3<f64> {
        Vector3::new(self.round(value.x), self.round(value.y), self.round(value.z))
    }

    /// The count k of a multiple `k * spacing`.
    #[inline(always)]
    pub fn count(self, multiple: f64) -> i64 {
        (multiple * self.inverse) as i64
    }
}

/// Whether the magnitude of every component is at most `limit`; false if one is undefined.
#[inline(always)]
pub fn within(vector: &Vector3<f64>, limit: f64) -> bool {
    vector.x.abs() <= limit && vector.y.abs() <= limit && vector.z.abs() <= limit
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_range_is_at_least_the_largest_number_and_below_twice_it() {
        for largest in [1.0e-12, 0.7, 1.0, 1.1, 5.0e9] {
            let range = Quantum::spanning(largest).range();
            assert!(range >= largest && range < 2.0 * largest);
        }
    }

    proptest! {
        #[test]
        fn rounding_is_odd_and_within_half_a_quantum(x in -1.0e4..1.0e4f64) {
            let quantum = Quantum::spanning(1.0e4);
            prop_assert_eq!(quantum.round(-x), -quantum.round(x));
            prop_assert!((quantum.round(x) - x).abs() <= 0.5 * quantum.spacing());
            prop_assert_eq!(quantum.count(quantum.round(x)) as f64 * quantum.spacing(), quantum.round(x));
        }

        #[test]
        fn sums_of_multiples_do_not_depend_on_order(mut values in prop::collection::vec(-1.0e3..1.0e3f64, 2..60)) {
            let quantum = Quantum::spanning(1.0e5);
            for value in &mut values {
                *value = quantum.round(*value);
            }
            let forwards: f64 = values.iter().sum();
            let backwards: f64 = values.iter().rev().sum();
            prop_assert_eq!(forwards.to_bits(), backwards.to_bits());
        }
    }

    #[test]
    fn an_undefined_component_is_not_within_any_limit() {
        assert!(within(&Vector3::new(1.0, -2.0, 0.0), 2.0));
        assert!(!within(&Vector3::new(1.0, -2.1, 0.0), 2.0));
        assert!(!within(&Vector3::new(0.0, f64::NAN, 0.0), 2.0));
    }

    #[test]
    fn sums_of_unrounded_numbers_depend_on_order() {
        // Negative control of `sums_of_multiples_do_not_depend_on_order`: these numbers are not rounded.
        let values = [0.1, -700.3, 1.0e-7, 699.9];
        let forwards: f64 = values.iter().sum();
        let backwards: f64 = values.iter().rev().sum();
        assert_ne!(forwards, backwards);
    }
}
