//! The column gas: one-dimensional, vertical, without inertia. It follows the bed at every instant, so that it has no
//! state of its own.

mod block;
mod model;
mod solver;

pub use model::{BaseNode, ColumnFields, ColumnGas, Drive, WeightBalance};
pub use solver::ColumnSolver;
