//! Restriction and prolongation along one axis, with the weights of [`Interpolation`].
//!
//! Prolongation interpolates: p_c = (1 - t_c) p_M + t_c p_N. Restriction is its transpose: a pair receives
//! (1 - t_c) r_c from its own cells and t_c r_c from the cells next to it.

use super::cell_pairs::PairRow;
use super::interpolation::Interpolation;
use super::rows::row_starts;
use crate::grid::Field;
use crate::numbers::vectorised;

vectorised!(
    /// Restricts values from cells to pairs. Before: the halo of `fine`, two cells wide, is current.
    pub(super) fn restrict(
        interpolation: &Interpolation,
        fine: &Field<f32>,
        coarse: &mut Field<f32>,
    ) {
        let Interpolation { pairs, weight, .. } = interpolation;
        let ranges = pairs.restricted();
        let order = fine.order();
        let length = ranges[order[0]].len();
        let stride = fine.strides()[pairs.axis];
        let (weight, values) = (weight.values(), fine.values());
        for pair in row_starts(ranges, order) {
            let first = fine.index(pairs.first_of(pair));
            let to = coarse.index(pair);
            let sums = &mut coarse.values_mut()[to..][..length];
            match pairs.row(pair, length) {
                PairRow::Along { last_is_single } => {
                    restrict_along(&weight[first - 1..], &values[first - 1..], sums);
                    let last = length - 1;
                    if last_is_single {
                        sums[last] = restrict_single(weight, values, first + 2 * last, 1);
                    }
                }
                PairRow::Single => {
                    for (i, sum) in sums.iter_mut().enumerate() {
                        *sum = restrict_single(weight, values, first + i, stride);
                    }
                }
                PairRow::Across => {
                    let rows = [first - stride, first, first + stride, first + 2 * stride];
                    restrict_across(rows.map(|row| [&weight[row..], &values[row..]]), sums);
                }
            }
        }
    }
);

/// Restricted value of a pair that is a single cell, from this cell and the cells below and above.
#[inline(always)]
fn restrict_single(weight: &[f32], values: &[f32], cell: usize, stride: usize) -> f32 {
    let own = (1.0 - weight[cell]) * values[cell];
    let next = |cell: usize| weight[cell] * values[cell];
    own + (next(cell - stride) + next(cell + stride))
}

/// Restricted values of pairs along a row; the slices start one cell below the first pair.
#[inline(always)]
fn restrict_along(weight: &[f32], values: &[f32], sums: &mut [f32]) {
    let count = sums.len();
    let [(weight, weight_beyond), (values, values_beyond)] = [weight, values].map(|row| {
        let pairs = row.as_chunks::<2>().0;
        (&pairs[..count], &pairs[1..][..count])
    });
    for i in 0..count {
        let ([below, first], [second, above]) = (weight[i], weight_beyond[i]);
        let own = (1.0 - first) * values[i][1] + (1.0 - second) * values_beyond[i][0];
        sums[i] = own + (below * values[i][0] + above * values_beyond[i][1]);
    }
}

/// Restricted values of a row of pairs that lie across it, from four rows of weights and values each: the row below,
/// their own two, the row above.
#[inline(always)]
fn restrict_across(rows: [[&[f32]; 2]; 4], sums: &mut [f32]) {
    let length = sums.len();
    let [below, first, second, above] = rows.map(|row| row.map(|values| &values[..length]));
    for i in 0..length {
        let own = |[weight, values]: [&[f32]; 2]| (1.0 - weight[i]) * values[i];
        let next = |[weight, values]: [&[f32]; 2]| weight[i] * values[i];
        sums[i] = (own(first) + own(second)) + (next(below) + next(above));
    }
}

vectorised!(
    /// Prolongs values from pairs to cells. Before: the halo of `coarse` is current, also along the axes after this
    /// one.
    pub(super) fn prolong(
        interpolation: &Interpolation,
        coarse: &Field<f32>,
        fine: &mut Field<f32>,
    ) {
        prolong_rows::<false>(interpolation, coarse, fine);
    }
);

vectorised!(
    /// Adds the prolonged values to owned cells.
    pub(super) fn correct(
        interpolation: &Interpolation,
        coarse: &Field<f32>,
        fine: &mut Field<f32>,
    ) {
        prolong_rows::<true>(interpolation, coarse, fine);
    }
);

/// Sets the values of cells, or adds to them if `CORRECT`.
#[inline(always)]
fn prolong_rows<const CORRECT: bool>(
    interpolation: &Interpolation,
    coarse: &Field<f32>,
    fine: &mut Field<f32>,
) {
    let Interpolation { pairs, weight, .. } = interpolation;
    let axis = pairs.axis;
    let ranges = pairs.prolonged(CORRECT);
    let order = fine.order();
    let length = ranges[order[0]].len();
    let stride = coarse.strides()[axis];
    for cell in row_starts(ranges, order) {
        let global = pairs.global_index(cell);
        let mut own = cell;
        own[axis] = (global / 2) as isize - pairs.coarse.start[axis] as isize;
        let own = coarse.index(own);
        let coarse = coarse.values();
        let to = fine.index(cell);
        let weight = &weight.values()[weight.index(cell)..][..length];
        let values = &mut fine.values_mut()[to..][..length];
        if axis == order[0] {
            let below_first_even = own + global % 2 - 1;
            prolong_along::<CORRECT>(weight, &coarse[below_first_even..], global, values);
        } else {
            let next = if global % 2 == 1 { own + stride } else { own - stride };
            let pairs = [&coarse[own..], &coarse[next..]];
            prolong_across::<CORRECT>(weight, pairs, values);
        }
    }
}

#[inline(always)]
fn put<const CORRECT: bool>(value: &mut f32, weight: f32, own: f32, next: f32) {
    let interpolated = (1.0 - weight) * own + weight * next;
    *value = if CORRECT { *value + interpolated } else { interpolated };
}

/// Prolongs to cells of a row along the axis, the first of which has this global index. The slice of pairs starts one
/// below the pair of the first cell of even index, since an odd cell receives nothing from the pairs below its own.
#[inline(always)]
fn prolong_along<const CORRECT: bool>(
    weight: &[f32],
    pairs: &[f32],
    global_index: usize,
    values: &mut [f32],
) {
    let odd = global_index % 2;
    let (single, doubles) = values.split_at_mut(odd.min(values.len()));
    for value in single {
        put::<CORRECT>(value, weight[0], pairs[0], pairs[1]);
    }
    let weight = &weight[odd..];
    let half = doubles.len() / 2;
    let [below, own, above] = [0, 1, 2].map(|first| &pairs[first..][..half]);
    let twos = &mut doubles.as_chunks_mut::<2>().0[..half];
    let weights = &weight.as_chunks::<2>().0[..half];
    for i in 0..half {
        put::<CORRECT>(&mut twos[i][0], weights[i][0], own[i], below[i]);
        put::<CORRECT>(&mut twos[i][1], weights[i][1], own[i], above[i]);
    }
    if doubles.len() % 2 == 1 {
        let last = 2 * half;
        put::<CORRECT>(&mut doubles[last], weight[last], pairs[half + 1], pairs[half]);
    }
}

/// Prolongs to cells of a row, from the rows of their own pairs and of the next ones.
#[inline(always)]
fn prolong_across<const CORRECT: bool>(weight: &[f32], pairs: [&[f32]; 2], values: &mut [f32]) {
    let [weight, own, next] = [weight, pairs[0], pairs[1]].map(|row| &row[..values.len()]);
    for i in 0..values.len() {
        put::<CORRECT>(&mut values[i], weight[i], own[i], next[i]);
    }
}
