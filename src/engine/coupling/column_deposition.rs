//! Particles to grid: solids fraction and velocity by hat weights, Moon 2006 eqs (8)-(10).

use super::DragShare;
use super::column_block::ColumnBlock;
use crate::grid::ColumnGrid;
use crate::numbers::{F64x4, Quantum, four, vectorised};
use crate::parallel::Communicator;
use crate::particles::{Body, LANES, Lanes, Particles, sphere_volume};
use std::f64::consts::PI;

/// The bed as seen by the gas: fields at the nodes of the column grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bed {
    /// phi, volume of solids per volume.
    pub solids_fraction: Vec<f64>,
    /// u_s, mean vertical velocity of the solids by volume; 0 where there are none.
    pub solids_velocity: Vec<f64>,
    /// Sum of the particles' shares of drag per volume: of their diameters, or of the squares of these.
    pub share_density: Vec<f64>,
    /// u_d, mean vertical velocity of the solids by these shares, and so by drag; u_s if all are of one size.
    pub drag_velocity: Vec<f64>,
}

/// Sums over particles, exact in any order: every addend is a multiple of a quantum.
#[derive(Clone, Debug)]
pub struct ColumnDeposition {
    /// Smallest and largest diameter.
    diameters: [f64; 2],
    share: DragShare,
    /// Quanta of volume and its flux, and of shares of drag and their flux.
    quanta: [[Quantum; 2]; 2],
    /// The particles as they were deposited last.
    blocks: Vec<ColumnBlock>,
    /// Sums of volume, then of shares of drag; the latter follow from the former if all particles are of one size.
    in_intervals: [Vec<IntervalSums>; 2],
}

/// Contributions of particles to the nodes of a column grid, by fields and nodes: of one rank, or summed over all.
#[derive(Debug)]
pub struct NodeSums(Vec<f64>);

/// The sums of one rank, to be added over the ranks by [`Communicator::sum_exact`].
impl From<NodeSums> for Vec<f64> {
    fn from(sums: NodeSums) -> Self {
        sums.0
    }
}

/// Sums that have been added over the ranks.
impl From<Vec<f64>> for NodeSums {
    fn from(numbers: Vec<f64>) -> Self {
        Self(numbers)
    }
}

/// Contributions of the particles in one interval of the grid to its ends: amount and flux to the lower, amount and
/// flux to the upper. Every fourth particle has sums of its own, so that no addition waits for the previous one.
type IntervalSums = [[f64; 4]; 4];

impl ColumnDeposition {
    /// Quanta with room for solids fractions up to 4 (they end the run at 1) and for speeds up to the limit.
    pub fn new(grid: &ColumnGrid, speed_limit: f64, diameters: [f64; 2], share: DragShare) -> Self {
        let volume = grid.cell_volume();
        // The number of spheres in a cell is at most its volume over twice that of the smallest sphere, d^3 / 4.
        let smallest = diameters[0];
        let shares = match share {
            DragShare::Diameter => 4.0 * volume / smallest.powi(2),
            DragShare::Surface => 4.0 * volume / smallest,
        };
        let quanta = [volume, shares].map(|most| [most, most * speed_limit].map(Quantum::spanning));
        let (blocks, in_intervals) = Default::default();
        Self { diameters, share, quanta, blocks, in_intervals }
    }

    /// Whether particles differ in size.
    pub fn sizes_differ(&self) -> bool {
        self.diameters[0] != self.diameters[1]
    }

    /// The owned particles as they were deposited last.
    pub(crate) fn blocks(&self) -> &[ColumnBlock] {
        &self.blocks
    }

    /// phi = sum_i h V / (S dz) and phi u_s = sum_i h V v_z / (S dz), h = 1 - |z_i - z_0| / dz; likewise with d or d^2
    /// in place of V for the sum of the shares of drag and the velocity by drag.
    ///
    /// Velocities are the present ones of the particles. Collective; before: owned particles are current.
    pub fn deposit(
        &mut self,
        particles: &Particles,
        grid: &ColumnGrid,
        bed: &mut Bed,
        ranks: &dyn Communicator,
    ) {
        let mut sums = self.sum_own(particles, grid);
        ranks.sum_exact(&mut sums.0);
        self.fill(bed, grid, &sums);
    }

    /// The first half of [`ColumnDeposition::deposit`]: the sums over the particles of this rank.
    pub fn sum_own(&mut self, particles: &Particles, grid: &ColumnGrid) -> NodeSums {
        let kinds = if self.sizes_differ() { 2 } else { 1 };
        for sums in &mut self.in_intervals[..kinds] {
            sums.clear();
            sums.resize(grid.intervals(), [[0.0; 4]; 4]);
        }
        let bodies = &particles.body[..particles.owned_count()];
        self.blocks.resize_with(bodies.len().div_ceil(LANES), ColumnBlock::default);
        let Self { blocks, share, quanta, in_intervals, .. } = self;
        deposit(bodies, blocks, grid, *share, *quanta, &mut in_intervals[..kinds]);
        self.add_up_nodes(kinds, grid)
    }

    /// Sums at the nodes: each node has a share of the interval below and one of the interval above.
    fn add_up_nodes(&self, kinds: usize, grid: &ColumnGrid) -> NodeSums {
        let nodes = grid.nodes();
        let mut at_nodes = vec![0.0; 2 * kinds * nodes];
        for (sums, fields) in self.in_intervals[..kinds].iter().zip(at_nodes.chunks_mut(2 * nodes))
        {
            let (amounts, fluxes) = fields.split_at_mut(nodes);
            for (interval, [a, b, c, d]) in sums.iter().enumerate() {
                let [lower, upper] = grid.ends(interval);
                let sum = |number: usize| (a[number] + b[number]) + (c[number] + d[number]);
                amounts[lower] += sum(0);
                fluxes[lower] += sum(1);
                amounts[upper] += sum(2);
                fluxes[upper] += sum(3);
            }
        }
        NodeSums(at_nodes)
    }

    /// The second half: the fields of the bed from these sums, added over all ranks.
    pub fn fill(&self, bed: &mut Bed, grid: &ColumnGrid, sums: &NodeSums) {
        let nodes = grid.nodes();
        bed.solids_fraction.resize(nodes, 0.0);
        bed.solids_velocity.resize(nodes, 0.0);
        bed.share_density.resize(nodes, 0.0);
        bed.drag_velocity.resize(nodes, 0.0);
        let velocity = |flux: f64, amount: f64| if amount > 0.0 { flux / amount } else { 0.0 };
        for node in 0..nodes {
            let sum = |field: usize| sums.0[field * nodes + node];
            bed.solids_fraction[node] = sum(0) / grid.volume_of(node);
            bed.solids_velocity[node] = velocity(sum(1), sum(0));
            if self.sizes_differ() {
                bed.share_density[node] = sum(2) / grid.volume_of(node);
                bed.drag_velocity[node] = velocity(sum(3), sum(2));
            } else {
                let per_volume = match self.share {
                    DragShare::Diameter => 6.0 / (PI * self.diameters[0].powi(2)), // d / V
                    DragShare::Surface => 6.0 / (PI * self.diameters[0]),          // d^2 / V
                };
                bed.share_density[node] = bed.solids_fraction[node] * per_volume;
                bed.drag_velocity[node] = bed.solids_velocity[node];
            }
        }
    }
}

vectorised!(
    /// Gathers the particles of a rank into blocks, and adds to the sums of the intervals: those of volume, and
    /// optionally those of shares of drag.
    fn deposit<Q: F64x4>(
        bodies: &[Body],
        blocks: &mut [ColumnBlock],
        grid: &ColumnGrid,
        share: DragShare,
        quanta: [[Quantum; 2]; 2],
        sums: &mut [Vec<IntervalSums>],
    ) {
        for (bodies, block) in bodies.chunks(LANES).zip(blocks) {
            block.gather::<Q>(bodies, grid);
            // Lanes that only fill up the last block contribute nothing.
            let mut amounts = [[0.0; LANES]; 2];
            for (lane, &radius) in block.radius[..bodies.len()].iter().enumerate() {
                amounts[0][lane] = sphere_volume(radius);
                amounts[1][lane] = share.of(2.0 * radius);
            }
            for (kind, sums) in sums.iter_mut().enumerate() {
                add::<Q>(block, &amounts[kind], quanta[kind], sums);
            }
        }
    }
);

/// Adds amounts and their fluxes, each rounded to its quantum.
#[inline(always)]
fn add<Q: F64x4>(
    block: &ColumnBlock,
    amounts: &Lanes,
    [of_amount, of_flux]: [Quantum; 2],
    sums: &mut [IntervalSums],
) {
    for from in (0..LANES).step_by(4) {
        let weight = Q::load(four(&block.of_upper, from));
        let amount = Q::load(four(amounts, from));
        let flux = amount.times(Q::load(four(&block.velocity[2], from)));
        let (upper, flux_upper) = (amount.times(weight), flux.times(weight));
        let shares = Q::transposed([
            of_amount.round_four(amount.minus(upper)),
            of_flux.round_four(flux.minus(flux_upper)),
            of_amount.round_four(upper),
            of_flux.round_four(flux_upper),
        ]);
        for row in 0..4 {
            let sum = &mut sums[block.interval[from + row] as usize][row];
            Q::load(sum).plus(shares[row]).store(sum);
        }
    }
}
