//! Custom fields, which are stored separately from the records of particles.

use super::Particles;
use crate::fields::Field;

/// Fields that a user has registered, and their numbers: a row for each particle, in the order of the corresponding
/// records.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CustomFields {
    /// The fields, side by side in a row.
    pub fields: Vec<Field>,
    /// The rows, one after another.
    pub numbers: Vec<f64>,
}

impl CustomFields {
    /// Number of values in a row.
    pub fn width(&self) -> usize {
        self.fields.iter().map(Field::width).sum()
    }

    /// The numbers of a particle.
    pub fn row(&self, index: usize) -> &[f64] {
        &self.numbers[index * self.width()..][..self.width()]
    }

    /// A copy with rows of zeros added, up to this number of particles.
    #[must_use]
    pub fn extended(&self, particles: usize) -> Self {
        let mut extended = self.clone();
        extended.numbers.resize(particles * self.width(), 0.0);
        extended
    }

    /// The rows of these particles, in this order.
    #[must_use]
    pub fn select(&self, order: impl Iterator<Item = usize>) -> Self {
        let numbers = order.flat_map(|index| self.row(index)).copied().collect();
        Self { fields: self.fields.clone(), numbers }
    }

    /// Adds a field with its numbers for each particle, one after another; all other fields of particles that have no
    /// row yet are zero.
    pub fn push(&mut self, field: Field, numbers: &[f64]) {
        let before = self.extended(numbers.len() / field.width());
        let rows = numbers.chunks_exact(field.width()).enumerate();
        let all = rows.flat_map(|(index, numbers)| before.row(index).iter().chain(numbers));
        self.numbers = all.copied().collect();
        self.fields.push(field);
    }

    /// The numbers of one field, particle after particle.
    pub fn column(&self, field: usize) -> Vec<f64> {
        let first: usize = self.fields[..field].iter().map(Field::width).sum();
        let end = first + self.fields[field].width();
        let rows = self.numbers.chunks_exact(self.width().max(1));
        rows.flat_map(|row| &row[first..end]).copied().collect()
    }
}

impl Particles {
    /// The custom fields of the owned particles.
    pub fn custom_fields(&self) -> CustomFields {
        let fields: Vec<Field> =
            self.columns.custom().flat_map(|column| column.fields()).copied().collect();
        let mut numbers = Vec::new();
        if !fields.is_empty() {
            (0..self.owned_count()).for_each(|index| self.append_custom_row(index, &mut numbers));
        }
        CustomFields { fields, numbers }
    }

    /// Appends the numbers of a particle in custom fields.
    pub(crate) fn append_custom_row(&self, index: usize, numbers: &mut Vec<f64>) {
        for column in self.columns.custom() {
            match column.row(index) {
                [] => numbers.resize(numbers.len() + column.width(), 0.0),
                row => numbers.extend_from_slice(row),
            }
        }
    }

    /// Sets the numbers of a particle in custom fields.
    pub fn set_custom_row(&mut self, index: usize, mut row: &[f64]) {
        for column in self.columns.own_mut() {
            let (of_column, rest) = row.split_at(column.width());
            column.set_row(index, of_column);
            row = rest;
        }
    }
}
