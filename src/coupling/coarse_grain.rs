//! Particles to grid: solids fraction and velocity by hat weights, Moon 2006 eqs (8)-(10).

use crate::grid::ColumnGrid;
use crate::numbers::Quantum;
use crate::parallel::Communicator;
use crate::particles::Particles;
use std::f64::consts::PI;

/// The bed as the gas sees it: fields at the nodes of the column grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bed {
    /// phi, volume of solids per volume.
    pub solids_fraction: Vec<f64>,
    /// u_s, mean vertical velocity of the solids by volume; 0 where there are none.
    pub solids_velocity: Vec<f64>,
    /// Sum of particle diameters per volume: what drag per volume is proportional to.
    pub diameter_density: Vec<f64>,
    /// u_d, mean vertical velocity of the solids by diameter, and so by drag; u_s if all are of one size.
    pub drag_velocity: Vec<f64>,
}

/// Sums over particles, exact in any order: every addend lies on a lattice.
#[derive(Clone, Debug)]
pub struct CoarseGraining {
    /// Smallest and largest diameter.
    diameters: [f64; 2],
    lattices: [Quantum; 4],
    sums: Vec<f64>,
}

impl CoarseGraining {
    /// Room for solids fractions up to 4 (they end the run at 1) and for speeds up to the limit.
    pub fn new(grid: &ColumnGrid, speed_limit: f64, diameters: [f64; 2]) -> Self {
        let volume = grid.cell_volume();
        // No more spheres fit into a cell than its volume over twice that of the smallest, d^3 / 4.
        let length = 4.0 * volume / diameters[0].powi(2);
        let ranges = [volume, volume * speed_limit, length, length * speed_limit];
        let mut work =
            Self { diameters, lattices: ranges.map(Quantum::spanning), sums: Vec::new() };
        work.sums.resize(work.fields() * grid.nodes(), 0.0);
        work
    }

    /// Whether particles differ in size.
    pub fn sizes_differ(&self) -> bool {
        self.diameters[0] != self.diameters[1]
    }

    /// Sums that are formed: those by diameter follow from those by volume if all are of one size.
    fn fields(&self) -> usize {
        if self.sizes_differ() { 4 } else { 2 }
    }

    /// phi = sum_i h V / (S dz) and phi u_s = sum_i h V v_z / (S dz), h = 1 - |z_i - z_0| / dz; likewise with d in
    /// the place of V for the sum of diameters and the velocity by drag.
    ///
    /// Velocities are those that the particles have now. Collective; before: owned particles are current.
    pub fn deposit(
        &mut self,
        particles: &Particles,
        grid: &ColumnGrid,
        bed: &mut Bed,
        ranks: &dyn Communicator,
    ) {
        self.sums.fill(0.0);
        if self.sizes_differ() {
            self.add_all::<4>(particles, grid);
        } else {
            self.add_all::<2>(particles, grid);
        }
        ranks.sum_exact(&mut self.sums);
        let nodes = grid.nodes();
        bed.solids_fraction.resize(nodes, 0.0);
        bed.solids_velocity.resize(nodes, 0.0);
        bed.diameter_density.resize(nodes, 0.0);
        bed.drag_velocity.resize(nodes, 0.0);
        let velocity = |flux: f64, amount: f64| if amount > 0.0 { flux / amount } else { 0.0 };
        for node in 0..nodes {
            let sum = |field: usize| self.sums[field * nodes + node];
            bed.solids_fraction[node] = sum(0) / grid.volume_of(node);
            bed.solids_velocity[node] = velocity(sum(1), sum(0));
            if self.sizes_differ() {
                bed.diameter_density[node] = sum(2) / grid.volume_of(node);
                bed.drag_velocity[node] = velocity(sum(3), sum(2));
            } else {
                let per_volume = 6.0 / (PI * self.diameters[0].powi(2)); // d / V
                bed.diameter_density[node] = bed.solids_fraction[node] * per_volume;
                bed.drag_velocity[node] = bed.solids_velocity[node];
            }
        }
    }

    /// Adds the first N of volume, volume flux, diameter and diameter flux of all owned particles.
    #[inline(always)]
    fn add_all<const N: usize>(&mut self, particles: &Particles, grid: &ColumnGrid) {
        let nodes = grid.nodes();
        for i in 0..particles.owned_count() {
            let weights = grid.weights(particles.body[i].position.z);
            let (volume, velocity) = (particles.volume(i), particles.body[i].velocity.z);
            let diameter = 2.0 * particles.body[i].radius;
            let amounts = [volume, volume * velocity, diameter, diameter * velocity];
            for (field, &amount) in amounts[..N].iter().enumerate() {
                let (lattice, upper) = (self.lattices[field], amount * weights.of_upper);
                let sums = &mut self.sums[field * nodes..(field + 1) * nodes];
                sums[weights.lower] += lattice.round(amount - upper);
                sums[weights.upper] += lattice.round(upper);
            }
        }
    }
}
