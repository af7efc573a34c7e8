//! The gas: drag laws (pure), and the one-dimensional column of gas that has no inertia.

mod column;
mod drag;

pub use column::{BaseNode, ColumnFields, ColumnGas, Drive, ParticleDrag, WeightBalance};
pub use drag::DragLaw;
