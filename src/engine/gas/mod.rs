//! The gas: none, the column gas, or the volume-averaged gas, behind one type for each of model, state and solver.
//!
//! | | [`column`] | [`volume_averaged`] |
//! | --- | --- | --- |
//! | dimensions | one, vertical | three |
//! | inertia | none | with inertia: a step of its own, which covers several steps of the particles |
//! | model | [`ColumnGas`] | [`volume_averaged::VolumeAveragedModel`] |
//! | state | [`ColumnState`]: none, unless it comes out of a plenum or is compressible | [`volume_averaged::VolumeAveragedState`] |
//! | solver | [`ColumnSolver`] | [`volume_averaged::VolumeAveragedSolver`] |
//!
//! Both take their drag from the laws in [`DragLaw`], and their transfers from [`coupling`](crate::coupling).

mod column;
mod drag;
mod error;
mod model;
mod particle_limits;
mod solver;
mod state;
mod step;
pub mod volume_averaged;

pub use crate::coupling::{DragShare, NodeSums};
pub use column::{
    BaseNode, ColumnCell, ColumnFields, ColumnGas, ColumnSolver, ColumnState, Drive, Plenum,
    WeightBalance,
};
pub use drag::{
    AgglomerateBall, AgglomerateDrag, Beetstra, BlockDrag, CustomDragLaw, DiFelice,
    DragCorrelation, DragLaw, Ergun, Gidaspow, ParticleDrag, RegisteredDragLaw, SingleSphere,
    Switch, Tenneti, WenYu, WenYuCreeping,
};
pub use error::{GasError, GasForceOutOfRange, NavierStokesError};
pub use model::GasModel;
pub use particle_limits::ParticleLimits;
pub use solver::{GasLayout, GasObservables, GasSolver};
pub use state::GasState;
pub use step::{GasReport, GasStep};
