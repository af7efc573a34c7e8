//! The coefficients of the coarse grid, along one axis:
//!
//! ```math
//! \begin{aligned}
//! \text{along the axis:} \quad & \frac{1}{R + 1/a + R'} + \sum_{f} \tfrac{1}{2} a_f (t_c - t_{c'})^2 \\
//! \text{across it:} \quad & \sum_{f} \bar{w}_f\, a_f
//! \end{aligned}
//! ```
//!
//! Both sums run over the faces f across the axis. R and t are those of [`Interpolation`]; the weight of a cell is 1 - t
//! in its own pair and t in the next, and w_f the mean weight of the two cells of a face. The sum in the first row accounts for the flow between cells side by side with different weights. Without it the coarse-grid
//! correction would be too large where coefficients jump.

use super::interpolation::Interpolation;
use super::operator::Coefficients;
use super::rows::rows;

impl Interpolation {
    /// Sets the coefficients of owned cells of the coarse grid.
    ///
    /// Before: halos of coefficients, R and t are current. After: those of the coarse coefficients are not.
    pub(super) fn coarsen(&self, fine: &Coefficients, coarse: &mut Coefficients) {
        let pairs = &self.pairs;
        let spacing = if pairs.axis == 0 { 2 } else { 1 };
        let targets = rows([&coarse.diagonal]).zip(pairs.coarse_rows());
        for ([target], pair) in targets {
            let first = fine.diagonal.index(pairs.first_of(pair));
            let global = pairs.coarse.start[pairs.axis] as isize + pair[pairs.axis];
            for i in 0..pairs.coarse.count[0] {
                let global = if pairs.axis == 0 { global + i as isize } else { global };
                let (cell, single) = (first + spacing * i, pairs.is_single_before_wrap(global));
                for axis in 0..3 {
                    coarse.faces[axis].values_mut()[target + i] = if axis == pairs.axis {
                        self.in_series(fine, cell)
                    } else {
                        self.in_parallel(fine.faces[axis].values(), Some(axis), cell, single)
                    };
                }
                let diagonal = self.in_parallel(fine.diagonal.values(), None, cell, single);
                coarse.diagonal.values_mut()[target + i] = diagonal;
            }
        }
    }

    /// The coefficient between a pair, given by its first cell, and the pair below.
    #[inline(always)]
    fn in_series(&self, fine: &Coefficients, cell: usize) -> f64 {
        let axis = self.pairs.axis;
        let strides = self.weight.strides();
        let (stride, resistance) = (strides[axis], self.half_resistance.values());
        let face = fine.faces[axis].values()[cell];
        if face == 0.0 || self.pairs.coarse.counts[axis] == 1 {
            return 0.0; // the end of the grid, or a pair that is its own neighbour
        }
        let series = 1.0 / (resistance[cell - stride] + 1.0 / face + resistance[cell]);
        let mut cross_flow = 0.0;
        for across in (0..3).filter(|&across| across != axis) {
            let faces = fine.faces[across].values();
            for cell in [cell - stride, cell] {
                let above = cell + strides[across];
                cross_flow += self.cross_flow(faces, cell, strides[across])
                    + self.cross_flow(faces, above, strides[across]);
            }
        }
        series + 0.5 * cross_flow
    }

    /// a_f (t_c - t_c')^2 of the lower face of a cell across the axis.
    #[inline(always)]
    fn cross_flow(&self, faces: &[f64], cell: usize, across: usize) -> f64 {
        let weight = self.weight.values();
        let difference = weight[cell] - weight[cell - across];
        faces[cell] * (difference * difference)
    }

    /// The sum over fine cells of their values times their weights in a pair, given by its first cell. For faces
    /// across the axis the weight is the mean of those of their two cells.
    #[inline(always)]
    fn in_parallel(&self, values: &[f64], across: Option<usize>, cell: usize, single: bool) -> f64 {
        let (weight, strides) = (self.weight.values(), self.weight.strides());
        let stride = strides[self.pairs.axis];
        let mean = |cell: usize| match across {
            Some(axis) => 0.5 * (weight[cell] + weight[cell - strides[axis]]),
            None => weight[cell],
        };
        let own = |cell: usize| (1.0 - mean(cell)) * values[cell];
        let next = |cell: usize| mean(cell) * values[cell];
        if single {
            return own(cell) + (next(cell - stride) + next(cell + stride));
        }
        (own(cell) + own(cell + stride)) + (next(cell - stride) + next(cell + 2 * stride))
    }
}
