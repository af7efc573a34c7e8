//! Prefetching in the loop over blocks of pairs.

use crate::numbers::{fetch_ahead, fetch_part_ahead};
use crate::particles::{Body, ForceTorque, LANES, PairBlock};

/// Parts in which the numbers of a block are fetched.
const PARTS: usize = LANES / 4;

/// The two blocks after the present one. What they need is fetched bit by bit while the present one is evaluated: all at once would be
/// more than a core can wait for at a time. First particles are not fetched, since they follow each other in memory.
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

    /// Fetches the second body of a pair of the next block.
    #[inline(always)]
    pub(crate) fn fetch_body(self, bodies: &[Body], lane: usize) {
        if let Some(next) = self.next {
            fetch_ahead(bodies, next.second[lane] as usize);
        }
    }

    /// Fetches the force on the second body of a pair of the next block.
    #[inline(always)]
    pub(crate) fn fetch_force(self, forces: &[ForceTorque], lane: usize) {
        if let Some(next) = self.next {
            fetch_ahead(forces, next.target[lane] as usize);
        }
    }

    /// Fetches what the block after the next one holds of four lanes.
    #[inline(always)]
    pub(crate) fn fetch_pairs(self, four: usize) {
        if let Some(block) = self.after_next {
            fetch_part_ahead(block, four, PARTS);
        }
    }
}
