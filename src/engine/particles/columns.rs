//! Columns: quantities of particles that most runs do not have.

use super::ParticleRecord;
use crate::fields::{Field, Travel, groups};
use bytemuck::Pod;
use std::ops::Range;

/// The values of fields that come together, for each owned particle and, if they travel, for each ghost. They take
/// memory only after one of them is not zero, or after [`Column::hold`] is called.
#[derive(Clone, Debug)]
pub struct Column {
    /// Fields of a row, side by side.
    fields: Vec<Field>,
    /// Number of values in a row.
    width: usize,
    /// Number of rows.
    count: usize,
    /// All rows, or none while all are zero.
    values: Vec<f64>,
}

/// All columns of the particles: those of the built-in fields, then those of custom fields, one for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns(Vec<Column>);

/// The column of the force of a volume-averaged gas.
pub const GAS_FORCE: usize = columns_up_to("gas_force") - 1;
/// The column of the data of a particle on its agglomerate.
pub const AGGLOMERATE: usize = columns_up_to("agglomerate_diameter") - 1;
/// Number of columns of built-in fields.
const BUILT_IN: usize = columns_up_to("");

/// Number of columns of the built-in fields, up to and including the column of a given field; all of them if there is
/// no such field. Fields that come together share a column.
const fn columns_up_to(name: &str) -> usize {
    let fields = ParticleRecord::FIELDS;
    let (mut columns, mut field) = (0, 0);
    while field < fields.len() {
        let joins = field > 0 && fields[field].comes_together_with(&fields[field - 1]);
        columns += (fields[field].in_column && !joins) as usize;
        if fields[field].has_name(name) {
            return columns;
        }
        field += 1;
    }
    columns
}

impl Default for Columns {
    fn default() -> Self {
        let built_in = column_groups().map(|fields| Column::of(&ParticleRecord::FIELDS[fields]));
        Self(built_in.collect())
    }
}

/// Range of each built-in column's fields in the list of fields.
pub(super) fn column_groups() -> impl Iterator<Item = Range<usize>> {
    let are_columns = |range: &Range<usize>| ParticleRecord::FIELDS[range.start].in_column;
    groups(ParticleRecord::FIELDS).map(|(_, range)| range).filter(are_columns)
}

impl Columns {
    /// A column by its number.
    #[inline(always)]
    pub fn at(&self, number: usize) -> &Column {
        &self.0[number]
    }

    /// Mutable access to a column.
    #[inline(always)]
    pub fn at_mut(&mut self, number: usize) -> &mut Column {
        &mut self.0[number]
    }

    /// Number of the column of a custom field with this kind of travel.
    pub(crate) fn number_of_own(&self, name: &str, travel: Travel) -> Option<usize> {
        let is_it = |column: &Column| column.fields[0].name == name && column.travel() == travel;
        Some(BUILT_IN + self.0[BUILT_IN..].iter().position(is_it)?)
    }

    /// Number of the column of a field.
    pub fn number_of(&self, name: &str) -> Option<usize> {
        self.0.iter().position(|column| column.fields.iter().any(|field| field.name == name))
    }

    /// The columns of custom fields; what is returned at each step is none of them, since it is zero between steps.
    pub fn custom(&self) -> impl Iterator<Item = &Column> {
        self.0[BUILT_IN..].iter().filter(|column| column.travel() != Travel::Returned)
    }

    /// Numbers that a particle has in them.
    pub(crate) fn custom_width(&self) -> usize {
        self.custom().map(|column| column.width).sum()
    }

    pub(super) fn own_mut(&mut self) -> impl Iterator<Item = &mut Column> {
        self.0[BUILT_IN..].iter_mut().filter(|column| column.travel() != Travel::Returned)
    }

    /// Adds a column of zeros for a custom field. There must be no ghosts.
    pub fn add(&mut self, field: Field) {
        let count = self.0[GAS_FORCE].count;
        self.0.push(Column { count, ..Column::of(&[field]) });
    }

    /// Number of values of a particle in columns with this kind of travel.
    pub(crate) fn width_of(&self, travel: Travel) -> usize {
        let travelling = self.0.iter().filter(|column| column.travel() == travel);
        travelling.map(|column| column.width).sum()
    }

    /// Adds an owned particle, with zeros.
    pub(super) fn push(&mut self) {
        self.0.iter_mut().for_each(Column::push);
    }

    /// Adds a ghost, with zeros, in columns that ghosts have.
    pub(super) fn push_ghost(&mut self) {
        self.0.iter_mut().filter(|column| column.has_ghosts()).for_each(Column::push);
    }

    /// Keeps this number of particles, ghosts included.
    pub(super) fn truncate(&mut self, count: usize) {
        self.0.iter_mut().for_each(|column| column.truncate(count));
    }

    /// Copies the values of a ghost to the place of another.
    pub(super) fn copy_ghost(&mut self, from: usize, to: usize) {
        self.0.iter_mut().filter(|column| column.has_ghosts()).for_each(|column| {
            let row = column.row(from);
            if let Some(start) = row.first().map(|_| from * column.width) {
                column.values.copy_within(start..start + column.width, to * column.width);
            }
        });
    }

    /// Keeps the owned particles `order[0], order[1], ...`, in that order.
    pub(super) fn select(&mut self, order: &[u32]) {
        self.0.iter_mut().for_each(|column| column.select(order));
    }
}

impl Column {
    fn of(fields: &[Field]) -> Self {
        let width = fields.iter().map(Field::width).sum();
        Self { fields: fields.to_vec(), width, count: 0, values: Vec::new() }
    }

    /// Fields of a row, side by side.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// Number of values in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Kind of travel of its first field; fields that come together have the same kind.
    fn travel(&self) -> Travel {
        self.fields[0].travel
    }

    fn has_ghosts(&self) -> bool {
        self.travel() != Travel::Stays
    }

    /// The numbers of a particle; none while all are zero.
    #[inline(always)]
    pub fn row(&self, index: usize) -> &[f64] {
        self.values.get(index * self.width..(index + 1) * self.width).unwrap_or_default()
    }

    /// The value of a particle.
    #[inline(always)]
    pub fn get<T: Pod>(&self, index: usize) -> T {
        debug_assert!(index < self.count, "the particle has the value");
        self.held().get(index).copied().unwrap_or_else(T::zeroed)
    }

    /// Sets the value of a particle.
    pub fn set<T: Pod>(&mut self, index: usize, value: T) {
        self.set_row(index, bytemuck::cast_slice(&[value]));
    }

    /// Sets the numbers of a particle.
    pub fn set_row(&mut self, index: usize, row: &[f64]) {
        // Bits are compared, since the digest of a state distinguishes -0 from +0.
        let is_zero = row.iter().all(|number| number.to_bits() == 0);
        if !(is_zero && self.values.is_empty()) {
            self.hold_numbers()[index * row.len()..][..row.len()].copy_from_slice(row);
        }
    }

    /// Mutable access to the values of all particles; allocates them if necessary.
    pub fn hold<T: Pod>(&mut self) -> &mut [T] {
        bytemuck::cast_slice_mut(self.hold_numbers())
    }

    fn hold_numbers(&mut self) -> &mut [f64] {
        self.values.resize(self.count * self.width, 0.0);
        &mut self.values
    }

    /// The values of all particles; empty while all are zero.
    #[inline(always)]
    pub fn held<T: Pod>(&self) -> &[T] {
        bytemuck::cast_slice(&self.values)
    }

    /// The values of all particles.
    pub fn iter<T: Pod>(&self) -> impl Iterator<Item = T> + '_ {
        (0..self.count).map(|index| self.get(index))
    }

    /// Sets all values to zero.
    pub fn reset(&mut self) {
        self.values = Vec::new();
    }

    fn push(&mut self) {
        self.count += 1;
        if !self.values.is_empty() {
            self.values.resize(self.count * self.width, 0.0);
        }
    }

    /// Keeps the first particles. The memory is kept for later ones.
    fn truncate(&mut self, count: usize) {
        self.count = self.count.min(count);
        self.values.truncate(self.count * self.width);
    }

    fn select(&mut self, order: &[u32]) {
        self.count = order.len();
        if !self.values.is_empty() {
            let row = |&index: &u32| &self.values[index as usize * self.width..][..self.width];
            self.values = order.iter().flat_map(row).copied().collect();
        }
    }
}

impl PartialEq for Column {
    fn eq(&self, other: &Self) -> bool {
        let number = |column: &Self, place: usize| column.values.get(place).copied().unwrap_or(0.0);
        (&self.fields, self.count) == (&other.fields, other.count)
            && (0..self.count * self.width).all(|at| number(self, at) == number(other, at))
    }
}

impl Columns {
    /// Appends the numbers of a particle in the columns with this kind of travel.
    pub(crate) fn append_row(&self, travel: Travel, index: usize, numbers: &mut Vec<f64>) {
        for column in self.0.iter().filter(|column| column.travel() == travel) {
            match column.row(index) {
                [] => numbers.resize(numbers.len() + column.width, 0.0),
                row => numbers.extend_from_slice(row),
            }
        }
    }

    /// Sets the numbers of a particle in the columns with this kind of travel.
    pub(crate) fn set_row(&mut self, travel: Travel, index: usize, mut row: &[f64]) {
        for column in self.0.iter_mut().filter(|column| column.travel() == travel) {
            let (of_column, rest) = row.split_at(column.width);
            column.set_row(index, of_column);
            row = rest;
        }
    }

    /// Adds numbers to those of a particle in the columns that are returned.
    pub(crate) fn add_returned(&mut self, index: usize, mut row: &[f64]) {
        for column in self.0.iter_mut().filter(|column| column.travel() == Travel::Returned) {
            let (of_column, rest) = row.split_at(column.width);
            let sums = column.hold_numbers()[index * of_column.len()..].iter_mut();
            sums.zip(of_column).for_each(|(sum, number)| *sum += number);
            row = rest;
        }
    }

    /// Moves the numbers of a ghost from the returned columns into a row, to which they are added.
    pub(crate) fn take_returned(&mut self, index: usize, row: &mut [f64]) {
        let mut sums = row.iter_mut();
        for column in self.0.iter_mut().filter(|column| column.travel() == Travel::Returned) {
            let range = index * column.width..(index + 1) * column.width;
            for number in column.values.get_mut(range).unwrap_or_default() {
                sums.next().into_iter().for_each(|sum| *sum += *number);
                *number = 0.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fields::{Kind, Unit};

    fn column(values: &[f64]) -> Column {
        let mut column = Column::of(&[Field::new("number", Kind::Number, Unit::One, "a number")]);
        for (index, &value) in values.iter().enumerate() {
            column.push();
            column.set(index, value);
        }
        column
    }

    #[test]
    fn built_in_columns_are_where_loops_look_for_them() {
        let columns = Columns::default();
        assert_eq!((columns.0.len(), BUILT_IN), (2, 2));
        assert_eq!(columns.number_of("gas_force"), Some(GAS_FORCE));
        assert_eq!(columns.number_of("agglomerate_diameter"), Some(AGGLOMERATE));
        assert_eq!([GAS_FORCE, AGGLOMERATE].map(|number| columns.at(number).width()), [3, 3]);
    }

    #[test]
    fn zeros_take_no_memory_and_are_as_those_that_do() {
        let mut zeros = column(&[0.0, 0.0]);
        assert_eq!(zeros.values.capacity(), 0);
        let before = zeros.clone();
        zeros.hold_numbers();
        assert_eq!((zeros.values.len(), &zeros), (2, &before));
        zeros.reset();
        assert_eq!((zeros.values.capacity(), zeros), (0, before));
    }

    #[test]
    fn values_are_found_again() {
        let mut values = column(&[0.0, 2.0, 0.0, 4.0]);
        assert!(values.iter::<f64>().eq([0.0, 2.0, 0.0, 4.0]));
        values.push();
        values.select(&[3, 4, 1]);
        assert!(values.iter::<f64>().eq([4.0, 0.0, 2.0]));
        assert!(column(&[1.0]) != column(&[0.0]), "the comparison sees values");
        values.truncate(0);
        assert_eq!(values.iter::<f64>().count(), 0);
    }

    #[test]
    fn the_sign_of_a_zero_is_kept() {
        let values = column(&[0.0, -0.0]);
        assert!(values.iter::<f64>().map(f64::is_sign_negative).eq([false, true]));
    }
}
