//! What a column of numbers is, in any file of results.

use super::{Field, Kind, Unit};
use std::borrow::Cow;

/// A column of a series, a table, a profile, a snapshot or an image.
///
/// A column that Talcum declares has a [`Unit`], whose name follows from the units of the case. A column that is read or
/// derived from a file has the name of its unit as a text, which is empty if there is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column<V = (), U = Unit> {
    /// Its name in the file.
    pub name: Cow<'static, str>,
    /// Its unit.
    pub unit: U,
    /// Shape of the entry in a row; empty for one number.
    pub shape: Cow<'static, [usize]>,
    /// The fixed arrays along which its first dimensions run, such as the heights.
    pub along: &'static [&'static str],
    /// Its meaning.
    pub meaning: Cow<'static, str>,
    /// Its values, or how to take them from a row; nothing if it is only declared.
    pub values: V,
}

impl Column {
    /// A number in each row.
    pub const fn scalar(name: &'static str, unit: Unit, meaning: &'static str) -> Self {
        Self::with(name, unit, &[], meaning, ())
    }

    /// Three numbers in each row, along x, y and z.
    pub const fn vector(name: &'static str, unit: Unit, meaning: &'static str) -> Self {
        Self::with(name, unit, &[3], meaning, ())
    }

    /// An array of numbers in each row.
    pub fn array(name: &'static str, shape: &[usize], unit: Unit, meaning: &'static str) -> Self {
        Self { shape: Cow::Owned(shape.to_vec()), ..Self::scalar(name, unit, meaning) }
    }
}

impl Column<Kind> {
    /// Numbers of a kind in each row.
    pub fn of_kind(name: &'static str, kind: Kind, unit: Unit, meaning: &'static str) -> Self {
        let shape: &[usize] = if kind.width() == 1 { &[] } else { &[kind.width()] };
        Column::array(name, shape, unit, meaning).holding(kind)
    }

    /// The column of a field.
    pub fn of_field(field: &Field) -> Self {
        Self::of_kind(field.name, field.kind, field.unit, field.meaning)
    }
}

impl<V> Column<V> {
    /// A column with its values.
    pub const fn with(
        name: &'static str,
        unit: Unit,
        shape: &'static [usize],
        meaning: &'static str,
        values: V,
    ) -> Self {
        let (name, meaning) = (Cow::Borrowed(name), Cow::Borrowed(meaning));
        Self { name, unit, shape: Cow::Borrowed(shape), along: &[], meaning, values }
    }
}

impl<V> Column<V, String> {
    /// A column without a unit.
    pub fn new(name: &str, meaning: &str, values: V) -> Self {
        let [name, meaning] = [name, meaning].map(|text| Cow::Owned(text.to_owned()));
        Self { name, unit: String::new(), shape: Cow::Borrowed(&[]), along: &[], meaning, values }
    }

    /// A column of numbers in a unit.
    pub fn numbers(name: &str, unit: &str, meaning: &str, numbers: Vec<f64>) -> Self
    where
        V: From<Vec<f64>>,
    {
        Self { unit: unit.to_owned(), ..Self::new(name, meaning, numbers.into()) }
    }
}

impl<V, U> Column<V, U> {
    /// This column with its first dimensions along these fixed arrays.
    #[must_use]
    pub fn along(self, fixed: &'static [&'static str]) -> Self {
        Self { along: fixed, ..self }
    }

    /// This column with other values.
    pub fn holding<W>(self, values: W) -> Column<W, U> {
        let Self { name, unit, shape, along, meaning, .. } = self;
        Column { name, unit, shape, along, meaning, values }
    }

    /// Number of values in an entry.
    pub fn width(&self) -> usize {
        self.shape.iter().product()
    }
}
