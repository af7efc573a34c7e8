//! Gas that flows in three dimensions between the particles: volume-averaged Navier-Stokes equations, model A,
//! constant density.

mod model;
mod state;

pub use model::{Boundary, Inlet, Profile, VolumeAveragedGas};
pub use state::{BedOnGrid, GAS_HALO, GasState};
