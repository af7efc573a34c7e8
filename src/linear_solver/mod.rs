//! The pressure equation on the cells of the box, across all ranks, with the same bits on any cut.
//!
//! ```text
//! (A p)_c = sum over the faces f of cell c of a_f (p_c - p_nb) + d_c p_c = b_c
//! ```
//!
//! a_f >= 0 couples the two cells of a face, d_c >= 0 holds a cell towards zero (an outlet, a time derivative). Areas
//! and distances are in a_f and d_c, so that A is symmetric. Conjugate gradients \[Hestenes1952\], preconditioned by
//! one V-cycle of geometric multigrid, after Ashby and Falgout \[Ashby1996\]:
//!
//! * coarse grids keep every other cell, along the axes along which cells are narrowest, and follow from the whole
//!   grid alone ([`PressureSolver::new`]);
//! * a cell that is left out takes its value from its two neighbours along the axis by the coefficients of its faces,
//!   which is exact in one dimension, so that jumps of coefficients do no harm; restriction is the transpose;
//! * coarse coefficients: in series along the axis, in parallel across it;
//! * smoothing by Chebyshev polynomials of the Jacobi iteration, every cell by itself;
//! * small levels are held by every rank; the smallest is factorised.
//!
//! Dot products are summed as integers (`exact_dot`), so that nothing depends on the order of cells.
//!
//! * Hestenes1952: M. R. Hestenes, E. Stiefel, "Methods of conjugate gradients for solving linear systems", J. Res.
//!   Nat. Bur. Stand. 49 (1952) 409-436.
//! * Ashby1996: S. F. Ashby, R. D. Falgout, "A parallel multigrid preconditioned conjugate gradient algorithm for
//!   groundwater flow simulations", Nucl. Sci. Eng. 124 (1996) 145-159.

mod coarsening;
mod convergence;
mod direct;
mod exact_dot;
mod gathering;
mod hierarchy;
mod operator;
mod pairs;
mod pressure_solver;
mod rows;
mod smoothing;
mod step;
mod transfer;

pub use convergence::{Convergence, LinearSolverError, Tolerance};
pub use pressure_solver::PressureSolver;
