//! Interpolation along one axis from the pairs of cells, the coarse grid, to the cells, the fine grid. The weights
//! follow from the coefficients (operator-dependent interpolation, Alcouffe, Brandt, Dendy and Painter 1981).
//!
//! Cells 2m and 2m + 1 form a pair. Its value stands for the point midway between them, or for the cell itself where
//! the last cell is single. Let M be the pair of a cell c, and N the next pair beyond c. Three resistances lie in
//! series between M and N: half of the resistance inside each pair, and that of the face between them. The cell lies
//! between the first two:
//!
//! ```math
//! p_c = (1 - t)\, p_M + t\, p_N, \qquad t = \frac{R}{R + 1/a + R'}, \qquad R = \frac{1}{2 a_\text{inside}}
//! ```
//!
//! t = 1/4 if all coefficients are equal.

use super::cell_pairs::CellPairs;
use super::operator::Coefficients;
use crate::grid::Field;

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
        let Self { pairs, half_resistance, .. } = self;
        let stride = half_resistance.strides()[pairs.axis];
        let faces = fine.faces[pairs.axis].values();
        let last = pairs.fine.counts[pairs.axis] - 1;
        for run in pairs.runs() {
            let cells = run.cells(half_resistance.index(run.first));
            let resistance = half_resistance.values_mut();
            if run.global_index % 2 == 1 {
                cells.for_each(|cell| resistance[cell] = 0.5 / faces[cell]);
            } else {
                cells.for_each(|cell| resistance[cell] = 0.5 / faces[cell + stride]);
            }
        }
        if last % 2 == 0 && pairs.fine.at_ends(pairs.axis)[1] {
            // The last cell is single: it is the middle of its pair.
            let layer = pairs.fine.count[pairs.axis] as isize - 1;
            let rows: Vec<_> = half_resistance.slab(pairs.axis, layer..layer + 1).collect();
            rows.into_iter().for_each(|row| half_resistance.values_mut()[row].fill(0.0));
        }
    }

    /// Sets t of owned cells. Before: halos of the coefficients and of R are current.
    pub(super) fn set_weights(&mut self, fine: &Coefficients<f32>) {
        let Self { pairs, half_resistance, weight } = self;
        let stride = half_resistance.strides()[pairs.axis];
        let faces = fine.faces[pairs.axis].values();
        let resistance = half_resistance.values();
        for run in pairs.runs() {
            let upwards = run.global_index % 2 == 1;
            for cell in run.cells(weight.index(run.first)) {
                let (face, next) =
                    if upwards { (cell + stride, cell + stride) } else { (cell, cell - stride) };
                weight.values_mut()[cell] =
                    weight_of_next(resistance[cell], faces[face], resistance[next]);
            }
        }
    }
}

/// R / (R + 1/a + R'); 0 if the face is closed, 1 if only R is infinite, 1/2 if R and R' both are.
#[inline(always)]
fn weight_of_next(own: f32, face: f32, next: f32) -> f32 {
    let weight = own / (own + 1.0 / face + next);
    let if_infinite = if next == f32::INFINITY { 0.5 } else { 1.0 };
    let weight = if own == f32::INFINITY { if_infinite } else { weight };
    if face == 0.0 { 0.0 } else { weight }
}
