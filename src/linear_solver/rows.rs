//! Rows of owned cells along x, in several fields at once.

use crate::grid::Field;

/// Places in memory, one for each field, where a row begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows<const N: usize> {
    row: [usize; N],
    layer: [usize; N],
    /// Distances in memory along y and z.
    along: [[usize; N]; 2],
    rows_in_layer: usize,
    rows_left: usize,
    layers_left: usize,
}

/// The rows of fields on the same part, whose halos may differ. In the order of [`Field::rows`], but without its nested
/// iterators, which cost as much as short rows do.
#[inline(always)]
pub(super) fn rows<const N: usize>(fields: [&Field; N]) -> Rows<N> {
    let first = fields.map(|field| field.index([0; 3]));
    let [_, rows, layers] = fields[0].count();
    Rows {
        row: first,
        layer: first,
        along: [1, 2].map(|axis| fields.map(|field| field.strides()[axis])),
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
        let places = self.row;
        self.rows_left -= 1;
        if self.rows_left == 0 {
            self.rows_left = self.rows_in_layer;
            self.layers_left -= 1;
            for field in 0..N {
                self.layer[field] += self.along[1][field];
            }
            self.row = self.layer;
        } else {
            for field in 0..N {
                self.row[field] += self.along[0][field];
            }
        }
        Some(places)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::LocalCells;

    #[test]
    fn rows_are_those_of_each_field() {
        let part = LocalCells { counts: [9, 9, 9], start: [2, 0, 3], count: [4, 3, 2] };
        let [narrow, wide] = [1, 2].map(|halo| Field::new(&part, halo));
        let expected: Vec<_> = narrow.rows().zip(wide.rows()).map(|(a, b)| [a, b]).collect();
        assert_eq!(rows([&narrow, &wide]).collect::<Vec<_>>(), expected);
    }
}
