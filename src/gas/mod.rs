//! The gas: drag laws (pure), and the one-dimensional column of gas that has no inertia.

mod column;
mod drag;

pub use column::{BaseNode, ColumnFields, ColumnGas, Drive, ParticleDrag, WeightBalance};
pub use drag::{
    Beetstra, DiFelice, DragLaw, Ergun, Gidaspow, ScaledDrag, SingleSphere, Switch, Tenneti, WenYu,
    WenYuCreeping,
};
