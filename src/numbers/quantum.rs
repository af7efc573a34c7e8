//! Rounding to a lattice: what makes floating-point sums exact, and so independent of their order.

use super::F64x4;
use nalgebra::Vector3;

/// A lattice of numbers `k * spacing`, k an integer, with `spacing` a power of two.
///
/// Numbers on one lattice add and subtract **exactly** in double precision as long as the result stays
/// below 2^53 spacings; a sum of them is therefore the same in any order and on any grouping over
/// ranks. Talcum keeps positions on one lattice (so that the displacement of two particles does not
/// know through which periodic or rank border it is seen) and forces on another (so that the force on
/// a particle does not know in which order its contacts were evaluated).
///
/// Method: Demmel & Nguyen, "Parallel reproducible summation", IEEE Trans. Comput. 64 (2015), with one
/// bin, whose width the physical bounds of the problem give.
///
/// ```
/// use talcum::numbers::Quantum;
/// let lattice = Quantum::spanning(1.0e3);
/// let (a, b, c) = (lattice.round(0.1), lattice.round(-700.3), lattice.round(1.0e-7));
/// assert_eq!((a + b) + c, a + (b + c)); // ordinary doubles differ here in the last digit
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantum {
    spacing: f64,
    /// 1 / spacing, exact.
    inverse: f64,
    shift: f64,
}

impl Quantum {
    /// The finest lattice on which every number of magnitude up to `largest` is rounded correctly.
    ///
    /// # Panics
    /// If `largest` is not positive and finite.
    pub fn spanning(largest: f64) -> Self {
        assert!(largest > 0.0 && largest.is_finite(), "a lattice needs a positive, finite range");
        let mut range = 1.0_f64;
        while range < largest {
            range *= 2.0;
        }
        while range * 0.5 >= largest {
            range *= 0.5;
        }
        let spacing = range * 0.5_f64.powi(51);
        // Adding 1.5 * 2^52 spacings leaves no bits below one spacing; subtracting it again is exact.
        Self { spacing, inverse: 1.0 / spacing, shift: 1.5 * 2.0_f64.powi(52) * spacing }
    }

    /// Distance of two neighbouring lattice numbers.
    pub fn spacing(self) -> f64 {
        self.spacing
    }

    /// Numbers up to this magnitude are rounded correctly: 2^51 spacings.
    pub fn range(self) -> f64 {
        2.0_f64.powi(51) * self.spacing
    }

    /// The lattice number nearest to `value`; `round(-x)` is `-round(x)`.
    #[inline(always)]
    pub fn round(self, value: f64) -> f64 {
        (value + self.shift) - self.shift
    }

    /// Number by number.
    #[inline(always)]
    pub fn round_four<Q: F64x4>(self, values: Q) -> Q {
        let shift = Q::splat(self.shift);
        values.plus(shift).minus(shift)
    }

    /// Component by component.
    #[inline(always)]
    pub fn round_vector(self, value: Vector3<f64>) -> Vector3<f64> {
        Vector3::new(self.round(value.x), self.round(value.y), self.round(value.z))
    }

    /// The integer k of a lattice number `k * spacing`.
    #[inline(always)]
    pub fn count(self, multiple: f64) -> i64 {
        (multiple * self.inverse) as i64
    }
}

/// Whether every component lies within `limit`; not so if one is undefined.
#[inline(always)]
pub fn within(vector: &Vector3<f64>, limit: f64) -> bool {
    vector.x.abs() <= limit && vector.y.abs() <= limit && vector.z.abs() <= limit
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn range_covers_what_was_asked_for_and_no_more_than_twice() {
        for largest in [1.0e-12, 0.7, 1.0, 1.1, 5.0e9] {
            let range = Quantum::spanning(largest).range();
            assert!(range >= largest && range < 2.0 * largest);
        }
    }

    proptest! {
        #[test]
        fn rounding_is_odd_and_within_half_a_spacing(x in -1.0e4..1.0e4f64) {
            let quantum = Quantum::spanning(1.0e4);
            prop_assert_eq!(quantum.round(-x), -quantum.round(x));
            prop_assert!((quantum.round(x) - x).abs() <= 0.5 * quantum.spacing());
            prop_assert_eq!(quantum.count(quantum.round(x)) as f64 * quantum.spacing(), quantum.round(x));
        }

        #[test]
        fn sums_do_not_depend_on_order(mut values in prop::collection::vec(-1.0e3..1.0e3f64, 2..60)) {
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
    fn ordinary_sums_do_depend_on_order() {
        // Negative control: without rounding to a lattice the test above would fail.
        let values = [0.1, -700.3, 1.0e-7, 699.9];
        let forwards: f64 = values.iter().sum();
        let backwards: f64 = values.iter().rev().sum();
        assert_ne!(forwards, backwards);
    }
}
