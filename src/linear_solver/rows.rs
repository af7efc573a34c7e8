//! Rows of owned cells in several fields at once.

use crate::grid::Field;
use bytemuck::Pod;

/// Iterates over the rows: for each field the index at which the row starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows<const N: usize> {
    row: [usize; N],
    layer: [usize; N],
    /// From a row to the next, and from a layer to the next.
    strides: [[usize; N]; 2],
    rows_in_layer: usize,
    rows_left: usize,
    layers_left: usize,
}

/// The rows of fields on the same cells, whose halos may differ in width. The order is that of [`Field::rows`], but
/// without its nested iterators, which take as long as the work on a short row.
#[inline(always)]
pub(super) fn rows<T: Pod, const N: usize>(fields: [&Field<T>; N]) -> Rows<N> {
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

impl<const N: usize> Iterator for Rows<N> {
    type Item = [usize; N];

    #[inline(always)]
    fn next(&mut self) -> Option<[usize; N]> {
        if self.layers_left == 0 {
            return None;
        }
        let starts = self.row;
        self.rows_left -= 1;
        if self.rows_left == 0 {
            self.rows_left = self.rows_in_layer;
            self.layers_left -= 1;
            for field in 0..N {
                self.layer[field] += self.strides[1][field];
            }
            self.row = self.layer;
        } else {
            for field in 0..N {
                self.row[field] += self.strides[0][field];
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
}
