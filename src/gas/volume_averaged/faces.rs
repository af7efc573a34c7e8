//! Which cells and faces a rank works on, as rows in memory.

use super::VolumeAveragedGas;
use crate::domain::BoxFace;
use crate::grid::{Field, LocalCells};
use std::ops::Range;

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

    /// The faces of [`Region::inner_faces`] and those in outlets: all whose velocity follows from momentum.
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

    /// The cells of this region.
    pub(super) fn cells(self) -> impl Iterator<Item = [isize; 3]> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.from[axis]..self.to[axis]);
        z.flat_map(move |k| {
            let x = x.clone();
            y.clone().flat_map(move |j| x.clone().map(move |i| [i, j, k]))
        })
    }

    /// Places in memory of the rows along x.
    pub(super) fn rows(self, field: &Field) -> impl Iterator<Item = Range<usize>> + use<> {
        let [_, along_y, along_z] = field.strides();
        let first = field.index(self.from);
        let [length, rows, layers] =
            [0, 1, 2].map(|axis| (self.to[axis] - self.from[axis]).max(0) as usize);
        (0..layers)
            .flat_map(move |k| (0..rows).map(move |j| first + j * along_y + k * along_z))
            .map(move |start| start..start + length)
    }
}

/// Numbers of a row, moved in memory by `steps` and `back`.
#[inline(always)]
pub(super) fn moved<'a>(values: &'a [f64], row: &Range<usize>, steps: isize) -> &'a [f64] {
    let start = row.start.wrapping_add_signed(steps);
    &values[start..start + row.len()]
}
