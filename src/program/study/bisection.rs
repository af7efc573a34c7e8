//! The search for the value of a key at which a quantity crosses a threshold.

use crate::study::quantity::Value;
use crate::study::setting::rounded;
use std::fmt;

/// Parameters of a search.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bisection {
    /// The key whose critical value is sought.
    pub(crate) key: String,
    /// Ranges in which the critical value is sought.
    pub(crate) brackets: Brackets,
    /// The search ends when the bracket is no wider.
    pub(crate) tolerance: f64,
    /// Name of the quantity that decides.
    pub(crate) quantity: String,
    /// The value of the quantity that is crossed.
    pub(crate) threshold: Threshold,
    /// What the quantity does as the key grows.
    pub(crate) direction: Direction,
    /// Whether brackets are halved on a logarithmic scale.
    pub(crate) logarithmic: bool,
    /// The line of the study file, from 1.
    pub(crate) line: usize,
}

/// What a quantity crosses.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Threshold {
    /// A number.
    Number(f64),
    /// A text: this text counts as 1, all others as 0.
    Text(String),
}

impl Threshold {
    /// The number that is crossed.
    fn number(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Text(_) => 0.5,
        }
    }

    /// The number that represents a measured value.
    ///
    /// # Errors
    /// If it is neither a number nor a text that could be the threshold.
    pub(crate) fn count(&self, value: &Value) -> Result<f64, String> {
        match (value, self) {
            (Value::Number(number), Self::Number(_)) if !number.is_nan() => Ok(*number),
            (Value::Text(text), Self::Text(wanted)) => Ok(f64::from(u8::from(text == wanted))),
            (Value::Number(number), _) => Err(format!("{number} cannot be compared with {self}")),
            (Value::Text(text), Self::Number(_)) => Err(format!("{text:?} is not a number")),
            (Value::Nothing(reason), _) => Err(reason.clone()),
        }
    }
}

impl fmt::Display for Threshold {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(formatter, "{number}"),
            Self::Text(text) => write!(formatter, "{text:?} (1 if it is that, 0 if not)"),
        }
    }
}

/// The brackets of the points of a study.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Brackets {
    /// One bracket for all points.
    One([f64; 2]),
    /// One for each position of an axis.
    Along {
        /// The axis.
        axis: usize,
        /// One bracket for each of its positions.
        brackets: Vec<[f64; 2]>,
    },
}

impl Brackets {
    /// All brackets.
    pub(crate) fn all(&self) -> &[[f64; 2]] {
        match self {
            Self::One(bracket) => std::slice::from_ref(bracket),
            Self::Along { brackets, .. } => brackets,
        }
    }

    /// The bracket of a point, from its positions on the axes.
    pub(crate) fn at(&self, positions: &[usize]) -> [f64; 2] {
        match self {
            Self::One(bracket) => *bracket,
            Self::Along { axis, brackets } => brackets[positions[*axis]],
        }
    }
}

/// Whether the quantity crosses its threshold upwards or downwards as the key grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// Below the threshold first, then above.
    Rises,
    /// Above the threshold first, then below.
    Falls,
}

impl Direction {
    /// Both, by the words of a study file.
    pub(crate) const ALL: [(&'static str, Self); 2] =
        [("rises", Self::Rises), ("falls", Self::Falls)];

    /// Its name in a study file.
    pub(crate) fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, known)| *known == self).map_or("", |(name, _)| name)
    }
}

/// Progress of a search.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Search {
    /// The quantity must be known at these values of the key first.
    Needs(Vec<f64>),
    /// The critical value lies between these two values of the key.
    Found([f64; 2]),
    /// The quantity is on one side of the threshold at both ends, or changes in the other direction.
    Unchanged {
        /// The ends of the bracket.
        bracket: [f64; 2],
        /// The quantity at the ends.
        measured: [f64; 2],
    },
}

impl Bisection {
    /// Goes through the search as far as the quantity is known. It depends on its values only, so that a search
    /// that was interrupted takes the same course again.
    pub(crate) fn search(
        &self,
        bracket: [f64; 2],
        quantity: &mut dyn FnMut(f64) -> Option<f64>,
    ) -> Search {
        let [mut lower, mut upper] = bracket;
        let ends = bracket.map(&mut *quantity);
        let [Some(at_lower), Some(at_upper)] = ends else {
            let unknown = bracket.into_iter().zip(ends).filter(|(_, known)| known.is_none());
            return Search::Needs(unknown.map(|(end, _)| end).collect());
        };
        if self.is_beyond(at_lower) || !self.is_beyond(at_upper) {
            return Search::Unchanged { bracket, measured: [at_lower, at_upper] };
        }
        while upper - lower > self.tolerance {
            let middle = self.middle(lower, upper);
            if middle <= lower || middle >= upper {
                break; // no number lies between
            }
            match quantity(middle) {
                None => return Search::Needs(vec![middle]),
                Some(value) if self.is_beyond(value) => upper = middle,
                Some(_) => lower = middle,
            }
        }
        Search::Found([lower, upper])
    }

    /// The value at which a bracket is halved, with twelve digits.
    pub(crate) fn middle(&self, lower: f64, upper: f64) -> f64 {
        rounded(if self.logarithmic { (lower * upper).sqrt() } else { 0.5 * (lower + upper) })
    }

    /// Whether a measured value is on the side of the threshold that belongs to large values of the key. NaN is on
    /// neither side, so it is not beyond.
    fn is_beyond(&self, value: f64) -> bool {
        match self.direction {
            Direction::Rises => value >= self.threshold.number(),
            Direction::Falls => value < self.threshold.number(),
        }
    }

    /// The reason why a search ended without a crossing.
    pub(crate) fn explain(&self, bracket: [f64; 2], measured: [f64; 2]) -> String {
        let Self { key, quantity, threshold, line, .. } = self;
        let [lower, upper] = bracket;
        let [at_lower, at_upper] = measured;
        let values = format!(
            "{quantity} is {at_lower} at {key} = {lower} and {at_upper} at {key} = {upper}"
        );
        let reversed = self.is_beyond(at_lower) && !self.is_beyond(at_upper);
        let other = match self.direction {
            Direction::Rises => Direction::Falls,
            Direction::Falls => Direction::Rises,
        };
        if reversed {
            format!(
                "[bisection] in line {line}: the criterion changes in the other direction: {values}; did you mean direction = \"{}\"?",
                other.name()
            )
        } else {
            format!(
                "[bisection] in line {line}: the criterion never changes over the bracket: {values}, both on one side of {threshold}; \
                 take another bracket or threshold"
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_counts_as_one_or_zero_and_must_be_comparable() {
        let frozen = Threshold::Text("frozen".to_owned());
        let text = |text: &str| Value::Text(text.to_owned());
        assert_eq!(frozen.count(&text("frozen")), Ok(1.0));
        assert_eq!(frozen.count(&text("waves")), Ok(0.0));
        assert!(frozen.count(&Value::Number(1.0)).unwrap_err().contains("cannot be compared"));
        let nothing = Value::Nothing("the bed has no waves".to_owned());
        assert_eq!(frozen.count(&nothing), Err("the bed has no waves".to_owned()));
        let five = Threshold::Number(5.0);
        assert_eq!(five.count(&Value::Number(7.0)), Ok(7.0));
        assert!(five.count(&Value::Number(f64::NAN)).is_err());
        // The bed freezes between 5 and 6: the search ends around it.
        let search = Bisection { threshold: frozen, direction: Direction::Rises, ..falling(0.5) };
        let state = |bond: f64| text(if bond > 5.3 { "frozen" } else { "waves" });
        let count = &mut |bond: f64| search.threshold.count(&state(bond)).ok();
        let Search::Found([lower, upper]) = search.search([2.0, 10.0], count) else { panic!() };
        assert!(lower <= 5.3 && 5.3 < upper && upper - lower <= 0.5, "{lower} {upper}");
    }

    fn falling(tolerance: f64) -> Bisection {
        Bisection {
            key: "cohesion.bond_number".to_owned(),
            brackets: Brackets::One([2.0, 10.0]),
            tolerance,
            quantity: "agitation".to_owned(),
            threshold: Threshold::Number(5.0),
            direction: Direction::Falls,
            logarithmic: false,
            line: 1,
        }
    }

    /// Follows a search to its end, one measurement after another; returns the number of measurements.
    fn follow(
        search: &Bisection,
        bracket: [f64; 2],
        truth: &dyn Fn(f64) -> f64,
    ) -> (Search, usize) {
        let mut known: Vec<(f64, f64)> = Vec::new();
        loop {
            let mut look_up =
                |x: f64| known.iter().find(|(value, _)| *value == x).map(|(_, measure)| *measure);
            match search.search(bracket, &mut look_up) {
                Search::Needs(values) => {
                    known.extend(values.into_iter().map(|value| (value, truth(value))));
                }
                end => return (end, known.len()),
            }
            assert!(known.len() < 100, "the search does not end");
        }
    }

    #[test]
    fn both_ends_are_asked_for_first() {
        let search = falling(0.5);
        assert_eq!(search.search([2.0, 10.0], &mut |_| None), Search::Needs(vec![2.0, 10.0]));
        let one = search.search([2.0, 10.0], &mut |x| (x == 2.0).then_some(9.0));
        assert_eq!(one, Search::Needs(vec![10.0]));
    }

    #[test]
    fn a_known_threshold_is_found_within_the_tolerance() {
        // The quantity 10 - x crosses 5 at x = 5; 8 / 0.1 needs 7 halvings after the two ends.
        let (end, runs) = follow(&falling(0.1), [2.0, 9.9], &|x| 10.0 - x);
        let Search::Found([lower, upper]) = end else { panic!("{end:?}") };
        assert!(lower <= 5.0 && 5.0 < upper && upper - lower <= 0.1, "{lower} {upper}");
        assert_eq!(runs, 9);
        let rises = Bisection { direction: Direction::Rises, ..falling(0.1) };
        let (end, _) = follow(&rises, [2.0, 9.9], &|x| x + 1.0);
        let Search::Found([lower, upper]) = end else { panic!("{end:?}") };
        assert!(lower < 4.0 && 4.0 <= upper, "{lower} {upper}");
    }

    #[test]
    fn on_a_logarithmic_scale_too() {
        let search = Bisection { logarithmic: true, ..falling(0.01) };
        let (end, _) = follow(&search, [0.01, 100.0], &|x| if x < 0.3 { 9.0 } else { 1.0 });
        let Search::Found([lower, upper]) = end else { panic!("{end:?}") };
        assert!(lower < 0.3 && 0.3 <= upper, "{lower} {upper}");
    }

    #[test]
    fn noise_moves_the_result_but_does_not_stop_the_search() {
        // Noise of +-1 moves the crossing of 10 - x with 5 by at most 1.
        let noise = |x: f64| libm::sin(1.0e4 * x);
        let (end, _) = follow(&falling(0.01), [2.0, 10.0], &|x| 10.0 - x + noise(x));
        let Search::Found([lower, upper]) = end else { panic!("{end:?}") };
        assert!(upper - lower <= 0.01 && lower > 3.9 && upper < 6.1, "{lower} {upper}");
    }

    #[test]
    fn a_criterion_that_never_changes_is_reported_as_soon_as_both_ends_are_known() {
        let search = falling(0.1);
        for constant in [9.0, 1.0] {
            let (end, runs) = follow(&search, [2.0, 10.0], &|_| constant);
            assert_eq!(runs, 2);
            let Search::Unchanged { bracket, measured } = end else { panic!("{end:?}") };
            let message = search.explain(bracket, measured);
            assert!(message.contains("never changes over the bracket"), "{message}");
        }
        let (end, runs) = follow(&search, [2.0, 10.0], &|x| x);
        let Search::Unchanged { bracket, measured } = end else { panic!("{end:?}") };
        assert_eq!(runs, 2);
        let message = search.explain(bracket, measured);
        assert!(message.contains("direction = \"rises\""), "{message}");
    }

    #[test]
    fn not_a_number_ends_the_search_at_once() {
        let (end, runs) = follow(&falling(0.1), [2.0, 10.0], &|_| f64::NAN);
        assert!(matches!(end, Search::Unchanged { .. }) && runs == 2, "{end:?}");
    }

    #[test]
    fn a_tolerance_below_the_spacing_of_numbers_ends() {
        let (end, _) = follow(&falling(1.0e-300), [2.0, 10.0], &|x| 10.0 - x);
        assert!(matches!(end, Search::Found(_)), "{end:?}");
    }
}
