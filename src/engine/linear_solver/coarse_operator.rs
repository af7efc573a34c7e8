//! The coefficients of the coarse grid, along one axis:
//!
//! ```math
//! \begin{aligned}
//! \text{along the axis:} \quad & \frac{1}{R + 1/a + R'} + \sum_{f} \tfrac{1}{2} a_f (t_c - t_{c'})^2 \\
//! \text{across it:} \quad & \sum_{f} \bar{w}_f\, a_f
//! \end{aligned}
//! ```
//!
//! Both sums run over the faces f across the axis. R and t are those of [`Interpolation`]; the weight of a cell is
//! 1 - t in its own pair and t in the next, and w_f is the mean weight of the two cells of a face. The sum in the first
//! row accounts for the flow between cells side by side with different weights. Without it the coarse-grid correction
//! would be too large where coefficients jump.

use super::cell_pairs::PairRow;
use super::interpolation::Interpolation;
use super::operator::Coefficients;
use super::rows::rows;
use crate::grid::Field;
use crate::numbers::vectorised;

impl Interpolation {
    /// Sets the coefficients of owned cells of the coarse grid.
    ///
    /// Before: halos of coefficients, R and t are current. After: halos of the coarse coefficients are not.
    pub(super) fn coarsen(&self, fine: &Coefficients<f32>, coarse: &mut Coefficients<f32>) {
        coarsen(Coarsening { interpolation: self, fine, coarse });
    }
}

struct Coarsening<'a> {
    interpolation: &'a Interpolation,
    fine: &'a Coefficients<f32>,
    coarse: &'a mut Coefficients<f32>,
}

vectorised!(
    fn coarsen(coarsening: Coarsening) {
        let mut coarsening = coarsening;
        let pairs = coarsening.interpolation.pairs;
        let length = coarsening.coarse.diagonal.row_length();
        for ([target], pair) in rows([&coarsening.coarse.diagonal]).zip(pairs.coarse_rows()) {
            let first = coarsening.fine.diagonal.index(pairs.first_of(pair));
            match pairs.row(pair, length) {
                PairRow::Along { last_is_single } => {
                    coarsening.set_row::<2, false>(first, target, length);
                    let last = length - 1;
                    if last_is_single {
                        coarsening.set_row::<2, true>(first + 2 * last, target + last, 1);
                    }
                }
                PairRow::Single => coarsening.set_row::<1, true>(first, target, length),
                PairRow::Across => coarsening.set_row::<1, false>(first, target, length),
            }
        }
    }
);

/// Values in the four cells on which the coefficients of a pair depend, for all pairs of a row: the cell below the
/// pair, its own two, the one above.
type FourCells<'a> = [&'a [f32]; 4];

impl Coarsening<'_> {
    /// Sets the coefficients of pairs in a row, from the index `target` on. Their first cells are `SPACING` apart, from
    /// the index `first` on; a pair may be a `SINGLE` cell.
    #[inline(always)]
    fn set_row<const SPACING: usize, const SINGLE: bool>(
        &mut self,
        first: usize,
        target: usize,
        length: usize,
    ) {
        let Self { interpolation: Interpolation { pairs, weight, .. }, fine, .. } = *self;
        let (strides, cells) = (weight.strides(), SPACING * (length - 1) + 1);
        let below = first - strides[pairs.axis];
        let own_weights = four_rows(weight, below, strides[pairs.axis], cells);
        self.set_series::<SPACING>(first, target, length);
        for across in (0..3).filter(|&across| across != pairs.axis) {
            let values = four_rows(&fine.faces[across], below, strides[pairs.axis], cells);
            let beside = four_rows(weight, below - strides[across], strides[pairs.axis], cells);
            let coarse = &mut self.coarse.faces[across].values_mut()[target..][..length];
            in_parallel::<SPACING, SINGLE>(values, [own_weights, beside], coarse);
        }
        let values = four_rows(&fine.diagonal, below, strides[pairs.axis], cells);
        let coarse = &mut self.coarse.diagonal.values_mut()[target..][..length];
        in_parallel::<SPACING, SINGLE>(values, [own_weights; 2], coarse);
    }

    /// Sets the coefficients between pairs and the pairs below. They are zero at the end of the grid, and where a pair
    /// is its own neighbour.
    #[inline(always)]
    fn set_series<const SPACING: usize>(&mut self, first: usize, target: usize, length: usize) {
        let Interpolation { pairs, weight, half_resistance } = self.interpolation;
        let coarse = &mut self.coarse.faces[pairs.axis].values_mut()[target..][..length];
        if pairs.coarse.counts[pairs.axis] == 1 {
            return coarse.fill(0.0);
        }
        let (strides, cells) = (weight.strides(), SPACING * (length - 1) + 1);
        let below = first - strides[pairs.axis];
        let faces = &self.fine.faces;
        let resistances = [below, first].map(|first| row(half_resistance, first, cells));
        let between = row(&faces[pairs.axis], first, cells);
        set_in_series::<SPACING>(resistances, between, coarse);
        for across in (0..3).filter(|&across| across != pairs.axis) {
            let stride = strides[across];
            for first in [below, first] {
                let faces = [first, first + stride].map(|face| row(&faces[across], face, cells));
                let beside = [first - stride, first, first + stride];
                add_cross_flow::<SPACING>(
                    faces,
                    beside.map(|cell| row(weight, cell, cells)),
                    coarse,
                );
            }
        }
        close::<SPACING>(between, coarse);
    }
}

/// The values of some cells of a row.
#[inline(always)]
fn row(field: &Field<f32>, first: usize, cells: usize) -> &[f32] {
    &field.values()[first..][..cells]
}

/// The values of such cells in four rows, each of which lies one stride beyond the previous one.
#[inline(always)]
fn four_rows(field: &Field<f32>, first: usize, stride: usize, cells: usize) -> FourCells<'_> {
    [0, 1, 2, 3].map(|number| row(field, first + number * stride, cells))
}

/// Sets 1 / (R + 1/a + R') from the resistances below and above faces and their coefficients.
#[inline(always)]
fn set_in_series<const SPACING: usize>(
    [below, above]: [&[f32]; 2],
    between: &[f32],
    coefficients: &mut [f32],
) {
    for i in 0..coefficients.len() {
        let cell = SPACING * i;
        coefficients[i] = 1.0 / (below[cell] + 1.0 / between[cell] + above[cell]);
    }
}

/// Sets coefficients to zero where the face is closed.
#[inline(always)]
fn close<const SPACING: usize>(between: &[f32], coefficients: &mut [f32]) {
    for i in 0..coefficients.len() {
        let is_closed = between[SPACING * i] == 0.0;
        coefficients[i] = if is_closed { 0.0 } else { coefficients[i] };
    }
}

/// Adds a_f (t_c - t_c')^2 / 2 for the lower and the upper faces of cells, from t in the cells below, the cells
/// themselves and those above.
#[inline(always)]
fn add_cross_flow<const SPACING: usize>(
    [lower, upper]: [&[f32]; 2],
    [below, here, above]: [&[f32]; 3],
    coefficients: &mut [f32],
) {
    for i in 0..coefficients.len() {
        let cell = SPACING * i;
        let (rise_below, rise_above) = (here[cell] - below[cell], above[cell] - here[cell]);
        let flows =
            lower[cell] * (rise_below * rise_below) + upper[cell] * (rise_above * rise_above);
        coefficients[i] += 0.5 * flows;
    }
}

/// The sums over fine cells of their values times their weights in a pair. The weight is the mean of two: those of the
/// two cells of a face across the axis, or twice that of a cell.
#[inline(always)]
fn in_parallel<const SPACING: usize, const SINGLE: bool>(
    values: FourCells,
    [here, beside]: [FourCells; 2],
    coarse: &mut [f32],
) {
    for i in 0..coarse.len() {
        let cell = SPACING * i;
        let mean = |of: usize| 0.5 * (here[of][cell] + beside[of][cell]);
        let own = |of: usize| (1.0 - mean(of)) * values[of][cell];
        let next = |of: usize| mean(of) * values[of][cell];
        coarse[i] = if SINGLE {
            own(1) + (next(0) + next(2))
        } else {
            (own(1) + own(2)) + (next(0) + next(3))
        };
    }
}
