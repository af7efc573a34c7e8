//! Smoothing: two steps of the Chebyshev iteration over the Jacobi preconditioner, each cell by itself.
//!
//! The eigenvalues of D^-1 A lie in [0, 2], since the diagonal is at least the sum of the other coefficients of its
//! row. The polynomial is small on [`SMOOTHED`], the part that coarse grids do not see, and the same before and after
//! the coarse grid, so that the cycle is symmetric.

use super::operator::{Coefficients, StencilRow};
use crate::grid::Field;
use crate::numbers::{VectorWork, in_wide_vectors};

/// Eigenvalues of D^-1 A that are smoothed. Waves of wavelength below four cells along one axis have 1/3 at least.
const SMOOTHED: [f64; 2] = [0.3, 2.0];

/// x_1 = x_0 + first D^-1 r_0 and x_2 = x_1 + momentum (x_1 - x_0) + second D^-1 r_1.
#[derive(Clone, Copy, Debug)]
struct Steps {
    first: f64,
    momentum: f64,
    second: f64,
}

impl Steps {
    /// The Chebyshev iteration on an interval (Saad, "Iterative methods for sparse linear systems", algorithm 12.1).
    const fn chebyshev([lower, upper]: [f64; 2]) -> Self {
        let (centre, half_width) = (0.5 * (upper + lower), 0.5 * (upper - lower));
        let sigma = centre / half_width;
        let rho = 1.0 / sigma;
        let next_rho = 1.0 / (2.0 * sigma - rho);
        Self { first: 1.0 / centre, momentum: next_rho * rho, second: 2.0 * next_rho / half_width }
    }
}

const STEPS: Steps = Steps::chebyshev(SMOOTHED);

/// A level's system, as far as smoothing sees it.
#[derive(Clone, Copy)]
pub(super) struct System<'a> {
    pub(super) coefficients: &'a Coefficients,
    pub(super) inverse_diagonal: &'a Field,
    pub(super) right: &'a Field,
}

impl System<'_> {
    /// Where rows begin in the coefficients and in the right-hand side; the other fields share theirs.
    #[inline(always)]
    fn rows(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        self.coefficients.diagonal.rows().zip(self.right.rows())
    }
}

/// x_1 from x_0 = 0.
pub(super) fn first_step_from_zero(system: System, next: &mut Field) {
    in_wide_vectors(FirstFromZero { system, next });
}

/// x_1 from x_0, whose halo is current.
pub(super) fn first_step(system: System, solution: &Field, next: &mut Field) {
    in_wide_vectors(First { system, solution, next });
}

/// x_2 from x_1, whose halo is current, and x_0 = 0.
pub(super) fn second_step_from_zero(system: System, middle: &Field, solution: &mut Field) {
    in_wide_vectors(Second::<true> { system, middle, solution });
}

/// x_2 from x_1, whose halo is current, in the place of x_0.
pub(super) fn second_step(system: System, middle: &Field, solution: &mut Field) {
    in_wide_vectors(Second::<false> { system, middle, solution });
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
        for (row, right) in self.next.rows().zip(self.system.right.rows()) {
            let right = &self.system.right.values()[right..][..length];
            let inverse = &self.system.inverse_diagonal.values()[row..][..length];
            for (i, next) in self.next.values_mut()[row..][..length].iter_mut().enumerate() {
                *next = STEPS.first * (inverse[i] * right[i]);
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
        for (row, (place, right)) in next.rows().zip(system.rows()) {
            let stencil = StencilRow::new((system.coefficients, place), (solution, row), length);
            let right = &system.right.values()[right..][..length];
            let inverse = &system.inverse_diagonal.values()[row..][..length];
            let x = stencil.centre();
            for (i, next) in next.values_mut()[row..][..length].iter_mut().enumerate() {
                *next = x[i] + STEPS.first * (inverse[i] * (right[i] - stencil.apply(i)));
            }
        }
    }
}

struct Second<'a, const FROM_ZERO: bool> {
    system: System<'a>,
    middle: &'a Field,
    solution: &'a mut Field,
}

impl<const FROM_ZERO: bool> VectorWork for Second<'_, FROM_ZERO> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { system, middle, solution } = self;
        let length = solution.count()[0];
        for (row, (place, right)) in solution.rows().zip(system.rows()) {
            let stencil = StencilRow::new((system.coefficients, place), (middle, row), length);
            let right = &system.right.values()[right..][..length];
            let inverse = &system.inverse_diagonal.values()[row..][..length];
            let x = stencil.centre();
            for (i, solution) in solution.values_mut()[row..][..length].iter_mut().enumerate() {
                let start = if FROM_ZERO { 0.0 } else { *solution };
                let scaled = inverse[i] * (right[i] - stencil.apply(i));
                *solution = x[i] + (STEPS.momentum * (x[i] - start) + STEPS.second * scaled);
            }
        }
    }
}
