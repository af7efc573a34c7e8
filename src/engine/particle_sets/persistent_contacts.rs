//! Contacts that persist: contacts at a reference time that still exist at later samples.
//!
//! Source: Liu, van Wachem, Mudde, Chen & van Ommen, Powder Technology (2016), section 2.4.

use super::ownership::Ownership;
use super::pair::Pair;
use crate::parallel::Communicator;

/// Criterion for a contact that has been kept from t_0 to t.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Persistence {
    /// The pair touches at t_0 and at t; it may have separated and met again in between (the paper's definition).
    AtBothTimes,
    /// The pair touches at t_0 and has touched at every sample since. It may separate between two samples without being
    /// noticed, so the interval of the samples is part of the definition.
    AtEveryLook,
}

/// The contacts at a reference time t_0, and the kept ones among them.
///
/// A pair is held by the rank that owned its lower id at the last sample.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PersistentContacts {
    persistence: Persistence,
    /// The pairs at t_0, or those kept at every sample so far; ascending from the first sample on.
    candidates: Vec<Pair>,
}

impl PersistentContacts {
    /// Takes the touching pairs of all ranks at t_0, each on one rank, or continues from pairs that were
    /// [stored](Self::stored) by any ranks.
    pub fn begin(persistence: Persistence, touching: &[Pair]) -> Self {
        Self { persistence, candidates: touching.to_vec() }
    }

    /// Takes a sample of the pairs that touch now, ascending, each once and on the rank that owns its lower id. Returns
    /// those that have been kept since t_0, in the same form. Collective.
    pub fn look(
        &mut self,
        touching: &[Pair],
        owned: &Ownership,
        ranks: &dyn Communicator,
    ) -> Vec<Pair> {
        owned.align(&mut self.candidates, Pair::ends, ranks);
        let kept = common(&self.candidates, touching);
        if self.persistence == Persistence::AtEveryLook {
            self.candidates.clone_from(&kept);
        }
        kept
    }

    /// Pairs of this rank that must be stored to resume later.
    pub fn stored(&self) -> &[Pair] {
        &self.candidates
    }

    /// Number of the pairs with which a sample is compared, on all ranks. Collective.
    pub fn count(&self, ranks: &dyn Communicator) -> usize {
        ranks.total(self.candidates.len())
    }
}

/// The pairs contained in both ascending lists.
fn common(a: &[Pair], b: &[Pair]) -> Vec<Pair> {
    let mut rest = b.iter().peekable();
    let mut found = Vec::with_capacity(a.len().min(b.len()));
    for pair in a {
        while rest.next_if(|other| *other < pair).is_some() {}
        found.extend(rest.next_if_eq(&pair));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::{random_of, uniform};
    use crate::parallel::run_on_threads;
    use std::collections::BTreeSet;

    /// The particles, of 0 to 59, that a rank owns at a sample.
    fn owned(look: usize, rank: usize, n: usize) -> Ownership {
        let mine = |id: &u64| (*id as usize * (3 + look) % 11 % n) == rank;
        Ownership::of((0..60).filter(mine).collect())
    }

    fn part(all: &[Pair], owned: &Ownership) -> Vec<Pair> {
        let here = all.iter().filter(|pair| owned.place_of(pair.lower).is_some());
        let here: BTreeSet<Pair> = here.copied().collect();
        here.into_iter().collect()
    }

    /// The pairs kept at each of several samples (the first is t_0), with another distribution at each.
    fn kept(n: usize, persistence: Persistence, looks: &[Vec<Pair>]) -> Vec<Vec<Pair>> {
        let made = run_on_threads(n, |ranks| {
            let owned = |k: usize| owned(k, ranks.rank(), n);
            let first = part(&looks[0], &owned(0));
            let mut contacts = PersistentContacts::begin(persistence, &first);
            let mut kept = Vec::new();
            for (k, touching) in looks.iter().enumerate().skip(1) {
                let owned = owned(k);
                kept.push(contacts.look(&part(touching, &owned), &owned, ranks));
                // The pairs are written and read again, by other ranks.
                let stored = contacts.stored().to_vec();
                let moved = ranks.sparse_exchange(&[crate::parallel::Message::of(
                    (ranks.rank() + 1) % n,
                    &stored,
                )]);
                let moved: Vec<Pair> = moved
                    .iter()
                    .flat_map(|message| crate::parallel::records_of_bytes(&message.bytes))
                    .collect();
                contacts = PersistentContacts::begin(persistence, &moved);
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
