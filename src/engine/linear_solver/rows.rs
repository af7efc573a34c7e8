//! Rows of cells: rows of owned cells in several fields at once, and rows of blocks.

use crate::grid::Field;
use bytemuck::Pod;
use std::ops::{AddAssign, Range};

/// Iterates over rows and gives the start of each as N numbers. It avoids nested iterators, which would take as long as
/// the work on a short row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows<I, const N: usize> {
    row: [I; N],
    layer: [I; N],
    /// Strides from a row to the next, and from a layer to the next.
    strides: [[I; N]; 2],
    rows_in_layer: usize,
    rows_left: usize,
    layers_left: usize,
}

/// The rows of fields on the same cells, whose halos may differ in width: for each field the index at which the row
/// starts. The order is that of [`Field::rows`].
#[inline(always)]
pub(super) fn rows<T: Pod, const N: usize>(fields: [&Field<T>; N]) -> Rows<usize, N> {
    let first = fields.map(|field| field.index([0; 3]));
    let [_, rows, layers] = fields[0].order().map(|axis| fields[0].count()[axis]);
    Rows {
        row: first,
        layer: first,
        strides: [1, 2].map(|place| fields.map(|field| field.strides()[field.order()[place]])),
        rows_in_layer: rows,
        rows_left: rows,
        layers_left: layers,
    }
}

/// The first cells of the rows of a block, in the order of memory.
#[inline(always)]
pub(super) fn row_starts(
    ranges: [Range<isize>; 3],
    [_, inner, outer]: [usize; 3],
) -> Rows<isize, 3> {
    let first = ranges.each_ref().map(|range| range.start);
    let one_along = |axis: usize| std::array::from_fn(|other| isize::from(other == axis));
    let [rows, layers] = [inner, outer].map(|axis| ranges[axis].len());
    Rows {
        row: first,
        layer: first,
        strides: [one_along(inner), one_along(outer)],
        rows_in_layer: rows,
        rows_left: rows,
        layers_left: if rows == 0 { 0 } else { layers },
    }
}

impl<I: Copy + AddAssign, const N: usize> Iterator for Rows<I, N> {
    type Item = [I; N];

    #[inline(always)]
    fn next(&mut self) -> Option<[I; N]> {
        if self.layers_left == 0 {
            return None;
        }
        let starts = self.row;
        self.rows_left -= 1;
        if self.rows_left == 0 {
            self.rows_left = self.rows_in_layer;
            self.layers_left -= 1;
            for number in 0..N {
                self.layer[number] += self.strides[1][number];
            }
            self.row = self.layer;
        } else {
            for number in 0..N {
                self.row[number] += self.strides[0][number];
            }
        }
        Some(starts)
    }
}

/// Copies the owned values of another field, whose halo may have another width.
pub(super) fn copy_owned(from: &Field, to: &mut Field) {
    let length = from.row_length();
    for [source, target] in rows([from, &*to]) {
        to.values_mut()[target..][..length].copy_from_slice(&from.values()[source..][..length]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{LocalCells, MEMORY_ORDERS};

    #[test]
    fn rows_have_the_order_of_field_rows_for_halos_of_any_width() {
        for order in MEMORY_ORDERS {
            let cells = LocalCells { counts: [9, 9, 9], start: [2, 0, 3], count: [4, 3, 2], order };
            let [narrow, wide] = [1, 2].map(|halo| Field::<f64>::new(&cells, halo));
            let expected: Vec<_> = narrow.rows().zip(wide.rows()).map(|(a, b)| [a, b]).collect();
            assert_eq!(rows([&narrow, &wide]).collect::<Vec<_>>(), expected);
        }
    }

    #[test]
    fn rows_start_in_the_order_in_which_they_lie_in_memory() {
        for order in MEMORY_ORDERS {
            let [along, inner, outer] = order;
            let mut ranges = [0..1, 0..1, 0..1];
            (ranges[along], ranges[inner], ranges[outer]) = (-2..5, -1..2, 3..5);
            let starts =
                row_starts(ranges.clone(), order).map(|start| order.map(|axis| start[axis]));
            let expected = (3..5).flat_map(|layer| (-1..2).map(move |row| [-2, row, layer]));
            assert!(starts.eq(expected));
            for axis in [inner, outer] {
                let mut none = ranges.clone();
                none[axis] = 0..0;
                assert_eq!(row_starts(none, order).count(), 0);
            }
        }
    }
}
