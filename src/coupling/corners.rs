//! Deposition and interpolation at one point, and means between cells and their faces.

use crate::grid::{CellWeights, Field};
use crate::numbers::Quantum;

/// The eight cells around a point: places in the memory of fields of one shape, and weights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corners {
    places: [u32; 8],
    weights: [f64; 8],
}

impl Corners {
    /// For fields that are like `field`.
    pub(crate) fn of(weights: &CellWeights, field: &Field) -> Self {
        let corners = weights.corners();
        Self {
            places: corners.map(|(cell, _)| field.index(cell) as u32),
            weights: corners.map(|(_, weight)| weight),
        }
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
        for (place, weight) in corners.places.into_iter().zip(corners.weights) {
            values[place as usize] += quantum.round(amount * weight);
        }
    }
}

/// The values of fields at a point, with the weights of [`deposit`]. Halos must be current.
#[inline(always)]
pub(crate) fn interpolate<const N: usize>(fields: [&Field; N], corners: &Corners) -> [f64; N] {
    fields.map(|field| {
        let mut sum = 0.0;
        for (place, weight) in corners.places.into_iter().zip(corners.weights) {
            sum += weight * field.values()[place as usize];
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
