//! Values on the cells of a rank, with a halo around them.

use super::LocalCells;
use bytemuck::Pod;
use std::cmp::Ordering;
use std::ops::Range;

/// One value for each cell that a rank owns, and for each cell of a halo around them, in the memory order of the cells
/// ([`LocalCells::order`]). Values are in double precision unless another type of number is given.
///
/// Local indices of owned cells run from 0 to count - 1 along each axis, those of the halo from -halo to -1 and from
/// count to count + halo - 1. A component of a vector on faces is stored with the cell above the face.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<T = f64> {
    count: [usize; 3],
    halo: usize,
    order: [usize; 3],
    strides: [usize; 3],
    values: Vec<T>,
}

impl<T: Pod> Field<T> {
    /// A field of zeros.
    pub fn new(cells: &LocalCells, halo: usize) -> Self {
        let LocalCells { count, order, .. } = *cells;
        let with_halo = count.map(|count| count + 2 * halo);
        let mut strides = [1; 3];
        strides[order[1]] = with_halo[order[0]];
        strides[order[2]] = with_halo[order[0]] * with_halo[order[1]];
        let size = with_halo.iter().product();
        Self { count, halo, order, strides, values: vec![T::zeroed(); size] }
    }

    /// Owned cells along each axis.
    pub fn count(&self) -> [usize; 3] {
        self.count
    }

    /// Width of the halo in cells.
    pub fn halo(&self) -> usize {
        self.halo
    }

    /// Order of the cells in memory: see [`LocalCells::order`].
    #[inline(always)]
    pub fn order(&self) -> [usize; 3] {
        self.order
    }

    /// Owned cells in a row.
    #[inline(always)]
    pub fn row_length(&self) -> usize {
        self.count[self.order[0]]
    }

    /// Differences of the indices of two neighbouring cells along x, y and z.
    #[inline(always)]
    pub fn strides(&self) -> [usize; 3] {
        self.strides
    }

    /// Index into [`Field::values`] of a cell, given by its local indices.
    #[inline(always)]
    pub fn index(&self, cell: [isize; 3]) -> usize {
        let halo = self.halo as isize;
        debug_assert!((0..3).all(|a| -halo <= cell[a] && cell[a] < self.count[a] as isize + halo));
        (0..3).map(|axis| (cell[axis] + halo) as usize * self.strides[axis]).sum()
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

    /// Indices at which the rows of owned cells start; each is [`Field::row_length`] long.
    pub fn rows(&self) -> impl Iterator<Item = usize> + use<T> {
        self.rows_within(self.count.map(|count| 0..count as isize)).map(|row| row.start)
    }

    /// The values of owned cells, x fastest, then y, then z, whatever their order in memory.
    pub fn owned(&self) -> impl Iterator<Item = T> + '_ {
        self.owned_indices().map(|index| self.values[index])
    }

    /// Sets the values of owned cells, in the order of [`Field::owned`]. The halo is not changed.
    pub fn set_owned(&mut self, values: impl Iterator<Item = T>) {
        for (index, value) in self.owned_indices().zip(values) {
            self.values[index] = value;
        }
    }

    fn owned_indices(&self) -> impl Iterator<Item = usize> + use<T> {
        let ([nx, ny, nz], [along_x, along_y, along_z]) = (self.count, self.strides);
        let first = self.index([0; 3]);
        (0..nz).flat_map(move |k| {
            let layer = first + k * along_z;
            (0..ny).flat_map(move |j| (0..nx).map(move |i| layer + j * along_y + i * along_x))
        })
    }

    /// Ranges of indices of the rows in `layers` along `axis`. They include the halo along the axes before
    /// `axis` but not along those after it, so that a halo is filled axis by axis.
    pub fn slab(
        &self,
        axis: usize,
        layers: Range<isize>,
    ) -> impl Iterator<Item = Range<usize>> + use<T> {
        let halo = self.halo as isize;
        self.rows_within(std::array::from_fn(|other| {
            let count = self.count[other] as isize;
            match other.cmp(&axis) {
                Ordering::Less => -halo..count + halo,
                Ordering::Equal => layers.clone(),
                Ordering::Greater => 0..count,
            }
        }))
    }

    /// Ranges of indices of the rows of the cells within ranges along x, y and z.
    pub fn rows_within(
        &self,
        ranges: [Range<isize>; 3],
    ) -> impl Iterator<Item = Range<usize>> + use<T> {
        let first = self.index([0, 1, 2].map(|axis| ranges[axis].start));
        let [length, rows, layers] = self.order.map(|axis| ranges[axis].len());
        let [_, to_next_row, to_next_layer] = self.order.map(|axis| self.strides[axis]);
        let starts = (0..layers).flat_map(move |layer| {
            (0..rows).map(move |row| first + row * to_next_row + layer * to_next_layer)
        });
        starts.map(move |start| start..start + length)
    }
}

#[cfg(test)]
mod tests {
    use super::super::MEMORY_ORDERS;
    use super::*;

    fn local_cells(order: [usize; 3]) -> LocalCells {
        LocalCells { counts: [9, 9, 9], start: [2, 0, 3], count: [4, 3, 2], order }
    }

    #[test]
    fn setting_owned_cells_does_not_change_the_halo() {
        for order in MEMORY_ORDERS {
            let mut field = Field::new(&local_cells(order), 2);
            field.set_owned((1..=24).map(f64::from));
            assert!(field.owned().eq((1..=24).map(f64::from)));
            assert_eq!((field.at([0, 0, 0]), field.at([1, 0, 0])), (1.0, 2.0));
            assert_eq!((field.at([0, 1, 0]), field.at([3, 2, 1])), (5.0, 24.0));
            assert_eq!(field.values().iter().sum::<f64>(), 300.0);
            assert_eq!(field.at([-2, -2, -2]), 0.0);
        }
    }

    #[test]
    fn cells_lie_in_memory_in_the_order_of_the_axes() {
        for order in MEMORY_ORDERS {
            let field = Field::<f64>::new(&local_cells(order), 1);
            assert_eq!(field.strides()[order[0]], 1);
            assert!(field.strides()[order[1]] < field.strides()[order[2]]);
            let mut owned: Vec<usize> = field.owned_indices().collect();
            owned.sort_unstable();
            let rows = field.rows().flat_map(|row| row..row + field.row_length());
            assert!(rows.eq(owned));
        }
    }

    #[test]
    fn slabs_include_the_halo_of_the_axes_before_their_own() {
        for order in MEMORY_ORDERS {
            let field = Field::<f64>::new(&local_cells(order), 1);
            let cells = |axis| -> usize { field.slab(axis, 0..1).map(|row| row.len()).sum() };
            assert_eq!([0, 1, 2].map(cells), [3 * 2, 6 * 2, 6 * 5]);
        }
    }
}
