//! Ranges of numbers, with words for them.

use std::fmt;

/// A number for people: 9 digits.
pub(super) fn rounded(number: f64) -> f64 {
    format!("{number:.8e}").parse().unwrap_or(number)
}

/// A range of numbers that a key may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Allowed {
    lowest: f64,
    lowest_itself: bool,
    highest: f64,
    highest_itself: bool,
}

impl Allowed {
    /// Larger magnitudes, and smaller ones but 0, would overflow in products.
    const LARGEST: f64 = 1.0e30;

    /// Any finite number.
    pub(super) const FINITE: Self = Self::of(f64::NEG_INFINITY, false, f64::INFINITY, false);
    /// Above 0.
    pub(super) const POSITIVE: Self = Self::of(0.0, false, f64::INFINITY, false);
    /// At least 0.
    pub(super) const NOT_NEGATIVE: Self = Self::of(0.0, true, f64::INFINITY, false);
    /// Above 0 and at most 1.
    pub(super) const FRACTION: Self = Self::of(0.0, false, 1.0, true);

    const fn of(lowest: f64, lowest_itself: bool, highest: f64, highest_itself: bool) -> Self {
        Self { lowest, lowest_itself, highest, highest_itself }
    }

    /// At least `lowest`.
    pub(super) const fn at_least(lowest: f64) -> Self {
        Self::of(lowest, true, f64::INFINITY, false)
    }

    /// Above 0 and at most `highest`.
    pub(super) const fn positive_up_to(highest: f64) -> Self {
        Self::of(0.0, false, highest, true)
    }

    /// At least `lowest` and below `highest`.
    pub(super) const fn from_to_below(lowest: f64, highest: f64) -> Self {
        Self::of(lowest, true, highest, false)
    }

    /// At least `lowest` and at most `highest`.
    pub(super) const fn between(lowest: f64, highest: f64) -> Self {
        Self::of(lowest, true, highest, true)
    }

    /// What the number must be, if it is not allowed.
    pub(super) fn check(self, number: f64) -> Result<(), String> {
        let above = number > self.lowest || (self.lowest_itself && number == self.lowest);
        let below = number < self.highest || (self.highest_itself && number == self.highest);
        if !(above && below) {
            return Err(self.to_string());
        }
        let magnitude = number.abs();
        if magnitude > Self::LARGEST || (magnitude != 0.0 && magnitude < 1.0 / Self::LARGEST) {
            return Err(format!("{self}, of a magnitude between 1e-30 and 1e30"));
        }
        Ok(())
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lower = if self.lowest_itself { "at least" } else { "above" };
        let upper = if self.highest_itself { "at most" } else { "below" };
        match (self.lowest.is_finite(), self.highest.is_finite()) {
            (false, false) => write!(formatter, "a finite number"),
            (true, false) => write!(formatter, "{lower} {}", self.lowest),
            (false, true) => write!(formatter, "{upper} {}", self.highest),
            (true, true) => {
                write!(formatter, "{lower} {} and {upper} {}", self.lowest, self.highest)
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
