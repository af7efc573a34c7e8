//! Ranges of numbers, and their description in sentences.

use std::fmt;

/// A range of numbers that a key may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allowed {
    lowest: f64,
    lowest_itself: bool,
    highest: f64,
    highest_itself: bool,
}

impl Allowed {
    /// Largest magnitude: larger ones, and non-zero ones below its inverse, would overflow in products.
    const LARGEST: f64 = 1.0e30;

    /// The lower bound, and whether it is itself allowed; minus infinity if there is none.
    pub fn lower(self) -> (f64, bool) {
        (self.lowest, self.lowest_itself)
    }

    /// The upper bound, and whether it is itself allowed; infinity if there is none.
    pub fn upper(self) -> (f64, bool) {
        (self.highest, self.highest_itself)
    }

    /// Any finite number.
    pub const FINITE: Self = Self::of(f64::NEG_INFINITY, false, f64::INFINITY, false);
    /// Above 0.
    pub const POSITIVE: Self = Self::of(0.0, false, f64::INFINITY, false);
    /// At least 0.
    pub const NOT_NEGATIVE: Self = Self::of(0.0, true, f64::INFINITY, false);
    /// Above 0 and at most 1.
    pub const FRACTION: Self = Self::of(0.0, false, 1.0, true);

    const fn of(lowest: f64, lowest_itself: bool, highest: f64, highest_itself: bool) -> Self {
        Self { lowest, lowest_itself, highest, highest_itself }
    }

    /// At least `lowest`.
    pub const fn at_least(lowest: f64) -> Self {
        Self::of(lowest, true, f64::INFINITY, false)
    }

    /// Above 0 and at most `highest`.
    pub const fn positive_up_to(highest: f64) -> Self {
        Self::of(0.0, false, highest, true)
    }

    /// At least `lowest` and below `highest`.
    pub const fn from_to_below(lowest: f64, highest: f64) -> Self {
        Self::of(lowest, true, highest, false)
    }

    /// At least `lowest` and at most `highest`.
    pub const fn between(lowest: f64, highest: f64) -> Self {
        Self::of(lowest, true, highest, true)
    }

    /// Whether a number is in the range.
    pub fn contains(self, number: f64) -> bool {
        let above = number > self.lowest || (self.lowest_itself && number == self.lowest);
        let below = number < self.highest || (self.highest_itself && number == self.highest);
        above && below
    }

    /// Whether a number is allowed.
    ///
    /// # Errors
    /// A description of the allowed range, if the number is outside it.
    pub fn check(self, number: f64) -> Result<(), String> {
        if !self.contains(number) {
            return Err(self.to_string());
        }
        let magnitude = number.abs();
        if magnitude > Self::LARGEST || (magnitude != 0.0 && magnitude < 1.0 / Self::LARGEST) {
            return Err(format!("{self}, of a magnitude between 1e-30 and 1e30"));
        }
        Ok(())
    }
}

/// A number of a table in the usual form: with an exponent if it is small.
pub(super) fn short(number: f64) -> String {
    if number != 0.0 && number.abs() < 1.0e-3 { format!("{number:e}") } else { number.to_string() }
}

impl fmt::Display for Allowed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lower = if self.lowest_itself { "at least" } else { "above" };
        let upper = if self.highest_itself { "at most" } else { "below" };
        let [lowest, highest] = [self.lowest, self.highest].map(short);
        match (self.lowest.is_finite(), self.highest.is_finite()) {
            (false, false) => write!(formatter, "a finite number"),
            (true, false) => write!(formatter, "{lower} {lowest}"),
            (false, true) => write!(formatter, "{upper} {highest}"),
            (true, true) => {
                write!(formatter, "{lower} {lowest} and {upper} {highest}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Allowed;

    #[test]
    fn ranges_know_their_ends_and_refuse_what_is_no_number() {
        assert!(Allowed::FRACTION.check(1.0).is_ok());
        assert_eq!(Allowed::FRACTION.check(0.0).unwrap_err(), "above 0 and at most 1");
        assert_eq!(Allowed::POSITIVE.check(f64::NAN).unwrap_err(), "above 0");
        assert_eq!(Allowed::FINITE.check(f64::INFINITY).unwrap_err(), "a finite number");
        assert!(Allowed::POSITIVE.check(1.0e31).unwrap_err().contains("1e30"));
        assert!(Allowed::POSITIVE.check(1.0e-300).is_err());
        assert!(Allowed::NOT_NEGATIVE.check(-0.0).is_ok());
        assert_eq!(Allowed::from_to_below(0.0, 1.0).to_string(), "at least 0 and below 1");
    }
}
