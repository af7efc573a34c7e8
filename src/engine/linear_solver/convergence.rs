//! The required accuracy of a solution, and a report on the solve.

/// The criterion of convergence: |b - A p| <= max(relative |b|, absolute), |.| being the Euclidean norm over all cells.
///
/// A residual of 2^-52 |D p|, D being the diagonal of A, is accepted too: it is the rounding error of b - A p where
/// the pressure is large and almost constant (coefficients that differ by 10^9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Fraction of the norm of the right-hand side, after its mean was subtracted in a closed box.
    pub relative: f64,
    /// Absolute tolerance, in units of the right-hand side; 0 if there is none.
    pub absolute: f64,
}

impl Tolerance {
    /// A tolerance relative to the right-hand side only.
    pub fn relative(relative: f64) -> Self {
        Self { relative, absolute: 0.0 }
    }
}

/// Report on a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Convergence {
    /// Number of iterations; 0 if the start values were good enough.
    pub iterations: usize,
    /// |b - A p| at the end, computed from the solution.
    pub residual: f64,
    /// |b|.
    pub right_hand_side: f64,
    /// The mean that was subtracted from the right-hand side in a closed box; 0 if inflow and outflow are equal.
    pub removed_mean: f64,
}

/// Reason why there is no solution; the error is the same on all ranks.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LinearSolverError {
    /// A coefficient is negative, infinite or undefined.
    #[error(
        "the pressure equation has {0} coefficients that are negative, infinite or not a number; all must be at least 0"
    )]
    Coefficients(usize),
    /// The right-hand side or a start value is infinite or undefined.
    #[error("the pressure equation's right-hand side or a start value is infinite or not a number")]
    NotFinite,
    /// The limit on the number of iterations was reached.
    #[error(
        "the pressure equation did not converge: residual {residual:.3e} after {iterations} iterations, allowed is \
         {allowed:.3e}; either the equation has no solution (more flows into a part of the box without outlet than out of \
         it) or its coefficients differ too much"
    )]
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// Norm of the residual reached.
        residual: f64,
        /// Largest norm allowed.
        allowed: f64,
    },
}
