//! The column gas: one-dimensional, vertical, without inertia. It follows the bed at every instant, so that it has no
//! state of its own, unless it comes out of a plenum, whose pressure is one.

mod block;
mod model;
mod plenum;
mod solver;

pub use model::{BaseNode, ColumnFields, ColumnGas, Drive, WeightBalance};
pub use plenum::Plenum;
pub use solver::ColumnSolver;
