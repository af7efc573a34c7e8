//! Processes that say they are on machines of their own: velocities of ghosts travel while they evaluate half of their own pairs.

use crate::dense_beds::{bed_of_two_species, polydisperse_bed, vibrated_bed};
use crate::far_apart::FarApart;
use std::cell::Cell;
use talcum::domain::RankGrid;
use talcum::parallel::{Communicator, MpiRanks};

/// Some vibrations, in which lists are made anew again and again.
const STEPS: u64 = 1000;

/// Each bed has the bits of one rank, cut into slabs along z, and along other axes.
pub(crate) fn beds_have_the_bits_of_one_rank(ranks: &MpiRanks) {
    let n = ranks.size();
    let along_others = if n == 4 { [2, 1, 2] } else { [1, n, 1] };
    for bench in [vibrated_bed(), polydisperse_bed(), bed_of_two_species()] {
        let expected = ranks.is_root().then(|| bench.alone().steps(STEPS).snapshot().bits());
        for grid in [[1, 1, n], along_others] {
            let far_apart = FarApart { ranks, asked: Cell::default() };
            let found = bench.start(RankGrid(grid), &far_apart).steps(STEPS).snapshot();
            if let Some(expected) = &expected {
                assert!(found.bits() == *expected, "{grid:?}");
                // Rank 0 waits for velocities of the ranks ahead of it.
                let asked = far_apart.asked.get();
                assert!(n == 1 || asked > 100, "a control: rank 0 was asked {asked} times");
            }
        }
    }
}
