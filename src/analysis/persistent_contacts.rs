//! Contacts that persist: those of a reference time that are still there at later looks.
//!
//! Source: Liu, van Wachem, Mudde, Chen & van Ommen, Powder Technology (2016), section 2.4.

use super::pair::{Pair, at_rendezvous};
use crate::parallel::Communicator;

/// What counts as a contact that has been kept from t_0 to t.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Persistence {
    /// The pair touches at t_0 and at t; it may have parted and met again in between (the paper's definition).
    AtBothTimes,
    /// The pair touches at t_0 and has touched at every look since. It may part between two looks without being
    /// noticed: the interval of the looks belongs to the definition.
    AtEveryLook,
}

/// The contacts of a reference time t_0, and which of them were kept.
///
/// A pair is held by one rank, the rendezvous rank of its lower id, wherever its particles are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PersistentContacts {
    persistence: Persistence,
    /// Ascending: of t_0, or those kept at every look so far.
    candidates: Vec<Pair>,
}

impl PersistentContacts {
    /// Takes all ranks' touching pairs at t_0; each may be named by one rank or by several. Collective.
    pub fn begin(persistence: Persistence, touching: &[Pair], ranks: &dyn Communicator) -> Self {
        Self { persistence, candidates: at_rendezvous(touching, ranks) }
    }

    /// Looks at the pairs that touch now: returns those that have been kept since t_0, each on one rank, ascending
    /// there. Collective.
    pub fn look(&mut self, touching: &[Pair], ranks: &dyn Communicator) -> Vec<Pair> {
        let kept = common(&self.candidates, &at_rendezvous(touching, ranks));
        if self.persistence == Persistence::AtEveryLook {
            self.candidates.clone_from(&kept);
        }
        kept
    }

    /// What must be stored to go on later: this rank's pairs.
    pub fn stored(&self) -> &[Pair] {
        &self.candidates
    }

    /// Goes on from pairs that were stored, by whatever ranks. Collective.
    pub fn restore(persistence: Persistence, stored: &[Pair], ranks: &dyn Communicator) -> Self {
        Self::begin(persistence, stored, ranks)
    }

    /// Number of the pairs that a look compares with, on all ranks. Collective.
    pub fn count(&self, ranks: &dyn Communicator) -> usize {
        ranks.total(self.candidates.len())
    }
}

/// The pairs that both ascending lists hold.
fn common(a: &[Pair], b: &[Pair]) -> Vec<Pair> {
    let mut rest = b;
    let held = |pair: &&Pair| {
        let below = rest.partition_point(|other| other < *pair);
        rest = &rest[below..];
        rest.first() == Some(*pair)
    };
    a.iter().filter(held).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::{random_of, uniform};
    use crate::parallel::run_on_threads;
    use std::collections::BTreeSet;

    fn part(all: &[Pair], rank: usize, n: usize, salt: usize) -> Vec<Pair> {
        // Every third pair is named by two ranks, and in the wrong order.
        let mut here = Vec::new();
        for (place, &Pair { lower, higher }) in all.iter().enumerate() {
            let owner = place * salt % 11 % n;
            if owner == rank {
                here.push(Pair { lower, higher });
            }
            if place % 3 == 0 && (owner + 1) % n == rank {
                here.push(Pair { lower: higher, higher: lower });
            }
        }
        here
    }

    /// The pairs kept at each of several looks (the first is t_0), with another distribution at each.
    fn kept(n: usize, persistence: Persistence, looks: &[Vec<Pair>]) -> Vec<Vec<Pair>> {
        let made = run_on_threads(n, |ranks| {
            let part = |k: usize| part(&looks[k], ranks.rank(), n, 3 + k);
            let mut contacts = PersistentContacts::begin(persistence, &part(0), ranks);
            let mut kept = Vec::new();
            for k in 1..looks.len() {
                kept.push(contacts.look(&part(k), ranks));
                // Written and read again, by other ranks.
                let stored = contacts.stored().to_vec();
                let moved = ranks.sparse_exchange(&[crate::parallel::Message::of(
                    (ranks.rank() + 1) % n,
                    &stored,
                )]);
                let moved: Vec<Pair> = moved
                    .iter()
                    .flat_map(|message| crate::parallel::records_of_bytes(&message.bytes))
                    .collect();
                contacts = PersistentContacts::restore(persistence, &moved, ranks);
            }
            kept
        });
        let merged = |k: usize| {
            let mut all: Vec<Pair> = made.iter().flat_map(|kept| kept[k].clone()).collect();
            all.sort_unstable();
            all
        };
        (0..looks.len() - 1).map(merged).collect()
    }

    #[test]
    fn the_two_definitions_differ_where_a_pair_parts_and_meets_again() {
        let [a, b, c, d] = [Pair::of(1, 2), Pair::of(9, 2), Pair::of(3, 4), Pair::of(7, 8)];
        let looks = [vec![a, b, c], vec![a, c], vec![a, b, d]];
        for n in 1..=4 {
            let at_both = kept(n, Persistence::AtBothTimes, &looks);
            assert_eq!(at_both, [vec![a, c], vec![a, b]]);
            let at_every = kept(n, Persistence::AtEveryLook, &looks);
            assert_eq!(at_every, [vec![a, c], vec![a]]);
        }
    }

    #[test]
    fn random_contacts_are_those_of_sets() {
        let mut generator = random_of(5, 0, "contacts");
        let mut draw = || (uniform(&mut generator) * 40.0) as u64;
        let looks: Vec<Vec<Pair>> = (0..4)
            .map(|_| {
                let drawn = (0..600).map(|_| Pair::of(draw(), draw()));
                drawn.filter(|pair| pair.lower != pair.higher).collect()
            })
            .collect();
        let sets: Vec<BTreeSet<Pair>> =
            looks.iter().map(|look| look.iter().copied().collect()).collect();
        let since_the_start = |k: usize| -> Vec<Pair> {
            let all = sets[0].iter().filter(|pair| sets[..=k].iter().all(|set| set.contains(pair)));
            all.copied().collect()
        };
        let at_both = |k: usize| -> Vec<Pair> { sets[0].intersection(&sets[k]).copied().collect() };
        for n in 1..=4 {
            for k in 1..4 {
                assert_eq!(kept(n, Persistence::AtBothTimes, &looks)[k - 1], at_both(k));
                assert_eq!(kept(n, Persistence::AtEveryLook, &looks)[k - 1], since_the_start(k));
            }
        }
        assert_ne!(at_both(3), since_the_start(3)); // the control
    }
}
