//! The operator on the cells of a part, row by row.

use super::exact_dot::RunningDot;
use super::rows::rows;
use crate::grid::{Field, LocalCells};
use crate::numbers::{VectorWork, in_wide_vectors};

/// a_f on the lower faces of cells, axis by axis, and d_c. Halo: two cells; faces on the box's own faces are zero, but
/// through periodic ones.
#[derive(Clone, Debug)]
pub(super) struct Coefficients {
    pub(super) faces: [Field; 3],
    pub(super) diagonal: Field,
}

impl Coefficients {
    pub(super) fn new(part: &LocalCells) -> Self {
        let zero = || Field::new(part, 2);
        Self { faces: [zero(), zero(), zero()], diagonal: zero() }
    }

    /// All four fields.
    pub(super) fn fields(&mut self) -> [&mut Field; 4] {
        let [x, y, z] = &mut self.faces;
        [x, y, z, &mut self.diagonal]
    }

    /// Sum of a_f + d_c of a cell, by its place.
    #[inline(always)]
    fn sum(&self, cell: usize) -> f64 {
        let strides = self.diagonal.strides();
        let along = |axis: usize| {
            let faces = self.faces[axis].values();
            faces[cell] + faces[cell + strides[axis]]
        };
        (along(0) + along(1)) + (along(2) + self.diagonal.values()[cell])
    }

    /// 1 / (sum of a_f + d_c); zero for a cell that nothing holds.
    pub(super) fn inverse_diagonal_into(&self, inverse: &mut Field) {
        let length = inverse.count()[0];
        for [from, to] in rows([&self.diagonal, inverse]) {
            for (i, value) in inverse.values_mut()[to..][..length].iter_mut().enumerate() {
                let sum = self.sum(from + i);
                *value = if sum > 0.0 { 1.0 / sum } else { 0.0 };
            }
        }
    }

    /// (sum of a_f + d_c) p_c.
    pub(super) fn scale_by_diagonal(&self, p: &Field, scaled: &mut Field) {
        let length = p.count()[0];
        for [from, to] in rows([&self.diagonal, p]) {
            for i in 0..length {
                scaled.values_mut()[to + i] = self.sum(from + i) * p.values()[to + i];
            }
        }
    }
}

/// A row of cells along x with its coefficients, and the numbers of the cells and of their neighbours.
#[derive(Clone, Copy)]
pub(super) struct StencilRow<'a> {
    lower_faces: [&'a [f64]; 3],
    upper_faces: [&'a [f64]; 3],
    diagonal: &'a [f64],
    centre: &'a [f64],
    below: [&'a [f64]; 3],
    above: [&'a [f64]; 3],
}

impl<'a> StencilRow<'a> {
    /// The `length` cells that begin in these places of the coefficients and of the numbers.
    #[inline(always)]
    pub(super) fn new(
        (coefficients, place): (&'a Coefficients, usize),
        (numbers, row): (&'a Field, usize),
        length: usize,
    ) -> Self {
        let faces = coefficients.faces.each_ref().map(Field::values);
        let beyond = coefficients.diagonal.strides();
        let (strides, p) = (numbers.strides(), numbers.values());
        Self {
            lower_faces: from_places(faces, [place; 3], length),
            upper_faces: from_places(faces, beyond.map(|along| place + along), length),
            diagonal: &coefficients.diagonal.values()[place..][..length],
            centre: &p[row..][..length],
            below: from_places([p; 3], strides.map(|along| row - along), length),
            above: from_places([p; 3], strides.map(|along| row + along), length),
        }
    }

    /// (A p) of the i-th cell of the row; always in the same order.
    #[inline(always)]
    pub(super) fn apply(&self, i: usize) -> f64 {
        let centre = self.centre[i];
        let along = |axis: usize| {
            self.lower_faces[axis][i] * (centre - self.below[axis][i])
                + self.upper_faces[axis][i] * (centre - self.above[axis][i])
        };
        (along(0) + along(1)) + (along(2) + self.diagonal[i] * centre)
    }

    #[inline(always)]
    pub(super) fn centre(&self) -> &'a [f64] {
        self.centre
    }
}

#[inline(always)]
fn from_places([x, y, z]: [&[f64]; 3], [i, j, k]: [usize; 3], length: usize) -> [&[f64]; 3] {
    [&x[i..][..length], &y[j..][..length], &z[k..][..length]]
}

/// q = A p, and p . q; both have halos of one width.
pub(super) fn apply(
    coefficients: &Coefficients,
    p: &Field,
    q: &mut Field,
    dot: RunningDot,
) -> RunningDot {
    in_wide_vectors(Apply { coefficients, p, q, dot })
}

struct Apply<'a> {
    coefficients: &'a Coefficients,
    p: &'a Field,
    q: &'a mut Field,
    dot: RunningDot,
}

impl VectorWork for Apply<'_> {
    type Output = RunningDot;

    #[inline(always)]
    fn run(self) -> RunningDot {
        let Self { coefficients, p, q, mut dot } = self;
        let length = p.count()[0];
        for [place, row] in rows([&coefficients.diagonal, p]) {
            let stencil = StencilRow::new((coefficients, place), (p, row), length);
            let result = &mut q.values_mut()[row..][..length];
            for (i, value) in result.iter_mut().enumerate() {
                *value = stencil.apply(i);
            }
            dot.add_row(stencil.centre(), result);
        }
        dot
    }
}

/// r = b - A p.
pub(super) fn residual(coefficients: &Coefficients, p: &Field, b: &Field, r: &mut Field) {
    in_wide_vectors(Residual { coefficients, p, b, r });
}

struct Residual<'a> {
    coefficients: &'a Coefficients,
    p: &'a Field,
    b: &'a Field,
    r: &'a mut Field,
}

impl VectorWork for Residual<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { coefficients, p, b, r } = self;
        let length = p.count()[0];
        for [place, row, right, rest] in rows([&coefficients.diagonal, p, b, r]) {
            let stencil = StencilRow::new((coefficients, place), (p, row), length);
            let right = &b.values()[right..][..length];
            for (i, value) in r.values_mut()[rest..][..length].iter_mut().enumerate() {
                *value = right[i] - stencil.apply(i);
            }
        }
    }
}
