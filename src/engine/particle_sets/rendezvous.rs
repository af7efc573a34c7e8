//! Rendezvous of records: records with a key meet on one rank, which all ranks can compute from the key.
//!
//! No rank needs to know which rank owns a particle. Keys are spread over the ranks by a hash, so that about equally
//! many meet on each rank, and the results of a rank for its keys do not depend on the senders of the records.

use crate::numbers::sorted_by_key;
use crate::parallel::{Communicator, Message, records_of_bytes};
use bytemuck::Pod;
use rustc_hash::FxHashMap;

/// A well-mixed number, different for each key (the finaliser of SplitMix64: Steele, Lea & Flood, OOPSLA 2014,
/// doi:10.1145/2660193.2660195).
pub fn mixed(key: u64) -> u64 {
    let mut x = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The rank on which records with this key meet.
pub(crate) fn rendezvous_rank(key: u64, ranks: &dyn Communicator) -> usize {
    (mixed(key) % ranks.size() as u64) as usize
}

/// Sends each record to the rendezvous rank of its key; returns those that meet here, in an unspecified order.
/// Collective.
pub fn send_to_rendezvous<T: Pod>(
    records: impl IntoIterator<Item = T>,
    key_of: impl Fn(&T) -> u64,
    ranks: &dyn Communicator,
) -> Vec<T> {
    let mut outgoing = vec![Vec::new(); ranks.size()];
    for record in records {
        outgoing[rendezvous_rank(key_of(&record), ranks)].push(record);
    }
    exchanged(outgoing, ranks)
}

/// Sends keys and the values that belong to them. Collective.
pub(crate) fn send_keyed<T: Pod>(
    records: impl IntoIterator<Item = (u64, T)>,
    ranks: &dyn Communicator,
) -> Vec<(u64, T)> {
    let mut keys = vec![Vec::new(); ranks.size()];
    let mut values = vec![Vec::new(); ranks.size()];
    for (key, value) in records {
        let rank = rendezvous_rank(key, ranks);
        keys[rank].push(key);
        values[rank].push(value);
    }
    // Both arrive in the order of their senders.
    exchanged(keys, ranks).into_iter().zip(exchanged(values, ranks)).collect()
}

/// Values sent here by all ranks, in the order of the ranks; values that stay here are not copied. Collective.
fn exchanged<T: Pod>(mut outgoing: Vec<Vec<T>>, ranks: &dyn Communicator) -> Vec<T> {
    let mut here = std::mem::take(&mut outgoing[ranks.rank()]);
    if ranks.size() > 1 {
        let incoming = ranks.sparse_exchange(&messages(&outgoing));
        here.extend(incoming.iter().flat_map(|message| records_of_bytes::<T>(&message.bytes)));
    }
    here
}

/// Ranks that own particles.
pub(crate) type OwnersOf = Answers<u64>;

/// Marks a particle without an owner.
const NO_OWNER: u64 = u64::MAX;

/// The ranks that own these particles, each of which is in the list `owned` of one rank, or of none. Collective.
pub(crate) fn owners_of(
    ids: impl IntoIterator<Item = u64>,
    owned: &[u64],
    ranks: &dyn Communicator,
) -> OwnersOf {
    let rank = ranks.rank() as u64;
    let here = send_keyed(owned.iter().map(|&id| (id, rank)), ranks);
    let known: FxHashMap<u64, u64> = here.into_iter().collect();
    ask(ids, |id| known.get(&id).copied().unwrap_or(NO_OWNER), ranks)
}

impl OwnersOf {
    /// The owner of a particle that was looked up.
    pub(crate) fn owner(&self, id: u64) -> Option<usize> {
        self.get(id).filter(|&owner| owner != NO_OWNER).map(|owner| owner as usize)
    }
}

fn messages<T: Pod>(by_rank: &[Vec<T>]) -> Vec<Message> {
    let filled = by_rank.iter().enumerate().filter(|(_, records)| !records.is_empty());
    filled.map(|(rank, records)| Message::of(rank, records)).collect()
}

/// The answers of the rendezvous ranks of some keys.
#[derive(Clone, Debug)]
pub struct Answers<A> {
    keys: Vec<u64>,
    values: Vec<A>,
}

impl<A: Copy> Answers<A> {
    /// The answer about a key that was looked up.
    pub fn get(&self, key: u64) -> Option<A> {
        let place = self.keys.binary_search(&key).ok()?;
        self.values.get(place).copied()
    }
}

/// Asks the rendezvous ranks of some keys, each key once; `answer` is this rank's answer about a key that meets here.
/// Collective.
pub fn ask<A: Pod>(
    keys: impl IntoIterator<Item = u64>,
    answer: impl Fn(u64) -> A,
    ranks: &dyn Communicator,
) -> Answers<A> {
    let keys = distinct(keys);
    let mut outgoing = vec![Vec::new(); ranks.size()];
    keys.iter().for_each(|&key| outgoing[rendezvous_rank(key, ranks)].push(key));
    if ranks.size() == 1 {
        let values = keys.iter().map(|&key| answer(key)).collect();
        return Answers { keys, values };
    }
    let questions = ranks.sparse_exchange(&messages(&outgoing));
    let replies = questions.iter().map(|question| {
        let answers: Vec<A> = records_of_bytes(&question.bytes).map(&answer).collect();
        Message::of(question.rank, &answers)
    });
    let replies = ranks.sparse_exchange(&replies.collect::<Vec<_>>());
    // Each rank answers in the order in which it was asked.
    let mut by_rank_of_key: Vec<std::vec::IntoIter<A>> = vec![Vec::new().into_iter(); ranks.size()];
    for reply in &replies {
        by_rank_of_key[reply.rank] = records_of_bytes(&reply.bytes).collect::<Vec<A>>().into_iter();
    }
    let next =
        |&key: &u64| by_rank_of_key[rendezvous_rank(key, ranks)].next().unwrap_or_else(A::zeroed);
    let values = keys.iter().map(next).collect();
    Answers { keys, values }
}

/// The keys in ascending order, each once.
pub fn distinct(keys: impl IntoIterator<Item = u64>) -> Vec<u64> {
    let mut keys = sorted_by_key(keys.into_iter().collect(), |&key: &u64| key);
    keys.dedup();
    keys
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::run_on_threads;

    #[test]
    fn ranks_answer_about_what_was_sent_to_them() {
        for n in 1..=4 {
            run_on_threads(n, |ranks| {
                let mine = (0..100_u64).filter(|k| k % n as u64 == ranks.rank() as u64);
                let mut here = send_to_rendezvous(mine.map(|k| [k, k * k]), |pair| pair[0], ranks);
                here.sort_unstable();
                let square = |key: u64| {
                    here.binary_search_by_key(&key, |pair| pair[0]).map_or(0, |i| here[i][1])
                };
                let answers = ask([99, 3, 3, 500], square, ranks);
                assert_eq!(answers.get(3), Some(9));
                assert_eq!(answers.get(99), Some(99 * 99));
                assert_eq!(answers.get(500), Some(0)); // nobody sent it
                assert_eq!(answers.get(4), None); // nobody asked
            });
        }
    }

    #[test]
    fn keys_spread_evenly() {
        let made = run_on_threads(4, |ranks| {
            (0..4000).filter(|&key| rendezvous_rank(key, ranks) == ranks.rank()).count()
        });
        // Four standard deviations of a binomial distribution.
        assert!(made.iter().all(|&count| count.abs_diff(1000) < 110), "{made:?}");
    }
}
