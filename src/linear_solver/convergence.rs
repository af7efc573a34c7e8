//! What a solve is asked for, and how it went.

/// When a solution is good enough: |b - A p| <= max(relative |b|, absolute), |.| being the Euclidean norm over all
/// cells; or at most 2^-52 |D p|, D being the diagonal of A, which is what rounding leaves where the pressure is large
/// and all but constant (contrasts of 10^9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Part of the norm of the right-hand side; of what is left of it if a mean is taken away.
    pub relative: f64,
    /// In the unit of the right-hand side; 0 for none.
    pub absolute: f64,
}

impl Tolerance {
    /// Relative to the right-hand side alone.
    pub fn relative(relative: f64) -> Self {
        Self { relative, absolute: 0.0 }
    }
}

/// How a solve went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Convergence {
    /// Iterations, 0 if the start value was good enough.
    pub iterations: usize,
    /// |b - A p| at the end, formed anew from the solution.
    pub residual: f64,
    /// |b|.
    pub right_hand_side: f64,
    /// The mean that was taken from the right-hand side of a closed box: 0 unless what flows in there does not
    /// flow out.
    pub removed_mean: f64,
}

/// Why there is no solution: the same on all ranks.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LinearSolverError {
    /// A coefficient is negative, infinite or undefined.
    #[error(
        "the pressure equation has {0} coefficients that are negative, infinite or not a number; all must be at least 0"
    )]
    Coefficients(usize),
    /// The right-hand side or the start value is infinite or undefined.
    #[error("the pressure equation's right-hand side or start value is infinite or not a number")]
    NotFinite,
    /// The limit of iterations was reached.
    #[error(
        "the pressure equation did not converge: residual {residual:.3e} after {iterations} iterations, allowed is \
         {allowed:.3e}; either the equation has no solution (a part of the box without outlet takes in more than it \
         gives) or its coefficients differ too much"
    )]
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// Norm of the residual.
        residual: f64,
        /// Norm that was asked for.
        allowed: f64,
    },
}
