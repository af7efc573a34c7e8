//! Particles to grid, grid to particles, and the force of the gas.

mod coarse_grain;
mod column_block;
mod fluid_force;
mod gas_block;
mod resolved;

pub use coarse_grain::{Bed, CoarseGraining};
pub use fluid_force::{FluidForce, GasForceOutOfRange};
pub use resolved::{
    CellCoupling, CouplingModel, Filter, Flow, FlowModel, FlowReport, FlowSolver, FlowStep,
    ParticleLimits,
};
