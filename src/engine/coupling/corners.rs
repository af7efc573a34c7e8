//! Deposition and interpolation at one point.

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
    /// The corners in the memory of fields of the shape of `field`.
    #[inline(always)]
    pub(crate) fn of(weights: &CellWeights, field: &Field) -> Self {
        let corners = weights.corners();
        Self {
            places: corners.map(|(cell, _)| field.index(cell) as u32),
            weights: corners.map(|(_, weight)| weight),
        }
    }

    /// The smallest range that contains the places of all of these.
    pub(crate) fn places_of(all: &[Self]) -> Range<usize> {
        let ends = all.iter().map(|corners| [corners.places[0], corners.places[7] + 1]);
        let around =
            |[start, end]: [u32; 2], [first, last]: [u32; 2]| [start.min(first), end.max(last)];
        ends.reduce(around).map_or(0..0, |[start, end]| start as usize..end as usize)
    }

    /// Place and weight of each cell.
    #[inline(always)]
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.places.iter().map(|&place| place as usize).zip(self.weights)
    }

    /// Sum of the squares of the weights: the share of its own contribution that a point interpolates back, 8/27 in the
    /// mean over a cell.
    pub(crate) fn own_share(&self) -> f64 {
        self.weights.iter().map(|weight| weight * weight).sum()
    }

    /// The weights of only the open cells of a round column, divided by their sum.
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

/// Adds amounts to the cells around a point, each share rounded to the field's quantum, so that their sums are exact.
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
