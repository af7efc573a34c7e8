//! The gas as a case chooses it: what it is made of, what happens at the faces of the box, how it is coupled to the
//! particles.

use super::{Boundary, GAS_HALO};
use crate::domain::Decomposition;
use crate::gas::ParticleDrag;
use crate::grid::BoxGrid;
use crate::linear_solver::Tolerance;
use nalgebra::Vector3;

/// The volume-averaged gas and its coupling to the particles.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeAveragedModel {
    /// Its cells.
    pub grid: BoxGrid,
    /// What it is made of, and what happens at the faces of the box.
    pub gas: VolumeAveragedGas,
    /// How it is coupled to the particles.
    pub coupling: CouplingModel,
    /// Steps of the particles in one of the gas.
    pub substeps: u64,
    /// Driving force per volume of gas, for boxes through which nothing else moves it.
    pub driving: Vector3<f64>,
}

/// How particles and the gas on cells exchange momentum.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingModel {
    /// Drag on particles.
    pub drag: ParticleDrag,
    /// Full width at half maximum of the filter; 0 for none.
    pub filter_width: f64,
    /// Smallest voidage: lower ones are raised to it, and their cells counted.
    pub least_voidage: f64,
}

impl VolumeAveragedModel {
    /// A decomposition with its cut planes moved to cell faces, subdomains being at least `width` and two cells wide;
    /// none if there are too few cells.
    pub fn aligned(&self, decomposition: &Decomposition, width: f64) -> Option<Decomposition> {
        let cut_axes = (0..3).filter(|&axis| decomposition.grid().0[axis] > 1);
        let cells = cut_axes.map(|axis| (width / self.grid.spacing()[axis]).ceil() as usize);
        self.grid.aligned(decomposition, cells.max().unwrap_or(0).max(GAS_HALO))
    }
}

/// A gas that flows in three dimensions between the particles; see the [module](super) for its equations.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeAveragedGas {
    /// Density rho, constant.
    pub density: f64,
    /// Dynamic viscosity mu.
    pub viscosity: f64,
    /// What happens at the lower and the upper face along each axis.
    pub boundaries: [[Boundary; 2]; 3],
    /// How exactly each step obeys continuity: the norm of div(eps u) + d(eps)/dt that is left.
    pub tolerance: Tolerance,
}
