//! The operator A on the cells of a rank, row by row:
//!
//! ```math
//! (A p)_c = \sum_{f \in c} a_f (p_c - p_\text{nb}) + d_c p_c
//! ```

use super::dot_product::RunningDot;
use super::rows::rows;
use crate::grid::{Field, LocalCells};
use crate::numbers::vectorised;
use bytemuck::Pod;
use std::ops::{Add, Mul, Sub};

/// A number of single or double precision.
pub(super) trait Number:
    Pod + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
}

impl Number for f32 {}
impl Number for f64 {}

/// a_f of the lower faces of cells along x, y and z, and d_c. The halo is two cells wide; faces in the faces of the box
/// are zero, unless these are periodic.
#[derive(Clone, Debug)]
pub(super) struct Coefficients<T = f64> {
    pub(super) faces: [Field<T>; 3],
    pub(super) diagonal: Field<T>,
}

impl<T: Number> Coefficients<T> {
    pub(super) fn new(cells: &LocalCells) -> Self {
        let zero = || Field::new(cells, 2);
        Self { faces: [zero(), zero(), zero()], diagonal: zero() }
    }

    /// All four fields.
    pub(super) fn fields(&mut self) -> [&mut Field<T>; 4] {
        let [x, y, z] = &mut self.faces;
        [x, y, z, &mut self.diagonal]
    }
}

vectorised!(
    /// The inverse of the diagonal of A; zero for a cell without any coupling.
    pub(super) fn set_inverse_diagonal(coefficients: &Coefficients<f32>, inverse: &mut Field<f32>) {
        let length = inverse.row_length();
        for [first, row] in rows([&coefficients.diagonal, &*inverse]) {
            let cells = CoefficientRow::new(coefficients, first, length);
            cells.invert_diagonal(&mut inverse.values_mut()[row..][..length]);
        }
    }
);

impl Coefficients<f64> {
    /// Sets marks to 1 in cells that are coupled to others or to zero, and to 0 in the rest.
    pub(super) fn mark_coupled(&self, marks: &mut Field) {
        let length = marks.row_length();
        for [from, to] in rows([&self.diagonal, marks]) {
            let cells = CoefficientRow::new(self, from, length);
            for (i, mark) in marks.values_mut()[to..][..length].iter_mut().enumerate() {
                *mark = if cells.sum(i) > 0.0 { 1.0 } else { 0.0 };
            }
        }
    }

    /// D p, D being the diagonal of A.
    pub(super) fn scale_by_diagonal(&self, p: &Field, scaled: &mut Field) {
        let length = p.row_length();
        for [from, to] in rows([&self.diagonal, p]) {
            let cells = CoefficientRow::new(self, from, length);
            for i in 0..length {
                scaled.values_mut()[to + i] = cells.sum(i) * p.values()[to + i];
            }
        }
    }
}

/// A x = b on the cells of a rank.
pub(super) struct Equation<'a, T = f64> {
    /// A.
    pub(super) coefficients: &'a Coefficients<T>,
    /// b.
    pub(super) right_hand_side: &'a Field<T>,
    /// x, or an approximation to it.
    pub(super) solution: &'a mut Field<T>,
}

/// The coefficients of a row of cells.
#[derive(Clone, Copy)]
struct CoefficientRow<'a, T> {
    lower_faces: [&'a [T]; 3],
    upper_faces: [&'a [T]; 3],
    diagonal: &'a [T],
}

impl<'a, T: Number> CoefficientRow<'a, T> {
    /// A row of `length` cells that begins at an index.
    #[inline(always)]
    fn new(coefficients: &'a Coefficients<T>, first: usize, length: usize) -> Self {
        let faces = coefficients.faces.each_ref().map(Field::values);
        let to_upper = coefficients.diagonal.strides();
        Self {
            lower_faces: slices(faces, [first; 3], length),
            upper_faces: slices(faces, to_upper.map(|stride| first + stride), length),
            diagonal: &coefficients.diagonal.values()[first..][..length],
        }
    }

    /// The diagonal of A, the sum of a_f and d_c, for the i-th cell.
    #[inline(always)]
    fn sum(&self, i: usize) -> T {
        let along = |axis: usize| self.lower_faces[axis][i] + self.upper_faces[axis][i];
        (along(0) + along(1)) + (along(2) + self.diagonal[i])
    }
}

impl CoefficientRow<'_, f32> {
    /// The inverse of the diagonal of A; zero for a cell without any coupling.
    #[inline(always)]
    fn invert_diagonal(&self, inverse: &mut [f32]) {
        for i in 0..inverse.len() {
            let sum = self.sum(i);
            inverse[i] = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        }
    }
}

/// A row of cells with its coefficients, and the values in the cells and in their neighbours.
#[derive(Clone, Copy)]
pub(super) struct StencilRow<'a, T> {
    coefficients: CoefficientRow<'a, T>,
    centre: &'a [T],
    below: [&'a [T]; 3],
    above: [&'a [T]; 3],
}

impl<'a, T: Number> StencilRow<'a, T> {
    /// A row of `length` cells, from the index `first` into the coefficients and the index `row` into the values.
    #[inline(always)]
    pub(super) fn new(
        coefficients: &'a Coefficients<T>,
        first: usize,
        values: &'a Field<T>,
        row: usize,
        length: usize,
    ) -> Self {
        let (strides, p) = (values.strides(), values.values());
        Self {
            coefficients: CoefficientRow::new(coefficients, first, length),
            centre: &p[row..][..length],
            below: slices([p; 3], strides.map(|stride| row - stride), length),
            above: slices([p; 3], strides.map(|stride| row + stride), length),
        }
    }

    /// A p in the i-th cell of the row. The order of the sum is fixed.
    #[inline(always)]
    pub(super) fn apply(&self, i: usize) -> T {
        let CoefficientRow { lower_faces, upper_faces, diagonal } = self.coefficients;
        let centre = self.centre[i];
        let along = |axis: usize| {
            lower_faces[axis][i] * (centre - self.below[axis][i])
                + upper_faces[axis][i] * (centre - self.above[axis][i])
        };
        (along(0) + along(1)) + (along(2) + diagonal[i] * centre)
    }

    /// q = A p in all cells of the row.
    #[inline(always)]
    fn apply_to_row(&self, q: &mut [T]) {
        for i in 0..q.len() {
            q[i] = self.apply(i);
        }
    }

    /// r = b - A p in all cells of the row.
    #[inline(always)]
    fn residual_of_row(&self, b: &[T], r: &mut [T]) {
        for i in 0..r.len() {
            r[i] = b[i] - self.apply(i);
        }
    }

    #[inline(always)]
    pub(super) fn centre(&self) -> &'a [T] {
        self.centre
    }
}

#[inline(always)]
fn slices<T>([x, y, z]: [&[T]; 3], [i, j, k]: [usize; 3], length: usize) -> [&[T]; 3] {
    [&x[i..][..length], &y[j..][..length], &z[k..][..length]]
}

vectorised!(
    /// q = A p; adds p . q to `dot`. The halos of p and q have the same width.
    pub(super) fn apply(
        coefficients: &Coefficients,
        p: &Field,
        q: &mut Field,
        dot: RunningDot,
    ) -> RunningDot {
        let mut dot = dot;
        let length = p.row_length();
        for [first, row] in rows([&coefficients.diagonal, p]) {
            let stencil = StencilRow::new(coefficients, first, p, row, length);
            stencil.apply_to_row(&mut q.values_mut()[row..][..length]);
            dot.add_row(p, &*q, row);
        }
        dot
    }
);

vectorised!(
    /// r = b - A x. Before: the halo of x is current.
    pub(super) fn residual<T: Number>(equation: &Equation<T>, r: &mut Field<T>) {
        let Equation { coefficients, right_hand_side: b, solution: ref x } = *equation;
        let length = x.row_length();
        for [first, row, row_of_b, row_of_r] in rows([&coefficients.diagonal, x, b, r]) {
            let stencil = StencilRow::new(coefficients, first, x, row, length);
            let b = &b.values()[row_of_b..][..length];
            stencil.residual_of_row(b, &mut r.values_mut()[row_of_r..][..length]);
        }
    }
);
