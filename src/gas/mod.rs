//! The gas: drag laws (pure), the one-dimensional column of gas that has no inertia, and the gas in three
//! dimensions.

mod column;
mod drag;
pub mod volume_averaged;

pub use column::{BaseNode, ColumnFields, ColumnGas, Drive, ParticleDrag, WeightBalance};
pub use drag::{
    Beetstra, DiFelice, DragCorrelation, DragLaw, Ergun, Gidaspow, SingleSphere, Switch, Tenneti,
    WenYu, WenYuCreeping,
};
