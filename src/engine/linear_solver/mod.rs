//! The pressure equation on the cells of the box, solved by all ranks together. The result has the same bits for any
//! decomposition.
//!
//! ```math
//! (A p)_c = \sum_{f \in c} a_f (p_c - p_\text{nb}) + d_c p_c = b_c
//! ```
//!
//! a_f >= 0 couples the two cells of a face; d_c >= 0 couples a cell to zero (an outlet, a time derivative). Areas and
//! distances are contained in a_f and d_c, so that A is symmetric.
//!
//! The method is conjugate gradients \[Hestenes1952\], preconditioned by one cycle of geometric multigrid
//! \[Ashby1996\] in single precision:
//!
//! * `level_grid`: a coarser grid keeps every other cell along the axes along which cells are narrowest
//!   (semi-coarsening). Coarse grids follow from the whole grid alone, not from the decomposition.
//! * `interpolation`, `prolongation`: a cell that is left out is interpolated between its two neighbours along the axis
//!   with weights that follow from the coefficients of its faces. This is exact in one dimension, so that jumps of the
//!   coefficients do no harm \[Alcouffe1981\]. Restriction is the transpose.
//! * `coarse_operator`: coefficients of the coarser grid, in series along the axis and in parallel across it.
//! * `chebyshev_smoother`: a Chebyshev polynomial of the Jacobi iteration \[Adams2003\], which, unlike Gauss-Seidel,
//!   does not depend on the order of the cells.
//! * `replication`, `direct_solver`: every rank holds the whole of the small levels, and factorises the coarsest.
//! * `multigrid`: the hierarchy of levels, and the V- and W-cycle over them.
//! * `preconditioner`: the cycle, for equations in double precision.
//! * `conjugate_gradients`, `pressure_solver`: the iteration, and the interface for the rest of the crate.
//!
//! Dot products are sums of integers (`dot_product`), so that their bits do not depend on the order of the cells.
//!
//! * Adams2003: M. Adams, M. Brezina, J. Hu, R. Tuminaro, "Parallel multigrid smoothing: polynomial versus
//!   Gauss-Seidel", J. Comput. Phys. 188 (2003) 593-610.
//! * Alcouffe1981: R. E. Alcouffe, A. Brandt, J. E. Dendy, J. W. Painter, "The multi-grid method for the diffusion
//!   equation with strongly discontinuous coefficients", SIAM J. Sci. Stat. Comput. 2 (1981) 430-454.
//! * Ashby1996: S. F. Ashby, R. D. Falgout, "A parallel multigrid preconditioned conjugate gradient algorithm for
//!   groundwater flow simulations", Nucl. Sci. Eng. 124 (1996) 145-159.
//! * Hestenes1952: M. R. Hestenes, E. Stiefel, "Methods of conjugate gradients for solving linear systems", J. Res.
//!   Nat. Bur. Stand. 49 (1952) 409-436.

mod cell_pairs;
mod chebyshev_smoother;
mod coarse_operator;
mod conjugate_gradients;
mod convergence;
mod direct_solver;
mod dot_product;
mod interpolation;
mod level_grid;
mod level_transfer;
mod multigrid;
mod operator;
mod preconditioner;
mod pressure_solver;
mod prolongation;
mod replication;
mod rows;

pub use convergence::{Convergence, LinearSolverError, Tolerance};
pub use pressure_solver::PressureSolver;
