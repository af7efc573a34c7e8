//! Gas that flows in three dimensions between the particles: volume-averaged Navier-Stokes equations, model A,
//! constant density.

mod advection;
mod boundaries;
mod faces;
mod model;
mod momentum;
mod solver;
mod state;
mod viscosity;

pub use model::{Boundary, Inlet, Profile, VolumeAveragedGas};
pub use solver::{GasError, GasReport, GasSolver, GasStep};
pub use state::{BedOnGrid, GAS_HALO, GasState};
