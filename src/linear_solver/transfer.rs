//! Between a grid and the one without every other cell along one axis.
//!
//! A cell with an odd number F is left out; along the axis it stands between two that stay, L below and U above:
//!
//! ```text
//! p_F = w_L p_L + w_U p_U,    w_L = a_L / (a_L + a_U + d_F),  w_U = a_U / (a_L + a_U + d_F)
//! ```
//!
//! which is what the equation of F says without sources and without flow across the axis. What is left out is shared
//! out to L and U by the same weights.

use super::operator::Coefficients;
use crate::grid::{Field, GridPart};
use crate::numbers::{VectorWork, in_wide_vectors};
use std::ops::Range;

/// The weights along one axis, in the places of the cells that are left out; zero in those that stay.
#[derive(Clone, Debug)]
pub(super) struct Transfer {
    axis: usize,
    fine: GridPart,
    coarse: GridPart,
    periodic: bool,
    pub(super) weights: [Field; 2],
}

impl Transfer {
    pub(super) fn new(axis: usize, fine: GridPart, coarse: GridPart, periodic: bool) -> Self {
        let weights = [Field::new(&fine, 1), Field::new(&fine, 1)];
        Self { axis, fine, coarse, periodic, weights }
    }

    /// Place along the axis, in the fine part, of the coarse part's first cell.
    fn offset(&self) -> usize {
        2 * self.coarse.start[self.axis] - self.fine.start[self.axis]
    }

    /// Sets the weights of owned cells. Before: halos of the coefficients are current. After: those of the weights
    /// are not.
    pub(super) fn set_weights(&mut self, fine: &Coefficients) {
        let axis = self.axis;
        let along = fine.diagonal.strides()[axis];
        let faces = fine.faces[axis].values();
        let [lower, upper] = &mut self.weights;
        for_each_cell(self.fine.count.map(|count| 0..count as isize), |place| {
            if (self.fine.start[axis] as isize + place[axis]) % 2 == 0 {
                return;
            }
            let cell = lower.index(place);
            let (below, above) = (faces[cell], faces[cell + along]);
            let sum = below + above + fine.diagonal.values()[cell];
            let inverse = if sum > 0.0 { 1.0 / sum } else { 0.0 };
            lower.values_mut()[cell] = below * inverse;
            upper.values_mut()[cell] = above * inverse;
        });
    }

    /// Sets the coefficients of owned cells of the coarse grid: in series along the axis, in parallel across it.
    ///
    /// Before: halos of coefficients and weights are current. After: those of the coarse coefficients are not.
    pub(super) fn coarsen(&self, fine: &Coefficients, coarse: &mut Coefficients) {
        let offset = self.offset() as isize;
        for_each_cell(self.coarse.count.map(|count| 0..count as isize), |place| {
            let mut kept = place;
            kept[self.axis] = 2 * place[self.axis] + offset;
            let cell = fine.diagonal.index(kept);
            let target = coarse.diagonal.index(place);
            for axis in 0..3 {
                let value = if axis == self.axis {
                    let first = self.coarse.start[axis] as isize + place[axis] == 0;
                    self.in_series(fine, cell, first)
                } else {
                    self.in_parallel(fine, axis, cell)
                };
                coarse.faces[axis].values_mut()[target] = value;
            }
            let diagonal = self.shared_out(fine.diagonal.values(), cell);
            coarse.diagonal.values_mut()[target] = diagonal;
        });
    }

    /// a_L a_U / (a_L + a_U + d_F) across the cell that is left out below a cell.
    fn in_series(&self, fine: &Coefficients, cell: usize, first: bool) -> f64 {
        let along = fine.diagonal.strides()[self.axis];
        let face = fine.faces[self.axis].values()[cell];
        if self.coarse.counts[self.axis] == 1 {
            return 0.0; // its own neighbour
        }
        if first && self.periodic && self.fine.counts[self.axis] % 2 == 1 {
            return face; // none is left out between the last cell and the first
        }
        self.weights[0].values()[cell - along] * face
    }

    /// The coefficient of a face across `axis`, and the shares of those beside it.
    fn in_parallel(&self, fine: &Coefficients, axis: usize, cell: usize) -> f64 {
        let strides = fine.diagonal.strides();
        let (along, across) = (strides[self.axis], strides[axis]);
        let face = fine.faces[axis].values();
        let [lower, upper] = &self.weights;
        let share = |weights: &Field, left_out: usize| {
            let weights = weights.values();
            0.5 * (weights[left_out] + weights[left_out - across]) * face[left_out]
        };
        face[cell] + (share(upper, cell - along) + share(lower, cell + along))
    }

    /// The number of a cell that stays, and the shares of those left out beside it.
    #[inline(always)]
    fn shared_out(&self, numbers: &[f64], cell: usize) -> f64 {
        let along = self.weights[0].strides()[self.axis];
        let [lower, upper] = &self.weights;
        let below = upper.values()[cell - along] * numbers[cell - along];
        let above = lower.values()[cell + along] * numbers[cell + along];
        numbers[cell] + (below + above)
    }

    /// Owned cells along this axis and those after it, owned and halo cells along those before it: what is needed
    /// to go on along those.
    fn restricted_cells(&self) -> [Range<isize>; 3] {
        [0, 1, 2].map(|axis| {
            let count = self.coarse.count[axis] as isize;
            if axis < self.axis { -1..count + 1 } else { 0..count }
        })
    }

    /// Owned cells along this axis and those before it; halo cells too along those after it, unless this is the
    /// last axis.
    fn prolonged_cells(&self, last: bool) -> [Range<isize>; 3] {
        [0, 1, 2].map(|axis| {
            let count = self.fine.count[axis] as isize;
            if axis > self.axis && !last { -1..count + 1 } else { 0..count }
        })
    }

    /// Shares out what is left out. Before: the halo of `fine` is current, along axes before this one too.
    pub(super) fn restrict(&self, fine: &Field, coarse: &mut Field) {
        in_wide_vectors(Restrict { transfer: self, fine, coarse });
    }

    /// Interpolates what was left out. Before: the halo of `coarse` is current, along axes after this one too.
    pub(super) fn prolong(&self, coarse: &Field, fine: &mut Field) {
        in_wide_vectors(Prolong::<false> { transfer: self, coarse, fine });
    }

    /// Adds what is interpolated to owned cells.
    pub(super) fn correct(&self, coarse: &Field, fine: &mut Field) {
        in_wide_vectors(Prolong::<true> { transfer: self, coarse, fine });
    }
}

fn for_each_cell([x, y, z]: [Range<isize>; 3], mut work: impl FnMut([isize; 3])) {
    for k in z {
        for j in y.clone() {
            for i in x.clone() {
                work([i, j, k]);
            }
        }
    }
}

struct Restrict<'a> {
    transfer: &'a Transfer,
    fine: &'a Field,
    coarse: &'a mut Field,
}

impl VectorWork for Restrict<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { transfer, fine, coarse } = self;
        let (axis, offset) = (transfer.axis, transfer.offset() as isize);
        let along = fine.strides()[axis];
        let [x, y, z] = transfer.restricted_cells();
        let length = x.len();
        let [lower, upper] = transfer.weights.each_ref().map(Field::values);
        let numbers = fine.values();
        for k in z {
            for j in y.clone() {
                let mut kept = [x.start, j, k];
                kept[axis] = 2 * kept[axis] + offset;
                let from = fine.index(kept);
                let to = coarse.index([x.start, j, k]);
                let row = &mut coarse.values_mut()[to..][..length];
                if axis == 0 {
                    for (m, value) in row.iter_mut().enumerate() {
                        let cell = from + 2 * m;
                        let below = upper[cell - 1] * numbers[cell - 1];
                        let above = lower[cell + 1] * numbers[cell + 1];
                        *value = numbers[cell] + (below + above);
                    }
                } else {
                    let kept = &numbers[from..][..length];
                    let below =
                        [&upper[from - along..][..length], &numbers[from - along..][..length]];
                    let above =
                        [&lower[from + along..][..length], &numbers[from + along..][..length]];
                    for (i, value) in row.iter_mut().enumerate() {
                        *value = kept[i] + (below[0][i] * below[1][i] + above[0][i] * above[1][i]);
                    }
                }
            }
        }
    }
}

struct Prolong<'a, const CORRECT: bool> {
    transfer: &'a Transfer,
    coarse: &'a Field,
    fine: &'a mut Field,
}

impl<const CORRECT: bool> VectorWork for Prolong<'_, CORRECT> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { transfer, coarse, fine } = self;
        let axis = transfer.axis;
        let along = coarse.strides()[axis];
        let [x, y, z] = transfer.prolonged_cells(CORRECT);
        let length = x.len();
        let [lower, upper] = transfer.weights.each_ref().map(Field::values);
        let numbers = coarse.values();
        let (fine_start, coarse_start) = (transfer.fine.start[axis], transfer.coarse.start[axis]);
        for k in z {
            for j in y.clone() {
                let place = [x.start, j, k];
                let to = fine.index(place);
                let number = (fine_start as isize + place[axis]) as usize;
                let mut from = place;
                from[axis] = (number / 2) as isize - coarse_start as isize;
                let from = coarse.index(from);
                let row = &mut fine.values_mut()[to..][..length];
                if axis == 0 {
                    for (i, value) in row.iter_mut().enumerate() {
                        let place = (number + i) / 2 - number / 2 + from;
                        let interpolated = if (number + i) % 2 == 0 {
                            numbers[place]
                        } else {
                            lower[to + i] * numbers[place] + upper[to + i] * numbers[place + 1]
                        };
                        *value = if CORRECT { *value + interpolated } else { interpolated };
                    }
                } else if number % 2 == 0 {
                    let kept = &numbers[from..][..length];
                    for (value, kept) in row.iter_mut().zip(kept) {
                        *value = if CORRECT { *value + kept } else { *kept };
                    }
                } else {
                    let below = [&lower[to..][..length], &numbers[from..][..length]];
                    let above = [&upper[to..][..length], &numbers[from + along..][..length]];
                    for (i, value) in row.iter_mut().enumerate() {
                        let interpolated = below[0][i] * below[1][i] + above[0][i] * above[1][i];
                        *value = if CORRECT { *value + interpolated } else { interpolated };
                    }
                }
            }
        }
    }
}
