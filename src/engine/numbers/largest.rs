//! The largest of non-negative numbers, by their bits: integers are compared by vector instructions, whereas numbers
//! that may be undefined are compared one after another.

/// The largest number so far, initially zero.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Largest {
    bits: u64,
}

impl Largest {
    /// Adds a number. The bit patterns of positive numbers have the order of the numbers; those of infinity, of
    /// undefined (NaN) and of negative numbers are greater.
    #[inline(always)]
    pub(crate) fn add(&mut self, number: f64) {
        self.bits = self.bits.max((number + 0.0).to_bits()); // a zero has no sign
    }

    /// The largest number; infinity if a number was negative, infinite or undefined.
    #[inline(always)]
    pub(crate) fn value(self) -> f64 {
        if self.bits < f64::INFINITY.to_bits() { f64::from_bits(self.bits) } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn largest(numbers: &[f64]) -> f64 {
        let mut largest = Largest::default();
        numbers.iter().for_each(|&number| largest.add(number));
        largest.value()
    }

    #[test]
    fn the_largest_number_is_found_and_anything_undefined_is_infinite() {
        assert_eq!(largest(&[]), 0.0);
        assert_eq!(largest(&[0.0, -0.0]), 0.0);
        assert_eq!(largest(&[1.0, f64::MAX, 5e-324]), f64::MAX);
        for wrong in [f64::NAN, -f64::NAN, f64::INFINITY, -1.0, f64::NEG_INFINITY] {
            assert_eq!(largest(&[1.0, wrong, 2.0]), f64::INFINITY);
        }
    }
}
