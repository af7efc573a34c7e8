//! The same bits on any number of ranks, through balancing and restarts.

use super::gas_on_cells;
use crate::beds::{Bench, PLATE};
use talcum::balance::Balance;
use talcum::domain::{Face, RankGrid};
use talcum::gas::{DragLaw, DragShare};
use talcum::parallel::run_on_threads;

/// A dense bed between walls that a gas with inertia lifts.
fn bed(filter_width: f64, particles: u64) -> Bench {
    let walls = [Face::Wall; 2];
    let mut bench = Bench::new([8.0, 6.0, 18.0], [walls, walls, PLATE]);
    bench.gravity.magnitude = 1.0;
    (bench.balance, bench.skin) = (Some(Balance::new(40, 1.0)), None);
    bench.add_layers(particles, (1.12, 0.6), &[1.0, 0.8], (0.05, 0.1));
    let mut model = gas_on_cells(&bench, [4, 3, 9], (0.01, 1.0 / 55.0), DragLaw::WEN_YU, 0.4);
    model.coupling.filter_width = filter_width;
    bench.volume_averaged = Some(model);
    bench
}

const GRIDS: [[usize; 3]; 4] = [[1, 1, 2], [1, 1, 3], [2, 1, 1], [2, 1, 2]];

#[test]
fn gas_alone_has_one_answer() {
    let bench = bed(0.0, 0);
    let alone = bench.on_ranks([1; 3], |run| run.steps(20).snapshot().bits());
    for grid in GRIDS {
        assert!(bench.on_ranks(grid, |run| run.steps(20).snapshot().bits()) == alone, "{grid:?}");
    }
}

#[test]
fn a_bed_in_a_gas_has_one_answer_on_any_ranks() {
    let shares = [DragShare::Diameter, DragShare::Surface];
    for (width, share) in [0.0, 3.0].into_iter().flat_map(|width| shares.map(|s| (width, s))) {
        let mut bench = bed(width, 200);
        let coupling = &mut bench.volume_averaged.as_mut().unwrap().coupling;
        (coupling.drag.share, coupling.undisturbed) = (share, share == DragShare::Surface);
        coupling.local_voidage = (width > 0.0).then_some(2);
        let alone = bench.on_ranks([1; 3], |run| run.steps(200).snapshot().bits());
        for grid in GRIDS {
            let bits = bench.on_ranks(grid, |run| run.steps(200).snapshot().bits());
            assert!(bits == alone, "{grid:?}, filter {width}, {share:?}");
        }
    }
}

#[test]
fn a_restart_between_gas_steps_on_other_ranks_changes_nothing() {
    let bench = bed(0.0, 200);
    let whole = bench.on_ranks([1; 3], |run| run.steps(200).snapshot().bits());
    // Step 83 lies within a gas step.
    let middle = bench.on_ranks([1, 1, 2], |run| run.steps(83).snapshot());
    let resumed = run_on_threads(3, |ranks| {
        bench.resume(&middle, RankGrid([1, 1, 3]), ranks).steps(117).snapshot().bits()
    });
    assert!(resumed.iter().all(|bits| *bits == whole));
    // Negative control: without the held forces the future is another one.
    let mut forgotten = middle;
    forgotten.particles.iter_mut().for_each(|particle| particle.gas_force = [0.0; 3]);
    let other = run_on_threads(1, |ranks| {
        bench.resume(&forgotten, RankGrid([1; 3]), ranks).steps(117).snapshot().bits()
    });
    assert!(other[0] != whole);
}
