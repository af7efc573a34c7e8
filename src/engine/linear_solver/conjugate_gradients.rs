//! Conjugate gradients with a multigrid preconditioner M (Saad, "Iterative methods for sparse linear systems",
//! 2nd edition 2003, algorithm 9.1):
//!
//! ```math
//! \begin{aligned}
//! z &= M r, & \beta &= \frac{r \cdot z}{(r \cdot z)_\text{last}}, & p &\leftarrow z + \beta p, \\
//! q &= A p, & \alpha &= \frac{r \cdot z}{p \cdot q}, & x &\leftarrow x + \alpha p, & r &\leftarrow r - \alpha q
//! \end{aligned}
//! ```

use super::convergence::LinearSolverError;
use super::dot_product::{DotProduct, RunningDot, Values};
use super::multigrid::Cycle;
use super::operator::{Equation, apply, residual};
use super::preconditioner::{Preconditioned, Preconditioner};
use super::rows::{copy_owned, rows};
use crate::domain::Subdomain;
use crate::grid::{Field, LocalCells};
use crate::numbers::vectorised;
use crate::parallel::{Communicator, FieldHalo};

/// Number of iterations after which a solve is given up.
const ITERATION_LIMIT: usize = 200;

/// The vectors of the iteration, and their halo.
#[derive(Clone, Debug)]
pub(super) struct ConjugateGradients {
    halo: FieldHalo,
    /// r
    residual: Field,
    /// p
    direction: Field,
    /// q = A p
    applied: Field,
}

/// Data known before the first iteration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    /// |b| and the product from which it follows, if all start values are zero: r is then b.
    pub(super) norm: Option<(f64, DotProduct)>,
    /// Largest |b - A x| at the end.
    pub(super) allowed: f64,
}

/// Progress of a solve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solved {
    /// Iterations done.
    pub(super) iterations: usize,
    /// |b - A x|.
    pub(super) residual: f64,
}

/// Data kept when the iteration is restarted: the magnitudes of the dot products, and the kind of cycle.
#[derive(Clone, Copy, Debug)]
struct Restart {
    /// r . r
    squared_residual: DotProduct,
    /// r . z
    residual_dot_preconditioned: DotProduct,
    /// p . A p
    curvature: DotProduct,
    /// V after W was found not to be positive definite.
    cycle: Cycle,
    iterations: usize,
}

impl Restart {
    fn new(squared_residual: DotProduct) -> Self {
        Self {
            squared_residual,
            residual_dot_preconditioned: DotProduct::default(),
            curvature: DotProduct::default(),
            cycle: Cycle::W,
            iterations: 0,
        }
    }
}

impl ConjugateGradients {
    pub(super) fn new(cells: &LocalCells, subdomain: Subdomain) -> Self {
        let zero = || Field::new(cells, 1);
        Self {
            halo: FieldHalo::new(subdomain),
            residual: zero(),
            direction: zero(),
            applied: zero(),
        }
    }

    /// A vector that may be overwritten between two solves.
    pub(super) fn scratch(&mut self) -> &mut Field {
        &mut self.applied
    }

    /// Improves the solution until |b - A x|, computed from the solution itself, is as small as allowed or as rounding
    /// permits. The iteration is restarted if only the residual that it updates is small. This call is collective.
    pub(super) fn solve(
        &mut self,
        equation: &mut Equation,
        preconditioner: &mut Preconditioner,
        start: Start,
        ranks: &dyn Communicator,
    ) -> Result<Solved, LinearSolverError> {
        let allowed = start.allowed;
        let (mut norm, squared_residual) = self.first_residual(equation, start, ranks);
        let mut restart = Restart::new(squared_residual);
        loop {
            if !(norm + allowed).is_finite() {
                return Err(LinearSolverError::NotFinite);
            }
            let iterations = restart.iterations;
            if norm <= allowed || (iterations > 0 && norm <= self.rounding(equation, ranks)) {
                return Ok(Solved { iterations, residual: norm });
            }
            self.iterate(equation, preconditioner, &mut restart, [norm, allowed], ranks)?;
            norm = self.set_residual(equation, &mut restart.squared_residual, ranks);
        }
    }

    /// Sets r = b - A x for the start values, and returns |r| and the product from which it follows. This call is
    /// collective.
    fn first_residual(
        &mut self,
        equation: &mut Equation,
        start: Start,
        ranks: &dyn Communicator,
    ) -> (f64, DotProduct) {
        if let Some(known) = start.norm {
            copy_owned(equation.right_hand_side, &mut self.residual);
            return known;
        }
        let mut squared = DotProduct::default();
        (self.set_residual(equation, &mut squared, ranks), squared)
    }

    /// Sets r = b - A x, and returns |r|, the root of this product. This call is collective.
    fn set_residual(
        &mut self,
        equation: &mut Equation,
        squared: &mut DotProduct,
        ranks: &dyn Communicator,
    ) -> f64 {
        self.halo.refresh(&mut [&mut *equation.solution], ranks);
        residual(equation, &mut self.residual);
        squared.of(&self.residual, &self.residual, ranks).sqrt()
    }

    /// The rounding error of b - A x: 2^-52 |D x|, D being the diagonal of A. No solution in double precision has a
    /// residual much below it. This call is collective.
    fn rounding(&mut self, equation: &Equation, ranks: &dyn Communicator) -> f64 {
        equation.coefficients.scale_by_diagonal(equation.solution, &mut self.applied);
        DotProduct::default().of(&self.applied, &self.applied, ranks).sqrt() * f64::EPSILON
    }

    /// Iterates from the residual at hand, whose norm is given, until the norm of the updated residual is allowed.
    fn iterate(
        &mut self,
        equation: &mut Equation,
        preconditioner: &mut Preconditioner,
        restart: &mut Restart,
        [mut norm, allowed]: [f64; 2],
        ranks: &dyn Communicator,
    ) -> Result<(), LinearSolverError> {
        let mut last_product = f64::INFINITY;
        while norm > allowed {
            let failed = LinearSolverError::NotConverged {
                iterations: restart.iterations,
                residual: norm,
                allowed,
            };
            if restart.iterations == ITERATION_LIMIT {
                return Err(failed);
            }
            let (mut z, mut product) = self.precondition(preconditioner, restart, norm, ranks);
            if product <= 0.0 {
                restart.cycle = Cycle::V;
                last_product = f64::INFINITY;
                (z, product) = self.precondition(preconditioner, restart, norm, ranks);
            }
            update_direction(&mut self.direction, z, product / last_product);
            last_product = product;
            self.halo.refresh(&mut [&mut self.direction], ranks);
            let squared_norm = self.update_solution(equation, restart, product, ranks);
            if !squared_norm.is_finite() {
                return Err(failed);
            }
            norm = squared_norm.sqrt();
            restart.iterations += 1;
        }
        Ok(())
    }

    /// Returns z = M r for an r with this norm, and r . z. This call is collective.
    fn precondition<'a>(
        &self,
        preconditioner: &'a mut Preconditioner,
        restart: &mut Restart,
        norm: f64,
        ranks: &dyn Communicator,
    ) -> (Preconditioned<'a>, f64) {
        let z = preconditioner.apply(restart.cycle, (&self.residual, norm), ranks);
        (z, restart.residual_dot_preconditioned.of(&self.residual, z, ranks))
    }

    /// q = A p, x <- x + alpha p, r <- r - alpha q with alpha = (r . z) / (p . q); returns r . r. Before: the halo of
    /// p is current. This call is collective.
    fn update_solution(
        &mut self,
        equation: &mut Equation,
        restart: &mut Restart,
        residual_dot_preconditioned: f64,
        ranks: &dyn Communicator,
    ) -> f64 {
        let Self { residual, direction, applied, .. } = self;
        let dot = restart.curvature.begin();
        let dot = apply(equation.coefficients, direction, applied, dot);
        let curvature = restart.curvature.finish(dot, (direction, &*applied), ranks);
        let alpha = residual_dot_preconditioned / curvature;
        let dot = restart.squared_residual.begin();
        let dot = update_solution(alpha, direction, applied, equation.solution, residual, dot);
        restart.squared_residual.finish(dot, (residual, &*residual), ranks)
    }
}

vectorised!(
    /// p <- z + beta p.
    fn update_direction(direction: &mut Field, preconditioned: Preconditioned, beta: f64) {
        let length = direction.row_length();
        for [row] in rows([&*direction]) {
            let preconditioned = preconditioned.row(row, length);
            let direction = &mut direction.values_mut()[row..][..length];
            for (p, z) in direction.iter_mut().zip(preconditioned) {
                *p = z + beta * *p;
            }
        }
    }
);

vectorised!(
    /// x <- x + alpha p, r <- r - alpha q; returns r . r, the sum that `dot` begins.
    fn update_solution(
        alpha: f64,
        direction: &Field,
        applied: &Field,
        solution: &mut Field,
        residual: &mut Field,
        dot: RunningDot,
    ) -> RunningDot {
        let mut dot = dot;
        let length = direction.row_length();
        for [row] in rows([direction]) {
            let p = &direction.values()[row..][..length];
            for (x, p) in solution.values_mut()[row..][..length].iter_mut().zip(p) {
                *x += alpha * p;
            }
            let q = &applied.values()[row..][..length];
            let r = &mut residual.values_mut()[row..][..length];
            for (r, q) in r.iter_mut().zip(q) {
                *r -= alpha * q;
            }
            dot.add_row(residual, &*residual, row);
        }
        dot
    }
);
