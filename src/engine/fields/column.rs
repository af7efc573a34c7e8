//! What a column of numbers is, in any file of results.

use super::{Field, Unit};
use std::borrow::Cow;

/// A column of a table, a snapshot or an image: what its numbers are, but not the numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name in the file.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// Shape of the entry in a row; empty for one number.
    pub shape: Cow<'static, [usize]>,
    /// The fixed arrays along which its first dimensions run, such as the heights.
    pub along: &'static [&'static str],
    /// Its meaning.
    pub meaning: &'static str,
}

impl Column {
    /// A number in each row.
    pub const fn scalar(name: &'static str, unit: Unit, meaning: &'static str) -> Self {
        Self { name, unit, shape: Cow::Borrowed(&[]), along: &[], meaning }
    }

    /// Three numbers in each row, along x, y and z.
    pub const fn vector(name: &'static str, unit: Unit, meaning: &'static str) -> Self {
        Self { name, unit, shape: Cow::Borrowed(&[3]), along: &[], meaning }
    }

    /// An array of numbers in each row.
    pub fn array(name: &'static str, shape: &[usize], unit: Unit, meaning: &'static str) -> Self {
        Self { name, unit, shape: Cow::Owned(shape.to_vec()), along: &[], meaning }
    }

    /// The column of a field.
    pub fn of_field(field: &Field) -> Self {
        let shape: &[usize] = if field.width() == 1 { &[] } else { &[field.width()] };
        Self::array(field.name, shape, field.unit, field.meaning)
    }

    /// This column with its first dimensions along these fixed arrays.
    #[must_use]
    pub fn along(self, fixed: &'static [&'static str]) -> Self {
        Self { along: fixed, ..self }
    }

    /// Number of values in an entry.
    pub fn width(&self) -> usize {
        self.shape.iter().product()
    }
}
