//! Ownership of particles by ranks, for records that must be on the rank of their particle.
//!
//! Data kept about a particle from one sample to the next stay on the rank that owned it; only the records of particles
//! that have moved to another rank are sent. A sample therefore needs messages only for the particles near borders of
//! ranks.

use super::rendezvous::{OwnersOf, owners_of};
use crate::numbers::sorted_by_key;
use crate::parallel::{Communicator, Message, records_of_bytes};
use bytemuck::Pod;

/// Marks the absence of a rank or a place.
const NONE: u32 = u32::MAX;

/// The particles that this rank owns, by ascending id.
#[derive(Clone, Debug)]
pub struct Ownership {
    ids: Vec<u64>,
    /// Ids are looked up in equal intervals of about one id each; their width is a power of two.
    shift: u32,
    /// Place of the first id of each interval, and the number of ids.
    first: Vec<u32>,
}

impl Ownership {
    /// The ownership of ascending ids, each of which occurs once.
    pub fn of(ids: Vec<u64>) -> Self {
        debug_assert!(ids.is_sorted_by(|a, b| a < b));
        let range = ids.last().map_or(0, |last| last - ids[0]);
        let mut shift = 0;
        while range >> shift > 2 * ids.len() as u64 {
            shift += 1;
        }
        let intervals = (range >> shift) as usize + 1;
        let mut first = vec![ids.len() as u32; intervals + 1];
        for (place, id) in ids.iter().enumerate().rev() {
            first[((id - ids[0]) >> shift) as usize] = place as u32;
        }
        for interval in (0..intervals).rev() {
            first[interval] = first[interval].min(first[interval + 1]);
        }
        Self { ids, shift, first }
    }

    /// The ids, ascending.
    pub fn ids(&self) -> &[u64] {
        &self.ids
    }

    /// The place of an id among those of this rank.
    #[inline]
    pub fn place_of(&self, id: u64) -> Option<usize> {
        let interval = (id.checked_sub(*self.ids.first()?)? >> self.shift) as usize;
        let (&from, &to) = (self.first.get(interval)?, self.first.get(interval + 1)?);
        let (from, to) = (from as usize, to as usize);
        let within = &self.ids[from..to];
        match within {
            [only] => (*only == id).then_some(from),
            _ => within.binary_search(&id).ok().map(|place| from + place),
        }
    }

    /// Sends records, which may be on any rank, to the owners of their particles. Afterwards `records` holds those of
    /// this rank's particles, by ascending `key`, whose first part is the particle's id. Records of particles without
    /// an owner are dropped. Collective.
    pub fn align<T: Pod>(
        &self,
        records: &mut Vec<T>,
        key: impl Fn(&T) -> [u64; 2],
        ranks: &dyn Communicator,
    ) {
        let mut leaving = Vec::new();
        records.retain(|record| {
            let is_here = self.place_of(key(record)[0]).is_some();
            if !is_here {
                leaving.push(*record);
            }
            is_here
        });
        if ranks.size() > 1 && ranks.any(!leaving.is_empty()) {
            let owners = owners_of(leaving.iter().map(|record| key(record)[0]), &self.ids, ranks);
            let mut outgoing = vec![Vec::new(); ranks.size()];
            for record in leaving {
                if let Some(owner) = owners.owner(key(&record)[0]) {
                    outgoing[owner].push(record);
                }
            }
            let messages = outgoing.iter().enumerate();
            let messages: Vec<Message> =
                messages.map(|(rank, records)| Message::of(rank, records)).collect();
            for message in ranks.sparse_exchange(&messages) {
                records.extend(records_of_bytes::<T>(&message.bytes));
            }
        }
        if !records.is_sorted_by_key(&key) {
            records.sort_by_key(key);
        }
    }
}

/// Particles of other ranks that this rank knows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Foreign {
    /// Ids, ascending.
    ids: Vec<u64>,
    owners: Vec<u32>,
}

impl Foreign {
    /// Finds the owners of these particles, none of which this rank owns. Collective.
    pub(crate) fn find(ids: Vec<u64>, owned: &Ownership, ranks: &dyn Communicator) -> Self {
        let mut ids = sorted_by_key(ids, |&id| id);
        ids.dedup();
        let mut owners = vec![NONE; ids.len()];
        if ranks.size() > 1 && ranks.any(!ids.is_empty()) {
            let found: OwnersOf = owners_of(ids.iter().copied(), &owned.ids, ranks);
            for (owner, &id) in owners.iter_mut().zip(&ids) {
                *owner = found.owner(id).map_or(NONE, |rank| rank as u32);
            }
        }
        Self { ids, owners }
    }

    pub(crate) fn ids(&self) -> &[u64] {
        &self.ids
    }

    /// The place of an id in the list; `None` if no rank owns it.
    pub(crate) fn place_of(&self, id: u64) -> Option<usize> {
        self.ids.binary_search(&id).ok().filter(|&place| self.owners[place] != NONE)
    }

    /// Sends a record about each of them to its owner; returns the records received here. Collective.
    pub(crate) fn notify<T: Pod>(
        &self,
        record: impl Fn(usize) -> T,
        ranks: &dyn Communicator,
    ) -> Vec<T> {
        if ranks.size() == 1 {
            return Vec::new();
        }
        let incoming = ranks.sparse_exchange(&self.messages(record, ranks.size()));
        incoming.iter().flat_map(|message| records_of_bytes(&message.bytes)).collect()
    }

    /// Asks the owner of each of them; `answer` is this rank's answer about its own particle at a place. Zeros for
    /// particles without an owner. Collective.
    pub(crate) fn ask<A: Pod>(
        &self,
        owned: &Ownership,
        answer: impl Fn(usize) -> A,
        ranks: &dyn Communicator,
    ) -> Vec<A> {
        let mut answers = vec![A::zeroed(); self.ids.len()];
        if ranks.size() == 1 {
            return answers;
        }
        let questions =
            ranks.sparse_exchange(&self.messages(|place| self.ids[place], ranks.size()));
        let reply = |question: &Message| {
            let asked = records_of_bytes::<u64>(&question.bytes);
            let of = |id| owned.place_of(id).map_or_else(A::zeroed, &answer);
            Message::of(question.rank, &asked.map(of).collect::<Vec<A>>())
        };
        let replies = ranks.sparse_exchange(&questions.iter().map(reply).collect::<Vec<_>>());
        for reply in &replies {
            // Owners answer in the order in which they were asked.
            let asked =
                self.owners.iter().enumerate().filter(|(_, owner)| **owner == reply.rank as u32);
            for ((place, _), said) in asked.zip(records_of_bytes::<A>(&reply.bytes)) {
                answers[place] = said;
            }
        }
        answers
    }

    fn messages<T: Pod>(&self, record: impl Fn(usize) -> T, size: usize) -> Vec<Message> {
        let mut outgoing = vec![Vec::new(); size];
        for (place, &owner) in self.owners.iter().enumerate() {
            if owner != NONE {
                outgoing[owner as usize].push(record(place));
            }
        }
        outgoing.iter().enumerate().map(|(rank, records)| Message::of(rank, records)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::run_on_threads;

    #[test]
    fn ids_are_found_at_their_places() {
        let sets: [Vec<u64>; 5] = [
            vec![],
            vec![7],
            (0..100).collect(),
            (0..200).map(|k| 1_000 + k * k * 37).collect(),
            vec![0, 1, 2, u64::MAX - 1, u64::MAX],
        ];
        for ids in sets {
            let owned = Ownership::of(ids.clone());
            for (place, &id) in ids.iter().enumerate() {
                assert_eq!(owned.place_of(id), Some(place));
                for other in [id.wrapping_add(1), id.wrapping_sub(1)] {
                    assert_eq!(owned.place_of(other), ids.binary_search(&other).ok());
                }
            }
            assert_eq!(owned.place_of(500), ids.binary_search(&500).ok());
        }
    }

    #[test]
    fn records_go_where_their_particles_are() {
        for n in 1..=4 {
            run_on_threads(n, |ranks| {
                let mine = |id: &u64| (id * id % 7) as usize % n == ranks.rank();
                let owned = Ownership::of((0..50).filter(mine).collect());
                // Particle 99 has left.
                let all = (0..50).chain([99]).map(|id| [id, id + 1]);
                let mut records: Vec<[u64; 2]> =
                    all.filter(|record| record[1] as usize % n == ranks.rank()).collect();
                owned.align(&mut records, |record| *record, ranks);
                let expected: Vec<[u64; 2]> = owned.ids().iter().map(|&id| [id, id + 1]).collect();
                assert_eq!(records, expected);
            });
        }
    }

    #[test]
    fn owners_are_notified_and_answer() {
        for n in 1..=4 {
            run_on_threads(n, |ranks| {
                let owned =
                    Ownership::of((0..40).filter(|id| *id as usize % n == ranks.rank()).collect());
                let others = (0..45).filter(|id| owned.place_of(*id).is_none()).collect();
                let foreign = Foreign::find(others, &owned, ranks);
                let answers = foreign.ask(&owned, |place| owned.ids()[place] + 1000, ranks);
                for (&id, answer) in foreign.ids().iter().zip(answers) {
                    assert_eq!(answer, if id < 40 { id + 1000 } else { 0 });
                    assert_eq!(foreign.place_of(id).is_some(), id < 40);
                }
                let mut received = foreign.notify(|place| foreign.ids()[place], ranks);
                received.sort_unstable();
                let expected = owned.ids().iter().flat_map(|&id| vec![id; n - 1]);
                assert_eq!(received, expected.collect::<Vec<_>>());
            });
        }
    }
}
