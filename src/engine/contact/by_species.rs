//! Values that differ between species, and between pairs of them.

use crate::particles::kind_of_species;

/// A value for each species, or one for all.
#[derive(Clone, Debug, PartialEq)]
pub struct BySpecies<T>(Vec<T>);

/// A value for each pair of species, the same from both sides, or one for all.
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::contact::ByPair;
/// let sums = ByPair::of_species(3, |one, other| 10 * one + other); // called with one <= other
/// assert_eq!((sums.of([2, 1]), sums.of([1, 2])), (&12, &12));
/// assert_eq!(ByPair::of_all(7).of([2, 1]), &7);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ByPair<T>(Vec<T>);

impl<T> BySpecies<T> {
    /// One value for all species.
    pub fn of_all(value: T) -> Self {
        Self(vec![value])
    }

    /// The values of species 0, 1, ... ; `None` if there are none.
    pub fn of_species(values: Vec<T>) -> Option<Self> {
        (!values.is_empty()).then_some(Self(values))
    }

    /// The value of a species.
    #[inline(always)]
    pub fn of(&self, species: usize) -> &T {
        &self.0[if self.0.len() == 1 { 0 } else { species }]
    }

    /// All values.
    pub fn values(&self) -> &[T] {
        &self.0
    }

    /// A new value computed from each value.
    #[must_use]
    pub fn map<U>(&self, function: impl FnMut(&T) -> U) -> BySpecies<U> {
        BySpecies(self.0.iter().map(function).collect())
    }
}

impl<T> ByPair<T> {
    /// One value for all pairs.
    pub fn of_all(value: T) -> Self {
        Self(vec![value])
    }

    /// A value for each pair of this many species, at least one; `value` is called with the lower number first.
    pub fn of_species(count: usize, mut value: impl FnMut(usize, usize) -> T) -> Self {
        let pairs = (0..count).flat_map(|higher| (0..=higher).map(move |lower| (lower, higher)));
        let values: Vec<T> = pairs.map(|(lower, higher)| value(lower, higher)).collect();
        assert!(!values.is_empty(), "there is at least one species");
        Self(values)
    }

    /// Like [`ByPair::of_species`], but returns `None` unless there is a value for each pair; `value` is called for all
    /// of them.
    pub fn of_species_if(
        count: usize,
        value: impl FnMut(usize, usize) -> Option<T>,
    ) -> Option<Self> {
        let ByPair(values) = ByPair::of_species(count, value);
        values.into_iter().collect::<Option<_>>().map(Self)
    }

    /// The value of a pair of species.
    #[inline(always)]
    pub fn of(&self, [one, other]: [usize; 2]) -> &T {
        self.of_kind(kind_of_species(one, other))
    }

    /// The value of two particles of the same, first species.
    pub fn first(&self) -> &T {
        &self.0[0]
    }

    /// The value of a kind of pairs, by its number.
    #[inline(always)]
    pub(crate) fn of_kind(&self, kind: usize) -> &T {
        &self.0[if self.0.len() == 1 { 0 } else { kind }]
    }

    /// All values.
    pub fn values(&self) -> &[T] {
        &self.0
    }

    /// A new value computed from each value.
    #[must_use]
    pub fn map<U>(&self, function: impl FnMut(&T) -> U) -> ByPair<U> {
        ByPair(self.0.iter().map(function).collect())
    }
}
