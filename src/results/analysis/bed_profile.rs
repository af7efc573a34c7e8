//! Solids fraction and velocity over the height, and the lower and upper limits of the bed.

use talcum_engine::coupling::{Bed, ColumnDeposition, DragShare};
use talcum_engine::grid::ColumnGrid;
use talcum_engine::parallel::Communicator;
use talcum_engine::particles::Particles;

/// The bed on a vertical grid, at the velocities of whole steps.
#[derive(Clone, Debug)]
pub struct BedProfile {
    grid: ColumnGrid,
    deposition: ColumnDeposition,
    bed: Bed,
    /// Solids fraction at the limits of the bed.
    threshold: f64,
}

impl BedProfile {
    /// A profile on a grid, for speeds up to a limit; the bed is where phi is above `threshold`.
    pub fn new(grid: ColumnGrid, speed_limit: f64, diameters: [f64; 2], threshold: f64) -> Self {
        let deposition = ColumnDeposition::new(&grid, speed_limit, diameters, DragShare::default());
        Self { grid, deposition, bed: Bed::default(), threshold }
    }

    /// The grid.
    pub fn grid(&self) -> &ColumnGrid {
        &self.grid
    }

    /// phi and u_s at the last update.
    pub fn bed(&self) -> &Bed {
        &self.bed
    }

    /// Updates the profile from the particles. Collective.
    pub fn update(&mut self, particles: &Particles, ranks: &dyn Communicator) {
        self.deposition.deposit(particles, &self.grid, &mut self.bed, ranks);
    }

    /// Volume of solids on the grid.
    pub fn solids_volume(&self) -> f64 {
        let phi = &self.bed.solids_fraction;
        (0..self.grid.nodes()).map(|node| phi[node] * self.grid.volume_of(node)).sum()
    }

    /// Heights at which phi rises above and falls below the threshold, interpolated linearly: the lowest and the
    /// highest; both 0 if there is no bed. A single layer that remains on the plate is not the bottom of the bed as
    /// long as it does not reach the threshold.
    pub fn bottom_and_top(&self) -> (f64, f64) {
        let phi = |node: usize| {
            let full = self.grid.cell_volume() / self.grid.volume_of(node);
            // At the plate the solids fill only half a cell.
            let halved = node == 0 && !self.grid.is_periodic() && full == 1.0;
            self.bed.solids_fraction[node] * if halved { 2.0 } else { 1.0 }
        };
        let nodes = self.grid.nodes();
        let inside = |&node: &usize| phi(node) >= self.threshold;
        let (Some(first), Some(last)) = ((0..nodes).find(inside), (0..nodes).rev().find(inside))
        else {
            return (0.0, 0.0);
        };
        let crossing = |outer: usize, inner: usize| {
            let part = (self.threshold - phi(outer)) / (phi(inner) - phi(outer));
            let (outer, inner) = (self.grid.height_of(outer), self.grid.height_of(inner));
            outer + part * (inner - outer)
        };
        let bottom = if first == 0 { 0.0 } else { crossing(first - 1, first) };
        let top =
            if last + 1 == nodes { self.grid.height_of(last) } else { crossing(last + 1, last) };
        (bottom, top)
    }
}
