//! Between a grid and the one with half as many cells along one axis.
//!
//! Cells 2m and 2m + 1 become one, whose number stands for the middle between them (for the cell itself where the
//! last is left alone). Between two middles M and N, of the pair of a cell c and of the next pair, three resistances
//! lie in series, half of what is inside each pair and the one in between; the cell lies behind the first of them:
//!
//! ```text
//! p_c = (1 - t) p_M + t p_N,   t = R / (R + 1/a + R'),   R = 1 / (2 a_inside)
//! ```
//!
//! 1/4 if all coefficients are equal. Restriction is the transpose. Coefficients of the coarse grid:
//!
//! ```text
//! along the axis:  1 / (R + 1/a + R') + sum over faces f across the axis of a_f (t_c - t_c')^2 / 2
//! across it:       sum over faces f of the mean weight of their two cells times a_f
//! ```
//!
//! The last term of the first row is what it costs that cells side by side lean on different pairs; without it the
//! coarse grid would answer too strongly where coefficients jump.

use super::operator::Coefficients;
use super::pairs::Pairs;
use super::rows::rows;
use crate::grid::Field;

/// The weights t of one axis, and what they are needed for.
#[derive(Clone, Debug)]
pub(super) struct Transfer {
    pub(super) pairs: Pairs,
    /// t of each fine cell: its part in the next pair. Halo: two cells.
    pub(super) lean: Field,
    /// R of each fine cell: between it and the middle of its pair.
    pub(super) inside: Field,
}

impl Transfer {
    pub(super) fn new(pairs: Pairs) -> Self {
        let (lean, inside) = (Field::new(&pairs.fine, 2), Field::new(&pairs.fine, 2));
        Self { pairs, lean, inside }
    }

    /// Sets R of owned cells. Before: halos of the coefficients are current.
    pub(super) fn set_inside(&mut self, fine: &Coefficients) {
        let Self { pairs, inside, .. } = self;
        let along = inside.strides()[pairs.axis];
        let faces = fine.faces[pairs.axis].values();
        let last = pairs.fine.counts[pairs.axis] - 1;
        for run in pairs.runs() {
            let first = inside.index(run.place);
            let cells = run.cells(first);
            if run.number % 2 == 1 {
                cells.for_each(|cell| inside.values_mut()[cell] = 0.5 / faces[cell]);
            } else {
                cells.for_each(|cell| inside.values_mut()[cell] = 0.5 / faces[cell + along]);
            }
        }
        if last % 2 == 0 && pairs.fine.at_ends(pairs.axis)[1] {
            // The last cell is left alone: it is the middle of its pair.
            let layer = pairs.fine.count[pairs.axis] as isize - 1;
            let rows: Vec<_> = inside.slab(pairs.axis, (layer, layer + 1)).collect();
            rows.into_iter().for_each(|row| inside.values_mut()[row].fill(0.0));
        }
    }

    /// Sets t of owned cells. Before: halos of the coefficients and of R are current.
    pub(super) fn set_lean(&mut self, fine: &Coefficients) {
        let Self { pairs, inside, lean } = self;
        let along = inside.strides()[pairs.axis];
        let faces = fine.faces[pairs.axis].values();
        let inside = inside.values();
        for run in pairs.runs() {
            let first = lean.index(run.place);
            let upwards = run.number % 2 == 1;
            for cell in run.cells(first) {
                let (face, next) =
                    if upwards { (cell + along, cell + along) } else { (cell, cell - along) };
                lean.values_mut()[cell] = part_beyond(inside[cell], faces[face], inside[next]);
            }
        }
    }

    /// Sets the coefficients of owned cells of the coarse grid.
    ///
    /// Before: halos of coefficients, R and t are current. After: those of the coarse coefficients are not.
    pub(super) fn coarsen(&self, fine: &Coefficients, coarse: &mut Coefficients) {
        let pairs = &self.pairs;
        let distance = if pairs.axis == 0 { 2 } else { 1 };
        let targets = rows([&coarse.diagonal]).zip(pairs.coarse_rows());
        for ([target], place) in targets {
            let first = fine.diagonal.index(pairs.first_of(place));
            let number = pairs.coarse.start[pairs.axis] as isize + place[pairs.axis];
            for i in 0..pairs.coarse.count[0] {
                let number = if pairs.axis == 0 { number + i as isize } else { number };
                let (cell, alone) = (first + distance * i, pairs.wraps_alone(number));
                for axis in 0..3 {
                    coarse.faces[axis].values_mut()[target + i] = if axis == pairs.axis {
                        self.in_series(fine, cell)
                    } else {
                        self.in_parallel(fine.faces[axis].values(), Some(axis), cell, alone)
                    };
                }
                let diagonal = self.in_parallel(fine.diagonal.values(), None, cell, alone);
                coarse.diagonal.values_mut()[target + i] = diagonal;
            }
        }
    }

    /// The coefficient between the pair of a first cell and the pair below.
    #[inline(always)]
    fn in_series(&self, fine: &Coefficients, cell: usize) -> f64 {
        let axis = self.pairs.axis;
        let strides = self.lean.strides();
        let (along, inside) = (strides[axis], self.inside.values());
        let face = fine.faces[axis].values()[cell];
        if face == 0.0 || self.pairs.coarse.counts[axis] == 1 {
            return 0.0; // the end of the grid, or its own neighbour
        }
        let series = 1.0 / (inside[cell - along] + 1.0 / face + inside[cell]);
        let mut leaning = 0.0;
        for across in (0..3).filter(|&across| across != axis) {
            let faces = fine.faces[across].values();
            for cell in [cell - along, cell] {
                let above = cell + strides[across];
                leaning += self.cost(faces, cell, strides[across])
                    + self.cost(faces, above, strides[across]);
            }
        }
        series + 0.5 * leaning
    }

    /// a_f (t_c - t_c')^2 of the lower face of a cell.
    #[inline(always)]
    fn cost(&self, faces: &[f64], cell: usize, across: usize) -> f64 {
        let lean = self.lean.values();
        let difference = lean[cell] - lean[cell - across];
        faces[cell] * (difference * difference)
    }

    /// The sum over fine cells of a number times its weight in the pair of a first cell: for faces across the axis
    /// the mean weight of their two cells.
    #[inline(always)]
    fn in_parallel(
        &self,
        numbers: &[f64],
        across: Option<usize>,
        cell: usize,
        beyond: bool,
    ) -> f64 {
        let (lean, strides) = (self.lean.values(), self.lean.strides());
        let along = strides[self.pairs.axis];
        let mean = |cell: usize| match across {
            Some(axis) => 0.5 * (lean[cell] + lean[cell - strides[axis]]),
            None => lean[cell],
        };
        let own = |cell: usize| (1.0 - mean(cell)) * numbers[cell];
        let next = |cell: usize| mean(cell) * numbers[cell];
        if beyond {
            return own(cell) + (next(cell - along) + next(cell + along));
        }
        (own(cell) + own(cell + along)) + (next(cell - along) + next(cell + 2 * along))
    }
}

/// R / (R + 1/a + R'), 0 if nothing connects the two pairs; 1/2 if only what is inside the pairs keeps them apart.
#[inline(always)]
fn part_beyond(inside: f64, face: f64, next: f64) -> f64 {
    let part = inside / (inside + 1.0 / face + next);
    let cut_off = if next == f64::INFINITY { 0.5 } else { 1.0 };
    let part = if inside == f64::INFINITY { cut_off } else { part };
    if face == 0.0 { 0.0 } else { part }
}
