//! Processes whose messages take time, as on separate machines.

use crate::beds::delayed::{Delayed, Network};
use crate::dense_beds::{bed_of_two_species, polydisperse_bed, vibrated_bed};
use talcum::domain::RankGrid;
use talcum::parallel::{Communicator, MpiRanks};

/// Some vibrations, in which lists are rebuilt again and again.
const STEPS: u64 = 1000;

/// Each bed has the bits of one rank, cut into slabs along z, and along other axes.
pub(crate) fn beds_have_the_bits_of_one_rank(ranks: &MpiRanks) {
    let n = ranks.size();
    let along_others = if n == 4 { [2, 1, 2] } else { [1, n, 1] };
    for bench in [vibrated_bed(), polydisperse_bed(), bed_of_two_species()] {
        let expected = ranks.is_root().then(|| bench.alone().steps(STEPS).snapshot().bits());
        for grid in [[1, 1, n], along_others] {
            let network = Network { latency: 20.0, bandwidth: 1250.0 };
            let found =
                bench.start(RankGrid(grid), &Delayed { ranks, network }).steps(STEPS).snapshot();
            if let Some(expected) = &expected {
                assert!(found.bits() == *expected, "{grid:?}");
            }
        }
    }
}
