//! Particles to grid: solids fraction and velocity by hat weights, Moon 2006 eqs (8)-(10).

use crate::grid::ColumnGrid;
use crate::numbers::Quantum;
use crate::parallel::Communicator;
use crate::particles::Particles;

/// The bed as the gas sees it: fields at the nodes of the column grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bed {
    /// phi, volume of solids per volume.
    pub solids_fraction: Vec<f64>,
    /// u_s, mean vertical velocity of the solids by volume; 0 where there are none.
    pub solids_velocity: Vec<f64>,
    /// Sum of h d over particles per volume, from which drag on all sizes follows; only where asked for.
    pub diameter_density: Vec<f64>,
}

/// Sums over particles, exact in any order: every addend lies on a lattice.
#[derive(Clone, Debug)]
pub struct CoarseGraining {
    volume_lattice: Quantum,
    flux_lattice: Quantum,
    sums: Vec<f64>,
}

impl CoarseGraining {
    /// Room for solids fractions up to 4 (they end the run at 1) and for speeds up to the limit.
    pub fn new(grid: &ColumnGrid, speed_limit: f64) -> Self {
        Self {
            volume_lattice: Quantum::spanning(grid.cell_volume()),
            flux_lattice: Quantum::spanning(grid.cell_volume() * speed_limit),
            sums: vec![0.0; 2 * grid.nodes()],
        }
    }

    /// phi = sum_i h V / (S dz) and phi u_s = sum_i h V v_z / (S dz), h = 1 - |z_i - z_0| / dz.
    ///
    /// Velocities are those that the particles have now. Collective; before: owned particles are current.
    pub fn deposit(
        &mut self,
        particles: &Particles,
        grid: &ColumnGrid,
        bed: &mut Bed,
        ranks: &dyn Communicator,
    ) {
        let nodes = grid.nodes();
        self.sums.fill(0.0);
        let (volumes, fluxes) = self.sums.split_at_mut(nodes);
        for i in 0..particles.owned_count() {
            let weights = grid.weights(particles.position[i].z);
            let volume = particles.volume(i);
            let (flux, upper) = (volume * particles.velocity[i].z, weights.of_upper);
            volumes[weights.lower] += self.volume_lattice.round(volume * (1.0 - upper));
            volumes[weights.upper] += self.volume_lattice.round(volume * upper);
            fluxes[weights.lower] += self.flux_lattice.round(flux * (1.0 - upper));
            fluxes[weights.upper] += self.flux_lattice.round(flux * upper);
        }
        ranks.sum_exact(&mut self.sums);
        bed.solids_fraction.resize(nodes, 0.0);
        bed.solids_velocity.resize(nodes, 0.0);
        for node in 0..nodes {
            let (volume, flux) = (self.sums[node], self.sums[nodes + node]);
            bed.solids_fraction[node] = volume / grid.volume_of(node);
            bed.solids_velocity[node] = if volume > 0.0 { flux / volume } else { 0.0 };
        }
    }

    /// sum_i h d_i / (S dz), for the drag per volume of particles of all sizes. Collective.
    pub fn deposit_diameters(
        &mut self,
        particles: &Particles,
        grid: &ColumnGrid,
        bed: &mut Bed,
        ranks: &dyn Communicator,
    ) {
        let nodes = grid.nodes();
        let smallest = particles.radius.iter().copied().fold(f64::INFINITY, f64::min);
        let mut least = [-smallest];
        ranks.maximum(&mut least);
        let smallest = -least[0];
        bed.diameter_density.clear();
        bed.diameter_density.resize(nodes, 0.0);
        if !smallest.is_finite() {
            return;
        }
        // No more particles fit in a cell than its volume over the smallest's cube.
        let lattice = Quantum::spanning(2.0 * grid.cell_volume() / (smallest * smallest));
        for i in 0..particles.owned_count() {
            let weights = grid.weights(particles.position[i].z);
            let diameter = 2.0 * particles.radius[i];
            bed.diameter_density[weights.lower] +=
                lattice.round(diameter * (1.0 - weights.of_upper));
            bed.diameter_density[weights.upper] += lattice.round(diameter * weights.of_upper);
        }
        ranks.sum_exact(&mut bed.diameter_density);
        for (node, sum) in bed.diameter_density.iter_mut().enumerate() {
            *sum /= grid.volume_of(node);
        }
    }
}
