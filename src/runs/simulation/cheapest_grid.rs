//! The rank grid of a run whose case names none.
//!
//! Among all rank grids that fit, the one with the smallest cost is chosen:
//!
//! ```math
//! C = \frac{n s}{N} (1 + g) + c\, m f, \qquad
//! g = \frac{1}{2} \sum_{a:\, N_a > 1} \frac{n_a h N_a}{L_a}
//! ```
//!
//! The cost is the ratio of the time of a step of the gas to that of one particle in one of its steps. There are n
//! particles that make s steps in a step of the gas, and N = N_x N_y N_z ranks. g is the number of ghosts per particle
//! (n_a faces of a subdomain, 1 between walls if N_a = 2, else 2; h is the width of ghosts, L_a the length along which
//! particles lie). Each ghost is taken to cost as much as a particle (velocities are received, forces sent). There are
//! m cells, of which the rank with most cells has the fraction f, and c particles take as long as one cell. A wide bed
//! is thus cut across its width, where cuts are short. So is a bed below a gas on cells: since cut planes follow the
//! particles, the highest of several slabs along z would own nearly all cells, and the others would wait for it at each
//! step of the gas.

use super::layout::{divide, layout_of};
use crate::case::{Case, RankLayout};
use crate::setup::Layout;
use talcum_engine::domain::{Bounds, Decomposition, RankGrid};
use talcum_engine::parallel::{Communicator, ParticleRecord};
use talcum_engine::state::SizeRange;

/// c: 13 in a box of 64^3 cells, 32 in the small bed of cases/liu2016 with 16 x 3 x 80 cells (AMD EPYC).
const PARTICLES_PER_CELL: f64 = 20.0;

/// The cheapest rank grid for particles that lie on the ranks in any order; slabs along z if others are no cheaper;
/// `None` if the case gives the division of the box, or if no grid fits. It never changes results. Collective.
pub(super) fn cheapest_grid(
    case: &Case,
    sizes: &SizeRange,
    particles: &[ParticleRecord],
    ranks: &dyn Communicator,
) -> Option<RankGrid> {
    if case.parallel.layout != RankLayout::Cheapest || ranks.size() == 1 {
        return None;
    }
    let gas = case.gas_on_cells();
    let cells = gas.volume_averaged().map_or(0, |model| model.grid.counts().iter().product());
    let layout = layout_of(case, sizes);
    let work = Work {
        of_particles: ranks.total(particles.len()) as f64 * gas.substeps() as f64,
        of_cells: PARTICLES_PER_CELL * cells as f64,
        extents: extents(particles, ranks),
    };
    let cost = |grid: RankGrid| {
        let divided = divide(case, &layout, grid, particles, ranks).ok()?;
        Some((work.cost(&divided, &layout), grid))
    };
    let costs = grids_of(ranks.size()).into_iter().filter_map(cost);
    costs.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, grid)| grid)
}

/// All rank grids with this number of ranks.
fn grids_of(ranks: usize) -> Vec<RankGrid> {
    let divisors = |n: usize| (1..=n).filter(move |divisor| n.is_multiple_of(*divisor));
    divisors(ranks)
        .flat_map(|x| divisors(ranks / x).map(move |y| RankGrid([x, y, ranks / x / y])))
        .collect()
}

/// Lengths along which particles lie. Collective.
fn extents(particles: &[ParticleRecord], ranks: &dyn Communicator) -> [f64; 3] {
    let mut ends = [f64::NEG_INFINITY; 6];
    for particle in particles {
        for axis in 0..3 {
            ends[axis] = ends[axis].max(particle.position[axis]);
            ends[axis + 3] = ends[axis + 3].max(-particle.position[axis]);
        }
    }
    ranks.maximum(&mut ends);
    [0, 1, 2].map(|axis| ends[axis] + ends[axis + 3])
}

/// Work of all ranks together in a step of the gas.
#[derive(Clone, Copy, Debug)]
struct Work {
    /// n s.
    of_particles: f64,
    /// c m.
    of_cells: f64,
    /// L_a.
    extents: [f64; 3],
}

impl Work {
    /// C.
    fn cost(&self, divided: &Decomposition, layout: &Layout<'_>) -> f64 {
        let Layout { bounds, ghost_width, .. } = *layout;
        let grid = divided.grid();
        let across = |axis: usize| faces(axis, grid, bounds) * ghost_width * grid.0[axis] as f64;
        let ghosts: f64 =
            (0..3).map(|axis| 0.5 * across(axis) / self.extents[axis].max(ghost_width)).sum();
        let most_cells: f64 =
            (0..3).map(|axis| divided.widest(axis) / bounds.lengths()[axis]).product();
        self.of_particles * (1.0 + ghosts) / grid.size() as f64 + self.of_cells * most_cells
    }
}

/// n_a.
fn faces(axis: usize, grid: RankGrid, bounds: &Bounds) -> f64 {
    match grid.0[axis] {
        1 => 0.0,
        2 if !bounds.is_periodic(axis) => 1.0,
        _ => 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;
    use std::path::Path;
    use talcum_engine::parallel::run_on_threads;

    const SMALL: &str = "cases/liu2016/small/rho250vdw20ug4.toml";
    const DRY: &str = "cases/benchmark/bed-24000.toml";

    /// The chosen grid for these numbers of particles along x, y and z, side by side, in the box of a case with these
    /// changes.
    fn chosen(ranks: usize, file: &str, counts: [usize; 3], changes: &[&str]) -> Option<RankGrid> {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file);
        let case = Case::read(&path, &changes).unwrap();
        let sizes = case.size_range().unwrap();
        let [nx, ny, nz] = counts;
        let particle = |i: usize| ParticleRecord {
            position: [i % nx, i / nx % ny, i / nx / ny]
                .map(|index| sizes.largest_diameter * (0.5 + index as f64)),
            ..ParticleRecord::zeroed()
        };
        let found = run_on_threads(ranks, |ranks| {
            let own = (ranks.rank()..nx * ny * nz).step_by(ranks.size());
            cheapest_grid(&case, &sizes, &own.map(particle).collect::<Vec<_>>(), ranks)
        });
        assert!(found.windows(2).all(|pair| pair[0] == pair[1]), "ranks agree: {found:?}");
        found[0]
    }

    /// Numbers of particles: 2 x 0.4 mm wide and 2.4 of 10 mm high.
    const LIU: [usize; 3] = [50, 10, 60];

    #[test]
    fn a_bed_below_much_gas_is_cut_by_upright_planes() {
        assert_eq!(chosen(2, SMALL, LIU, &[]), Some(RankGrid([2, 1, 1])));
        assert_eq!(chosen(4, SMALL, LIU, &[]), Some(RankGrid([4, 1, 1])));
    }

    #[test]
    fn where_the_gas_costs_nothing_cuts_are_short() {
        // Negative control of the test above: one step of the gas in 100,000.
        let rare = ["gas.substeps=100000", "time.step=1e-10"];
        assert_eq!(chosen(2, SMALL, LIU, &rare), Some(RankGrid([1, 1, 2])));
    }

    #[test]
    fn a_bed_is_cut_where_it_is_longest() {
        assert_eq!(chosen(4, DRY, [20, 20, 60], &[]), Some(RankGrid([1, 1, 4])));
        assert_eq!(chosen(16, DRY, [20, 20, 5], &[]), Some(RankGrid([4, 4, 1])));
        // More slabs than fit along one axis.
        assert_eq!(chosen(81, DRY, [20, 20, 60], &[]), Some(RankGrid([3, 3, 9])));
    }

    #[test]
    fn a_case_that_names_its_cuts_is_obeyed() {
        assert_eq!(chosen(2, SMALL, LIU, &["parallel.axis=z"]), None);
        assert_eq!(chosen(2, SMALL, LIU, &["parallel.ranks=[1, 1, 2]"]), None);
        assert_eq!(chosen(1, SMALL, LIU, &[]), None);
    }
}
