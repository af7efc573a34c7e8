//! Prefetching in the loop over blocks of pairs.

use crate::numbers::{fetch_ahead, fetch_part_ahead};
use crate::particles::{Body, ForceTorque, LANES, PairBlock};

/// Number of parts in which the numbers of a block are fetched.
const PARTS: usize = LANES / 4;

/// The two blocks after the present one. Their data are fetched in parts while the present block is evaluated: all at
/// once would be more requests than a core can have pending. First particles are not fetched, since they follow each
/// other in memory.
#[derive(Clone, Copy, Default)]
pub(crate) struct ComingBlocks<'a> {
    next: Option<&'a PairBlock>,
    after_next: Option<&'a PairBlock>,
}

impl<'a> ComingBlocks<'a> {
    /// The first two of these blocks.
    pub(crate) fn first_of(blocks: &'a [PairBlock]) -> Self {
        Self { next: blocks.first(), after_next: blocks.get(1) }
    }

    /// Fetches the second bodies of four pairs of the next block, from lane `from` on.
    #[inline(always)]
    pub(crate) fn fetch_bodies(self, bodies: &[Body], from: usize) {
        if let Some(next) = self.next {
            for &second in &next.second[from..from + 4] {
                fetch_ahead(bodies, second as usize);
            }
        }
    }

    /// Fetches the forces on the second bodies of four pairs of the next block.
    #[inline(always)]
    pub(crate) fn fetch_forces(self, forces: &[ForceTorque], from: usize) {
        if let Some(next) = self.next {
            for &target in &next.target[from..from + 4] {
                fetch_ahead(forces, target as usize);
            }
        }
    }

    /// Fetches the data of four lanes of the block after the next.
    #[inline(always)]
    pub(crate) fn fetch_pairs(self, four: usize) {
        if let Some(block) = self.after_next {
            fetch_part_ahead::<PARTS, _>(block, four);
        }
    }
}
