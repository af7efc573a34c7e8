//! The pairs of the inner list formed by two species; one law holds for all of them.

use super::contact_state::ContactState;
use super::pair_blocks::{Pair, PairBlocks};
use crate::numbers::{F64x4, vectorised};

use super::proximity::{FourPairs, SetBits, branch_vector, four_of, push_set_bits};
use super::{Body, Particles};

/// The pairs of one kind.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairsOfKind {
    /// Pairs that are within the range of contacts, or were so when the list was made, in the order of the neighbour
    /// list; those promoted since follow at the end.
    pub(crate) active: PairBlocks,
    /// The other pairs. They may attract each other.
    candidates: Vec<Pair>,
    /// Numbers of the candidates that have come within the range of contacts.
    to_promote: Vec<u32>,
}

/// The candidates, for a loop that finds those to promote.
pub(crate) struct Candidates<'a> {
    pub(crate) pairs: &'a [Pair],
    /// To be filled, in rising order: the numbers of the pairs to promote.
    pub(crate) to_promote: &'a mut Vec<u32>,
}

impl PairsOfKind {
    pub(super) fn clear(&mut self) {
        self.active.clear();
        self.candidates.clear();
    }

    /// Adds a touching pair with the state of its contact.
    pub(super) fn restore(&mut self, pair: Pair, state: ContactState) {
        self.active.push(pair, Some(state));
    }

    /// Drops all candidates, and those active pairs that do not touch and for which `keep` does not hold.
    pub(super) fn retain(&mut self, keep: impl Fn([u32; 2]) -> bool) {
        self.active.retain(keep);
        self.candidates.clear();
    }

    /// Adds a pair that does not touch.
    #[inline(always)]
    pub(super) fn add(&mut self, pair: Pair, is_active: bool) {
        if is_active { self.active.push(pair, None) } else { self.candidates.push(pair) }
    }

    /// Adds candidates of two owned particles: the first and those of up to four others whose bits are set.
    #[inline(always)]
    pub(super) fn add_candidates(&mut self, first: u32, others: &[u32], bits: u32) {
        push_set_bits(&mut self.candidates, bits, |bit| {
            let other = others[bit as usize];
            [first, other, other]
        });
    }

    /// The candidates, which include all pairs that attract each other without contact.
    pub(crate) fn candidates(&mut self) -> Candidates<'_> {
        self.to_promote.clear();
        Candidates { pairs: &self.candidates, to_promote: &mut self.to_promote }
    }

    /// The separated pairs, read-only.
    pub(super) fn separated(&self) -> &[Pair] {
        &self.candidates
    }

    /// Finds the candidates that have come within the range of contacts, unless none can have done so.
    pub(super) fn find_promotions(
        &mut self,
        particles: &Particles,
        contact_range: f64,
        is_new: bool,
    ) {
        let candidates = self.candidates();
        if !is_new {
            find_promotions(&particles.body, contact_range, candidates);
        }
    }

    /// Makes active the candidates that have been found.
    pub(super) fn promote(&mut self) {
        let Self { active, candidates, to_promote } = self;
        for &number in &*to_promote {
            active.push(candidates[number as usize], None);
        }
        // The order is from the back, so that the pairs still to be removed keep their numbers.
        for &number in to_promote.iter().rev() {
            candidates.swap_remove(number as usize);
        }
    }
}

vectorised!(
    /// Finds the candidates that have come within the range of contacts.
    fn find_promotions<Q: F64x4>(bodies: &[Body], contact_range: f64, candidates: Candidates) {
        let Candidates { pairs, to_promote } = candidates;
        let contact_range = Q::splat(contact_range);
        for (four, pairs) in pairs.chunks(4).enumerate() {
            let mut branch_vectors = [Q::splat(0.0); 4];
            for (of_pair, &[one, other, _]) in branch_vectors.iter_mut().zip(four_of(pairs)) {
                *of_pair = branch_vector(&bodies[one as usize], &bodies[other as usize]);
            }
            let close = FourPairs::of(branch_vectors, pairs.len()).closer_than(contact_range);
            to_promote.extend(SetBits(close).map(|bit| (4 * four + bit) as u32));
        }
    }
);
