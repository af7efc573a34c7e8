//! Smoothing: three steps of the Chebyshev iteration over the Jacobi preconditioner, each cell by itself.
//!
//! The eigenvalues of D^-1 A lie in [0, 2], since the diagonal is at least the sum of the other coefficients of its
//! row. The polynomial is small on [`SMOOTHED`], the part that coarse grids do not see, and the same before and after
//! the coarse grid, so that the cycle is symmetric.

use super::operator::{Coefficients, StencilRow};
use super::rows::rows;
use crate::grid::Field;
use crate::numbers::{VectorWork, in_wide_vectors};

/// Eigenvalues of D^-1 A that are smoothed. Waves shorter than four cells along one axis have 1/3 at least; where
/// coefficients jump, coarse grids miss more than that.
const SMOOTHED: [f64; 2] = [0.2, 2.0];

/// x_1 = x_0 + FIRST D^-1 r_0.
const FIRST: f64 = 2.0 / (SMOOTHED[0] + SMOOTHED[1]);

/// x_2 and x_3 from the two before.
const NEXT: [Momentum; 2] = Momentum::chebyshev(SMOOTHED);

/// x_(n+1) = x_n + memory (x_n - x_(n-1)) + step D^-1 r_n.
#[derive(Clone, Copy, Debug)]
struct Momentum {
    history: f64,
    step: f64,
}

impl Momentum {
    /// The Chebyshev iteration on an interval (Saad, "Iterative methods for sparse linear systems", algorithm 12.1).
    const fn chebyshev([lower, upper]: [f64; 2]) -> [Self; 2] {
        let half_width = 0.5 * (upper - lower);
        let sigma = 0.5 * (upper + lower) / half_width;
        let first = 1.0 / sigma;
        let second = 1.0 / (2.0 * sigma - first);
        let third = 1.0 / (2.0 * sigma - second);
        [
            Self { history: second * first, step: 2.0 * second / half_width },
            Self { history: third * second, step: 2.0 * third / half_width },
        ]
    }
}

/// A level's system, as far as smoothing sees it.
#[derive(Clone, Copy)]
pub(super) struct System<'a> {
    pub(super) coefficients: &'a Coefficients,
    pub(super) inverse_diagonal: &'a Field,
    pub(super) right: &'a Field,
}

/// Smooths from x_0 = 0, or from the x_0 in `solution`; its halo is current afterwards. Numbers of `middle` are lost.
pub(super) fn smooth(
    system: System,
    [solution, middle]: [&mut Field; 2],
    from_zero: bool,
    mut refresh: impl FnMut(&mut Field),
) {
    if from_zero {
        in_wide_vectors(FirstFromZero { system, next: middle });
        refresh(middle);
        in_wide_vectors(Next::<true> { system, by: NEXT[0], present: middle, last: solution });
    } else {
        in_wide_vectors(First { system, solution, next: middle });
        refresh(middle);
        in_wide_vectors(Next::<false> { system, by: NEXT[0], present: middle, last: solution });
    }
    refresh(solution);
    in_wide_vectors(Next::<false> { system, by: NEXT[1], present: solution, last: middle });
    std::mem::swap(solution, middle);
    refresh(solution);
}

struct FirstFromZero<'a> {
    system: System<'a>,
    next: &'a mut Field,
}

impl VectorWork for FirstFromZero<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let length = self.next.count()[0];
        for [row, right] in rows([&*self.next, self.system.right]) {
            let right = &self.system.right.values()[right..][..length];
            let inverse = &self.system.inverse_diagonal.values()[row..][..length];
            for (i, next) in self.next.values_mut()[row..][..length].iter_mut().enumerate() {
                *next = FIRST * (inverse[i] * right[i]);
            }
        }
    }
}

struct First<'a> {
    system: System<'a>,
    solution: &'a Field,
    next: &'a mut Field,
}

impl VectorWork for First<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { system, solution, next } = self;
        let length = next.count()[0];
        for [row, place, right] in rows([&*next, &system.coefficients.diagonal, system.right]) {
            let stencil = StencilRow::new((system.coefficients, place), (solution, row), length);
            let right = &system.right.values()[right..][..length];
            let inverse = &system.inverse_diagonal.values()[row..][..length];
            let x = stencil.centre();
            for (i, next) in next.values_mut()[row..][..length].iter_mut().enumerate() {
                *next = x[i] + FIRST * (inverse[i] * (right[i] - stencil.apply(i)));
            }
        }
    }
}

/// The next approximation in the place of the last one, which is zero or stands there.
struct Next<'a, const FROM_ZERO: bool> {
    system: System<'a>,
    by: Momentum,
    present: &'a Field,
    last: &'a mut Field,
}

impl<const FROM_ZERO: bool> VectorWork for Next<'_, FROM_ZERO> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { system, by: Momentum { history, step }, present, last } = self;
        let length = last.count()[0];
        for [row, place, right] in rows([&*last, &system.coefficients.diagonal, system.right]) {
            let stencil = StencilRow::new((system.coefficients, place), (present, row), length);
            let right = &system.right.values()[right..][..length];
            let inverse = &system.inverse_diagonal.values()[row..][..length];
            let x = stencil.centre();
            for (i, value) in last.values_mut()[row..][..length].iter_mut().enumerate() {
                let last = if FROM_ZERO { 0.0 } else { *value };
                let scaled = inverse[i] * (right[i] - stencil.apply(i));
                *value = x[i] + (history * (x[i] - last) + step * scaled);
            }
        }
    }
}
