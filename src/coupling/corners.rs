//! Deposition and interpolation at one point, and means between cells and their faces.

use crate::grid::{CellWeights, ColumnOnCells, Field};
use crate::numbers::Quantum;
use std::ops::Range;

/// The eight cells around a point, x fastest: places in the memory of fields of one shape, and weights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corners {
    places: [u32; 8],
    weights: [f64; 8],
}

impl Corners {
    /// For fields that are like `field`.
    #[inline(always)]
    pub(crate) fn of(weights: &CellWeights, field: &Field) -> Self {
        let corners = weights.corners();
        Self {
            places: corners.map(|(cell, _)| field.index(cell) as u32),
            weights: corners.map(|(_, weight)| weight),
        }
    }

    /// The least range that holds the places of all of these.
    pub(crate) fn places_of(all: &[Self]) -> Range<usize> {
        let ends = all.iter().map(|corners| [corners.places[0], corners.places[7] + 1]);
        let around =
            |[start, end]: [u32; 2], [first, last]: [u32; 2]| [start.min(first), end.max(last)];
        ends.reduce(around).map_or(0..0, |[start, end]| start as usize..end as usize)
    }

    /// Place and weight of each.
    #[inline(always)]
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.places.iter().map(|&place| place as usize).zip(self.weights)
    }

    /// The sum of the squares of the weights: what a point sees of what it gives, 8/27 in the mean over a cell.
    pub(crate) fn own_share(&self) -> f64 {
        self.weights.iter().map(|weight| weight * weight).sum()
    }

    /// The weights of the open cells of a round column alone, over their sum.
    pub(crate) fn in_column(mut self, column: &ColumnOnCells) -> Self {
        for (place, weight) in self.places.into_iter().zip(&mut self.weights) {
            if column.at(place as usize) == 0.0 {
                *weight = 0.0;
            }
        }
        let sum: f64 = self.weights.iter().sum();
        self.weights.iter_mut().for_each(|weight| *weight /= sum);
        self
    }
}

/// Adds amounts to the cells around a point, each share rounded to the field's lattice: their sums are exact.
#[inline(always)]
pub(crate) fn deposit<const N: usize>(
    fields: [&mut Field; N],
    quanta: [Quantum; N],
    corners: &Corners,
    amounts: [f64; N],
) {
    for ((field, quantum), amount) in fields.into_iter().zip(quanta).zip(amounts) {
        let values = field.values_mut();
        for (place, weight) in corners.iter() {
            values[place] += quantum.round(amount * weight);
        }
    }
}

/// The values of fields at a point, with the weights of [`deposit`]. Halos must be current.
#[inline(always)]
pub(crate) fn interpolate<const N: usize>(fields: [&Field; N], corners: &Corners) -> [f64; N] {
    fields.map(|field| {
        let mut sum = 0.0;
        for (place, weight) in corners.iter() {
            sum += weight * field.values()[place];
        }
        sum
    })
}

/// Sets each owned cell to the mean of a face field's values at its two faces along `axis`.
///
/// The gas averages two cells to a face, so that this is the adjoint.
pub(crate) fn mean_of_faces(faces: &Field, axis: usize, cells: &mut Field) {
    let (above, along_x) = (faces.strides()[axis], faces.count()[0]);
    for (from, to) in faces.rows().zip(cells.rows()) {
        for i in 0..along_x {
            let sum = faces.values()[from + i] + faces.values()[from + i + above];
            cells.values_mut()[to + i] = 0.5 * sum;
        }
    }
}

/// Sets each owned cell to the mean of a field's gradients at its two faces along `axis`: half the difference
/// of the cells above and below over the distance of cells. Halos must be current.
pub(crate) fn mean_gradient(field: &Field, axis: usize, distance: f64, cells: &mut Field) {
    let (stride, along_x) = (field.strides()[axis], field.count()[0]);
    let values = field.values();
    for (from, to) in field.rows().zip(cells.rows()) {
        for i in 0..along_x {
            let place = from + i;
            let above = (values[place + stride] - values[place]) / distance;
            let below = (values[place] - values[place - stride]) / distance;
            cells.values_mut()[to + i] = 0.5 * (above + below);
        }
    }
}

/// Replaces the gradient across a round column, as [`mean_gradient`] left it, in cells beside closed ones: there it is that
/// of the open side alone, as if the field went on linearly beyond the wall.
pub(crate) fn mend_gradient_at_wall(
    field: &Field,
    (axis, distance): (usize, f64),
    column: &ColumnOnCells,
    cells: &mut Field,
) {
    let (stride, along_x) = (field.strides()[axis], field.count()[0]);
    for row in field.rows() {
        for place in row..row + along_x {
            let is_open = |place: usize| column.at(place) > 0.0;
            let sides = [place - stride, place + stride].map(is_open);
            if !is_open(place) || sides == [true, true] {
                continue;
            }
            let values = field.values();
            let difference = match sides {
                [true, _] => values[place] - values[place - stride],
                [_, true] => values[place + stride] - values[place],
                _ => 0.0,
            };
            cells.values_mut()[place] = difference / distance;
        }
    }
}
