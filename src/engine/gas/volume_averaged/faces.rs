//! Cells and faces on which a rank works, as rows in memory.

use super::VolumeAveragedGas;
use crate::domain::BoxFace;
use crate::grid::{Field, LocalCells};
use std::ops::Range;

/// Number of cells in a block of layers. The ten fields on which forces depend then take 320 KB, less than second-level
/// caches.
const CELLS_IN_BLOCK: usize = 4096;

/// Layers of cells or of their lower faces, in the order of memory.
#[derive(Clone, Debug)]
pub(super) struct Layers {
    axis: usize,
    places: Range<isize>,
}

impl Layers {
    /// All layers of faces of a part, including those of the upper end.
    pub(super) fn all(part: &LocalCells) -> Self {
        let axis = part.order[2];
        Self { axis, places: 0..part.count[axis] as isize + 1 }
    }

    /// All layers of faces of a part in blocks, so that successive operations on a block find it in a cache.
    pub(super) fn blocks(part: &LocalCells) -> impl Iterator<Item = Self> {
        let Self { axis, places } = Self::all(part);
        let [row, rows, _] = part.order.map(|axis| part.count[axis]);
        let (thickness, end) = ((CELLS_IN_BLOCK / (row * rows)).max(1), places.end);
        let starts = places.step_by(thickness);
        starts.map(move |first| Self { axis, places: first..end.min(first + thickness as isize) })
    }
}

/// A block of cells (or of their lower faces), counted from the part's first one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    pub(super) from: [isize; 3],
    pub(super) to: [isize; 3],
}

impl Region {
    /// The owned cells.
    pub(super) fn owned(part: &LocalCells) -> Self {
        Self { from: [0; 3], to: part.count.map(|count| count as isize) }
    }

    /// The owned cells and `width` cells around them.
    pub(super) fn widened(part: &LocalCells, width: isize) -> Self {
        let to = part.count.map(|count| count as isize + width);
        Self { from: [-width; 3], to }
    }

    /// Faces normal to `axis` inside the box that this rank updates.
    pub(super) fn inner_faces(part: &LocalCells, axis: usize, gas: &VolumeAveragedGas) -> Self {
        let mut region = Self::owned(part);
        if part.at_ends(axis)[0] && !gas.is_periodic(axis) {
            region.from[axis] = 1;
        }
        region
    }

    /// The faces of [`Region::inner_faces`] and those in outlets: all faces whose velocity follows from momentum.
    pub(super) fn free_faces(part: &LocalCells, axis: usize, gas: &VolumeAveragedGas) -> Self {
        let mut region = Self::inner_faces(part, axis, gas);
        let [lower, upper] = part.at_ends(axis);
        if lower && gas.velocity_outside(BoxFace { axis, side: 0 }).is_some() {
            region.from[axis] = 0;
        }
        if upper && gas.velocity_outside(BoxFace { axis, side: 1 }).is_some() {
            region.to[axis] += 1;
        }
        region
    }

    /// The layer of this region at `place` along `axis`.
    pub(super) fn layer(mut self, axis: usize, place: isize) -> Self {
        (self.from[axis], self.to[axis]) = (place, place + 1);
        self
    }

    /// The first rows of the lines of rows along a direction across them, and the number of rows in a line; `None` if
    /// there are no rows.
    pub(super) fn lines(self, direction: usize) -> Option<(Self, usize)> {
        let count = self.to[direction] - self.from[direction];
        (count > 0).then(|| (self.layer(direction, self.from[direction]), count as usize))
    }

    /// The part of this region in these layers.
    pub(super) fn in_layers(mut self, Layers { axis, places }: &Layers) -> Self {
        self.from[*axis] = self.from[*axis].max(places.start);
        self.to[*axis] = self.to[*axis].min(places.end);
        self
    }

    /// Cells in a row of this region.
    #[inline(always)]
    pub(super) fn row_length(&self, field: &Field) -> usize {
        let axis = field.order()[0];
        (self.to[axis] - self.from[axis]).max(0) as usize
    }

    /// The cells of this region.
    pub(super) fn cells(self) -> impl Iterator<Item = [isize; 3]> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.from[axis]..self.to[axis]);
        z.flat_map(move |k| {
            let x = x.clone();
            y.clone().flat_map(move |j| x.clone().map(move |i| [i, j, k]))
        })
    }

    /// Places in memory of the rows.
    #[inline(always)]
    pub(super) fn rows(self, field: &Field) -> Rows {
        let first = field.index(self.from);
        let length = self.row_length(field);
        let [_, rows, layers] =
            field.order().map(|axis| (self.to[axis] - self.from[axis]).max(0) as usize);
        let [_, to_next_row, to_next_layer] = field.order().map(|axis| field.strides()[axis]);
        Rows {
            row: first,
            layer: first,
            length,
            strides: [to_next_row, to_next_layer],
            rows,
            rows_left: rows,
            layers_left: if rows > 0 { layers } else { 0 },
        }
    }
}

/// Rows of a region: for each, the places in memory of its cells. Nested iterators would take as long as the work on a
/// short row.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    /// Start of the next row, and of the first row of its layer.
    row: usize,
    layer: usize,
    length: usize,
    /// Strides from a row to the next, and from a layer to the next.
    strides: [usize; 2],
    /// Number of rows in a layer.
    rows: usize,
    rows_left: usize,
    layers_left: usize,
}

impl Iterator for Rows {
    type Item = Range<usize>;

    #[inline(always)]
    fn next(&mut self) -> Option<Range<usize>> {
        if self.layers_left == 0 {
            return None;
        }
        let start = self.row;
        self.rows_left -= 1;
        self.row += self.strides[0];
        if self.rows_left == 0 {
            self.layers_left -= 1;
            self.rows_left = self.rows;
            self.layer += self.strides[1];
            self.row = self.layer;
        }
        Some(start..start + self.length)
    }
}

/// Numbers of a row, moved in memory by `steps`.
#[inline(always)]
pub(super) fn moved<'a>(values: &'a [f64], row: &Range<usize>, steps: isize) -> &'a [f64] {
    let start = row.start.wrapping_add_signed(steps);
    &values[start..start + (row.end - row.start)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::MEMORY_ORDERS;

    #[test]
    fn rows_are_those_of_the_cells() {
        for order in MEMORY_ORDERS {
            let part = LocalCells { counts: [9, 9, 9], start: [2, 0, 3], count: [4, 3, 2], order };
            let field = Field::new(&part, 2);
            let owned = Region::owned(&part);
            for region in [owned, Region::widened(&part, 1), owned.layer(2, 1), owned.layer(1, -1)]
            {
                let mut cells: Vec<usize> = region.cells().map(|cell| field.index(cell)).collect();
                cells.sort_unstable();
                assert!(region.rows(&field).flatten().eq(cells), "{region:?}");
            }
            for axis in 0..3 {
                let mut empty = owned;
                empty.to[axis] = empty.from[axis];
                assert_eq!(empty.rows(&field).flatten().count(), 0);
            }
        }
    }

    #[test]
    fn blocks_of_layers_have_each_layer_of_faces_once() {
        // Less than a layer, a whole number of layers, and all layers in a block.
        for count in [[100, 100, 7], [32, 64, 9], [3, 4, 5]] {
            for order in MEMORY_ORDERS {
                let part = LocalCells { counts: count, start: [0; 3], count, order };
                let blocks: Vec<_> = Layers::blocks(&part).collect();
                assert!(blocks.iter().all(|block| block.axis == order[2]));
                let places = blocks.into_iter().flat_map(|block| block.places);
                assert!(places.eq(0..count[order[2]] as isize + 1), "{count:?}, {order:?}");
            }
        }
    }
}
