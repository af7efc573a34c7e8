//! Sums of the gas force over the particles around each node, for a gas whose velocity depends on the height.

use super::block::{GasBlock, ParticlesInColumn};
use super::compressible::NodeForces;
use crate::grid::ColumnGrid;
use crate::numbers::{F64x4, Quantum, vectorised};
use crate::particles::LANES;

/// Number of sums over the particles in one interval, as counts of their quanta: the forces at U = 0 for its lower and
/// upper node, and the slopes for the lower one alone, for both and for the upper one, by hat weights.
pub(super) const SUMS: usize = 5;

vectorised!(
    /// Sums over the particles of a rank, `count` of them, interval by interval, with the drag at the column's U. The
    /// quanta are those of the force and of the slope.
    pub(super) fn sum_by_nodes<Q: F64x4>(
        column: ParticlesInColumn,
        quanta: [Quantum; 2],
        count: usize,
        intervals: usize,
    ) -> Vec<i64> {
        let [of_force, of_slope] = quanta;
        let mut block = GasBlock::default();
        let mut sums = vec![0_i64; SUMS * intervals];
        for (number, particles) in column.blocks.iter().enumerate() {
            block.fill::<Q>(&column, particles);
            for lane in 0..LANES.min(count - number * LANES) {
                let upper = particles.of_upper[lane];
                let lower = 1.0 - upper;
                let force = block.vertical_force(lane, particles.velocity[2][lane], 0.0);
                let slope = block.slope(lane);
                let at = SUMS * particles.interval[lane] as usize;
                let sums = &mut sums[at..at + SUMS];
                for (sum, share) in sums.iter_mut().zip([force * lower, force * upper]) {
                    *sum = sum.wrapping_add(of_force.count(of_force.round(share)));
                }
                let shares = [lower * lower, lower * upper, upper * upper];
                for (sum, share) in sums[2..].iter_mut().zip(shares) {
                    *sum = sum.wrapping_add(of_slope.count(of_slope.round(slope * share)));
                }
            }
        }
        sums
    }
);

/// Converts sums over all ranks, followed by the number of particles, to forces around nodes per cross-section.
pub(super) fn at_nodes(sums: &[i64], grid: &ColumnGrid, quanta: [Quantum; 2]) -> NodeForces {
    let cross_section = grid.cell_volume() / grid.spacing();
    let [force, slope] = quanta.map(|quantum| quantum.spacing() / cross_section);
    let particles = sums[SUMS * grid.intervals()] as f64;
    let mut forces = NodeForces {
        at_rest: vec![0.0; grid.nodes()],
        slope: vec![0.0; grid.nodes()],
        coupling: Vec::with_capacity(grid.intervals()),
        rounding: particles * force,
    };
    for (interval, sums) in sums.chunks_exact(SUMS).enumerate() {
        let [lower, upper] = grid.ends(interval);
        forces.at_rest[lower] += sums[0] as f64 * force;
        forces.at_rest[upper] += sums[1] as f64 * force;
        forces.slope[lower] += sums[2] as f64 * slope;
        forces.coupling.push(sums[3] as f64 * slope);
        forces.slope[upper] += sums[4] as f64 * slope;
    }
    forces
}
