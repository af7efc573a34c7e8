//! Values on the cells of a rank, with a halo around them.

use super::LocalCells;
use bytemuck::Pod;
use std::cmp::Ordering;
use std::ops::Range;

/// One value for each cell that a rank owns, and for each cell of a halo around them; x varies fastest. Values are in
/// double precision unless another type of number is named.
///
/// Local indices of owned cells run from 0 to count - 1 along each axis, those of the halo from -halo to -1 and from
/// count to count + halo - 1. A component of a vector on faces is stored with the cell above the face.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<T = f64> {
    count: [usize; 3],
    halo: usize,
    values: Vec<T>,
}

impl<T: Pod> Field<T> {
    /// Zero everywhere.
    pub fn new(cells: &LocalCells, halo: usize) -> Self {
        let size = cells.count.iter().map(|count| count + 2 * halo).product();
        Self { count: cells.count, halo, values: vec![T::zeroed(); size] }
    }

    /// Owned cells along each axis.
    pub fn count(&self) -> [usize; 3] {
        self.count
    }

    /// Width of the halo in cells.
    pub fn halo(&self) -> usize {
        self.halo
    }

    /// Differences of the indices of two cells that are neighbours along x, y and z.
    #[inline(always)]
    pub fn strides(&self) -> [usize; 3] {
        let along_x = self.count[0] + 2 * self.halo;
        [1, along_x, along_x * (self.count[1] + 2 * self.halo)]
    }

    /// Index into [`Field::values`] of a cell, given by its local indices.
    #[inline(always)]
    pub fn index(&self, cell: [isize; 3]) -> usize {
        let halo = self.halo as isize;
        debug_assert!((0..3).all(|a| -halo <= cell[a] && cell[a] < self.count[a] as isize + halo));
        let strides = self.strides();
        (0..3).map(|axis| (cell[axis] + halo) as usize * strides[axis]).sum()
    }

    /// The value of a cell.
    #[inline(always)]
    pub fn at(&self, cell: [isize; 3]) -> T {
        self.values[self.index(cell)]
    }

    /// Mutable access to the value of a cell.
    #[inline(always)]
    pub fn at_mut(&mut self, cell: [isize; 3]) -> &mut T {
        let index = self.index(cell);
        &mut self.values[index]
    }

    /// All values, halo included.
    #[inline(always)]
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Mutable access to all values, halo included.
    #[inline(always)]
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// Indices at which the rows of owned cells along x start; each row is `count()[0]` long.
    pub fn rows(&self) -> impl Iterator<Item = usize> + use<T> {
        let [_, along_y, along_z] = self.strides();
        let first = self.index([0; 3]);
        let [_, rows, layers] = self.count;
        (0..layers).flat_map(move |k| (0..rows).map(move |j| first + j * along_y + k * along_z))
    }

    /// The values of owned cells, x fastest, then y, then z.
    pub fn owned(&self) -> impl Iterator<Item = T> + '_ {
        let along_x = self.count[0];
        self.rows().flat_map(move |row| self.values[row..row + along_x].iter().copied())
    }

    /// Sets the values of owned cells, in the order of [`Field::owned`]. The halo is not changed.
    pub fn set_owned(&mut self, mut values: impl Iterator<Item = T>) {
        let along_x = self.count[0];
        for row in self.rows() {
            for (own, value) in self.values[row..row + along_x].iter_mut().zip(&mut values) {
                *own = value;
            }
        }
    }

    /// Ranges of indices of the rows in `layers` along `axis`. They include the halo along the axes before
    /// `axis` but not along those after it, so that a halo is filled axis by axis.
    pub fn slab(
        &self,
        axis: usize,
        layers: Range<isize>,
    ) -> impl Iterator<Item = Range<usize>> + use<T> {
        self.rows_within(std::array::from_fn(|other| match other.cmp(&axis) {
            Ordering::Less => self.with_halo(other),
            Ordering::Equal => (layers.start, layers.end),
            Ordering::Greater => (0, self.count[other] as isize),
        }))
    }

    /// Ranges of indices of the rows in `layers` along `axis`, with the halo along the other axes.
    pub fn layers(
        &self,
        axis: usize,
        layers: Range<isize>,
    ) -> impl Iterator<Item = Range<usize>> + use<T> {
        self.rows_within([0, 1, 2].map(|other| match other == axis {
            true => (layers.start, layers.end),
            false => self.with_halo(other),
        }))
    }

    fn with_halo(&self, axis: usize) -> (isize, isize) {
        let halo = self.halo as isize;
        (-halo, self.count[axis] as isize + halo)
    }

    /// Rows of the cells within ranges along x, y and z.
    fn rows_within(
        &self,
        [x, y, z]: [(isize, isize); 3],
    ) -> impl Iterator<Item = Range<usize>> + use<T> {
        let [_, along_y, along_z] = self.strides();
        let first = self.index([x.0, y.0, z.0]);
        let (length, rows, layers) = ((x.1 - x.0) as usize, y.1 - y.0, z.1 - z.0);
        let starts = (0..layers as usize)
            .flat_map(move |k| (0..rows as usize).map(move |j| first + j * along_y + k * along_z));
        starts.map(move |start| start..start + length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn local_cells() -> LocalCells {
        LocalCells { counts: [9, 9, 9], start: [2, 0, 3], count: [4, 3, 2] }
    }

    #[test]
    fn setting_owned_cells_does_not_change_the_halo() {
        let mut field = Field::new(&local_cells(), 2);
        field.set_owned((1..=24).map(f64::from));
        assert_eq!(field.owned().collect::<Vec<_>>(), (1..=24).map(f64::from).collect::<Vec<_>>());
        assert_eq!((field.at([0, 0, 0]), field.at([1, 0, 0])), (1.0, 2.0));
        assert_eq!((field.at([0, 1, 0]), field.at([3, 2, 1])), (5.0, 24.0));
        assert_eq!(field.values().iter().sum::<f64>(), 300.0);
        assert_eq!(field.at([-2, -2, -2]), 0.0);
    }

    #[test]
    fn slabs_include_the_halo_of_the_axes_before_their_own() {
        let field = Field::<f64>::new(&local_cells(), 1);
        let cells = |axis| -> usize { field.slab(axis, 0..1).map(|row| row.len()).sum() };
        assert_eq!([0, 1, 2].map(cells), [3 * 2, 6 * 2, 6 * 5]);
        let cells = |axis| -> usize { field.layers(axis, 0..1).map(|row| row.len()).sum() };
        assert_eq!([0, 1, 2].map(cells), [5 * 4, 6 * 4, 6 * 5]);
    }
}
