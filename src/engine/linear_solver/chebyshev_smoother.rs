//! Smoothing: three steps of the Chebyshev iteration with the Jacobi preconditioner D^-1 (Saad, "Iterative methods for
//! sparse linear systems", 2nd edition 2003, algorithm 12.1).
//!
//! The eigenvalues of D^-1 A lie in [0, 2], since the diagonal is at least the sum of the other coefficients of its
//! row. The polynomial is small on [`SMOOTHED`], the part of the spectrum that coarse grids do not represent. It is the
//! same before and after the coarse-grid correction, so that the cycle is symmetric.

use super::operator::{Coefficients, StencilRow};
use super::rows::rows;
use crate::grid::Field;
use crate::numbers::vectorised;

/// Eigenvalues of D^-1 A that are smoothed. Waves shorter than four cells along one axis have eigenvalues of at least
/// 1/3; where coefficients jump, coarse grids also fail to represent some smaller ones.
const SMOOTHED: [f32; 2] = [0.2, 2.0];

/// x_1 = x_0 + FIRST D^-1 r_0.
const FIRST: f32 = 2.0 / (SMOOTHED[0] + SMOOTHED[1]);

/// Coefficients for x_2 and x_3.
const NEXT: [Recurrence; 2] = Recurrence::chebyshev(SMOOTHED);

/// x_(n+1) = x_n + momentum (x_n - x_(n-1)) + step D^-1 r_n.
#[derive(Clone, Copy, Debug)]
struct Recurrence {
    momentum: f32,
    step: f32,
}

impl Recurrence {
    /// The coefficients of the Chebyshev iteration on an interval of eigenvalues.
    const fn chebyshev([lower, upper]: [f32; 2]) -> [Self; 2] {
        let half_width = 0.5 * (upper - lower);
        let sigma = 0.5 * (upper + lower) / half_width;
        let first = 1.0 / sigma;
        let second = 1.0 / (2.0 * sigma - first);
        let third = 1.0 / (2.0 * sigma - second);
        [
            Self { momentum: second * first, step: 2.0 * second / half_width },
            Self { momentum: third * second, step: 2.0 * third / half_width },
        ]
    }
}

/// A x = b with the inverse of the diagonal D of A.
#[derive(Clone, Copy)]
pub(super) struct System<'a> {
    pub(super) coefficients: &'a Coefficients<f32>,
    pub(super) inverse_diagonal: &'a Field<f32>,
    pub(super) right_hand_side: &'a Field<f32>,
}

/// Smooths from x_0 = 0, or from the x_0 in `solution`, whose halo is then current. After: the halo of `solution` is
/// out of date, and `scratch` is overwritten.
pub(super) fn smooth(
    system: System,
    [solution, scratch]: [&mut Field<f32>; 2],
    from_zero: bool,
    mut refresh: impl FnMut(&mut Field<f32>),
) {
    if from_zero {
        set_first_from_zero(system, scratch);
        refresh(scratch);
        set_next_from_zero(system, NEXT[0], scratch, solution);
    } else {
        set_first(system, solution, scratch);
        refresh(scratch);
        set_next(system, NEXT[0], scratch, solution);
    }
    refresh(solution);
    set_next(system, NEXT[1], solution, scratch);
    std::mem::swap(solution, scratch);
}

/// A row of cells of the system, with an approximation x to its solution.
struct SystemRow<'a> {
    stencil: StencilRow<'a, f32>,
    right_hand_side: &'a [f32],
    inverse_diagonal: &'a [f32],
}

impl<'a> SystemRow<'a> {
    /// A row of `length` cells that begins at these indices: into x and D^-1, into the coefficients, into b.
    #[inline(always)]
    fn new(
        system: System<'a>,
        x: &'a Field<f32>,
        [row, first, right]: [usize; 3],
        length: usize,
    ) -> Self {
        Self {
            stencil: StencilRow::new(system.coefficients, first, x, row, length),
            right_hand_side: &system.right_hand_side.values()[right..][..length],
            inverse_diagonal: &system.inverse_diagonal.values()[row..][..length],
        }
    }

    /// D^-1 (b - A x) in the i-th cell.
    #[inline(always)]
    fn scaled_residual(&self, i: usize) -> f32 {
        self.inverse_diagonal[i] * (self.right_hand_side[i] - self.stencil.apply(i))
    }

    /// x + FIRST D^-1 (b - A x).
    #[inline(always)]
    fn first(&self, next: &mut [f32]) {
        let x = self.stencil.centre();
        for i in 0..next.len() {
            next[i] = x[i] + FIRST * self.scaled_residual(i);
        }
    }

    /// Replaces the previous approximation by the next one; with `FROM_ZERO` the previous approximation is zero,
    /// whatever `last` contains.
    #[inline(always)]
    fn next<const FROM_ZERO: bool>(&self, recurrence: Recurrence, last: &mut [f32]) {
        let Recurrence { momentum, step } = recurrence;
        let x = self.stencil.centre();
        for i in 0..last.len() {
            let before = if FROM_ZERO { 0.0 } else { last[i] };
            last[i] = x[i] + (momentum * (x[i] - before) + step * self.scaled_residual(i));
        }
    }
}

vectorised!(
    /// x_1 from x_0 = 0.
    fn set_first_from_zero(system: System, next: &mut Field<f32>) {
        let length = next.row_length();
        for [row, right] in rows([&*next, system.right_hand_side]) {
            let right = &system.right_hand_side.values()[right..][..length];
            let inverse = &system.inverse_diagonal.values()[row..][..length];
            first_from_zero(&mut next.values_mut()[row..][..length], inverse, right);
        }
    }
);

#[inline(always)]
fn first_from_zero(next: &mut [f32], inverse_diagonal: &[f32], right_hand_side: &[f32]) {
    for i in 0..next.len() {
        next[i] = FIRST * (inverse_diagonal[i] * right_hand_side[i]);
    }
}

vectorised!(
    /// x_1 from x_0.
    fn set_first(system: System, solution: &Field<f32>, next: &mut Field<f32>) {
        let length = next.row_length();
        for at in rows([&*next, &system.coefficients.diagonal, system.right_hand_side]) {
            let row = SystemRow::new(system, solution, at, length);
            row.first(&mut next.values_mut()[at[0]..][..length]);
        }
    }
);

vectorised!(
    /// x_(n+1) from x_n; overwrites x_(n-1).
    fn set_next(
        system: System,
        recurrence: Recurrence,
        present: &Field<f32>,
        last: &mut Field<f32>,
    ) {
        next_in_rows::<false>(system, recurrence, present, last);
    }
);

vectorised!(
    /// x_(n+1) from x_n and x_(n-1) = 0; overwrites the field that would contain x_(n-1).
    fn set_next_from_zero(
        system: System,
        recurrence: Recurrence,
        present: &Field<f32>,
        last: &mut Field<f32>,
    ) {
        next_in_rows::<true>(system, recurrence, present, last);
    }
);

#[inline(always)]
fn next_in_rows<const FROM_ZERO: bool>(
    system: System,
    recurrence: Recurrence,
    present: &Field<f32>,
    last: &mut Field<f32>,
) {
    let length = last.row_length();
    for at in rows([&*last, &system.coefficients.diagonal, system.right_hand_side]) {
        let row = SystemRow::new(system, present, at, length);
        row.next::<FROM_ZERO>(recurrence, &mut last.values_mut()[at[0]..][..length]);
    }
}
