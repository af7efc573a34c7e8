//! The Sauter mean diameter of the particles around a place.

use crate::coupling::{CellTransfer, Corners, DragShare, deposit, interpolate};
use crate::grid::{Field, LocalCells};
use crate::numbers::Quantum;
use crate::parallel::Communicator;
use crate::particles::Particles;
use std::f64::consts::PI;

use super::super::GAS_HALO;

/// Volume and squared diameters of the particles on the grid, by the weights of the voidage.
#[derive(Clone, Debug)]
pub(super) struct MeanDiameter {
    sums: [Field; 2],
    quanta: [Quantum; 2],
}

impl MeanDiameter {
    /// Mean diameters for cells of this volume, and particles between two diameters.
    pub(super) fn new(part: &LocalCells, cell_volume: f64, [smallest, largest]: [f64; 2]) -> Self {
        let volume = cell_volume + largest.powi(3);
        // The number of spheres in a cell is at most its volume over that of the smallest sphere.
        let surface = 6.0 / PI * volume / smallest + largest.powi(2);
        let zero = Field::new(part, GAS_HALO);
        Self { sums: [zero.clone(), zero], quanta: [volume, surface].map(Quantum::spanning) }
    }

    /// Sums up the particles that were deposited last. Collective.
    pub(super) fn deposit(
        &mut self,
        transfer: &mut CellTransfer,
        particles: &Particles,
        ranks: &dyn Communicator,
    ) {
        self.sums.iter_mut().for_each(|field| field.values_mut().fill(0.0));
        for (i, corners) in transfer.corners().iter().enumerate() {
            let surface = DragShare::Surface.of(2.0 * particles.body[i].radius);
            deposit(self.sums.each_mut(), self.quanta, corners, [particles.volume(i), surface]);
        }
        let [volume, surface] = &mut self.sums;
        transfer.sum_per_volume(&mut [volume, surface], ranks);
        transfer.refresh(&mut [volume, surface], ranks);
    }

    /// The mean diameter at a place; the diameter of the particle there if it is the only one.
    pub(super) fn at(&self, corners: &Corners, own: f64) -> f64 {
        let [volume, surface] = interpolate(self.sums.each_ref(), corners);
        // The filter rounds values far from all particles.
        let defined = volume > 0.0 && surface > 0.0;
        if defined { DragShare::Surface.diameter_of_equals(volume, surface) } else { own }
    }
}
