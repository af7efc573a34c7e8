//! Interpolation along one axis from the pairs of cells, the coarse grid, to the cells, the fine grid. The weights
//! follow from the coefficients (operator-dependent interpolation, Alcouffe, Brandt, Dendy and Painter 1981).
//!
//! Cells 2m and 2m + 1 form a pair. Its value stands for the point midway between them, or for the cell itself if the
//! last cell is single. Let M be the pair of a cell c, and N the next pair beyond c. Three resistances lie in series
//! between M and N: half of the resistance inside each pair, and the resistance of the face between them. The cell lies
//! between the first two:
//!
//! ```math
//! p_c = (1 - t)\, p_M + t\, p_N, \qquad t = \frac{R}{R + 1/a + R'}, \qquad R = \frac{1}{2 a_\text{inside}}
//! ```
//!
//! t = 1/4 if all coefficients are equal.

use super::cell_pairs::{CellPairs, RowPlaces};
use super::operator::Coefficients;
use super::rows::rows;
use crate::grid::Field;
use crate::numbers::vectorised;

/// The weights of the interpolation along one axis.
#[derive(Clone, Debug)]
pub(super) struct Interpolation {
    pub(super) pairs: CellPairs,
    /// t of each fine cell, the weight of the next pair. The halo is two cells wide.
    pub(super) weight: Field<f32>,
    /// R of each fine cell, from its centre to the middle of its pair.
    pub(super) half_resistance: Field<f32>,
}

impl Interpolation {
    pub(super) fn new(pairs: CellPairs) -> Self {
        let zero = || Field::new(&pairs.fine, 2);
        Self { pairs, weight: zero(), half_resistance: zero() }
    }

    /// Sets R of owned cells. Before: halos of the coefficients are current.
    pub(super) fn set_half_resistance(&mut self, fine: &Coefficients<f32>) {
        set_half_resistance(self, fine);
        let Self { pairs, half_resistance, .. } = self;
        let last = pairs.fine.counts[pairs.axis] - 1;
        if last % 2 == 0 && pairs.fine.at_ends(pairs.axis)[1] {
            // The last cell is single: it is the middle of its pair.
            let layer = pairs.fine.count[pairs.axis] as isize - 1;
            let rows: Vec<_> = half_resistance.slab(pairs.axis, layer..layer + 1).collect();
            rows.into_iter().for_each(|row| half_resistance.values_mut()[row].fill(0.0));
        }
    }

    /// Sets t of owned cells. Before: halos of the coefficients and of R are current.
    pub(super) fn set_weights(&mut self, fine: &Coefficients<f32>) {
        set_weights(self, fine);
    }
}

vectorised!(
    fn set_half_resistance(interpolation: &mut Interpolation, fine: &Coefficients<f32>) {
        let Interpolation { pairs, half_resistance, .. } = interpolation;
        let (length, stride) =
            (half_resistance.row_length(), half_resistance.strides()[pairs.axis]);
        let faces = fine.faces[pairs.axis].values();
        for ([start], first) in rows([&*half_resistance]).zip(pairs.fine_rows()) {
            let of_cells = [start, start + stride].map(|face| &faces[face..][..length]);
            let resistance = &mut half_resistance.values_mut()[start..][..length];
            set_half_resistances(pairs.row_places(first), of_cells, resistance);
        }
    }
);

vectorised!(
    fn set_weights(interpolation: &mut Interpolation, fine: &Coefficients<f32>) {
        let Interpolation { pairs, half_resistance, weight } = interpolation;
        let (length, stride) = (weight.row_length(), weight.strides()[pairs.axis]);
        let (faces, resistance) = (fine.faces[pairs.axis].values(), half_resistance.values());
        for ([start], first) in rows([&*weight]).zip(pairs.fine_rows()) {
            let row = RowInSeries {
                faces: [start, start + stride].map(|face| &faces[face..][..length]),
                resistance: [start - stride, start, start + stride]
                    .map(|cell| &resistance[cell..][..length]),
            };
            let weight = &mut weight.values_mut()[start..][..length];
            row.set_weights(pairs.row_places(first), weight);
        }
    }
);

/// R of a row from the coefficients of the lower and upper faces of its cells.
#[inline(always)]
fn set_half_resistances(places: RowPlaces, [lower, upper]: [&[f32]; 2], resistance: &mut [f32]) {
    for i in 0..resistance.len() {
        let inside = if places.is_second(i) { lower[i] } else { upper[i] };
        resistance[i] = 0.5 / inside;
    }
}

/// A row of cells with its neighbours along the axis of the pairs.
struct RowInSeries<'a> {
    /// a of the lower and the upper faces.
    faces: [&'a [f32]; 2],
    /// R of the cells below, the cells themselves and those above.
    resistance: [&'a [f32]; 3],
}

impl RowInSeries<'_> {
    /// Sets t.
    #[inline(always)]
    fn set_weights(&self, places: RowPlaces, weight: &mut [f32]) {
        let ([lower, upper], [below, own, above]) = (self.faces, self.resistance);
        for i in 0..weight.len() {
            let upwards = places.is_second(i);
            let (face, next) = if upwards { (upper[i], above[i]) } else { (lower[i], below[i]) };
            weight[i] = weight_of_next(own[i], face, next);
        }
    }
}

/// R / (R + 1/a + R'); 0 if the face is closed, 1 if only R is infinite, 1/2 if both R and R' are infinite.
#[inline(always)]
fn weight_of_next(own: f32, face: f32, next: f32) -> f32 {
    let weight = own / (own + 1.0 / face + next);
    let if_infinite = if next == f32::INFINITY { 0.5 } else { 1.0 };
    let weight = if own == f32::INFINITY { if_infinite } else { weight };
    if face == 0.0 { 0.0 } else { weight }
}
