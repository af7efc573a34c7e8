//! The column gas: one-dimensional, vertical, without inertia. It follows the bed at every instant and has no state of
//! its own, unless it comes from a plenum, whose pressure is its state, or is compressible.

mod block;
mod compressible;
mod compressible_solver;
mod model;
mod node_forces;
mod plenum;
mod solver;
mod state;
mod tridiagonal;

pub use compressible::ColumnCell;
pub use model::{BaseNode, ColumnFields, ColumnGas, Drive, WeightBalance};
pub use plenum::Plenum;
pub use solver::ColumnSolver;
pub use state::ColumnState;
