//! Sends contact histories, at the start of a run, to the owners of their particles, which are not known to the ranks
//! that have read them.
//!
//! The owners are found in a distributed directory, by a rendezvous algorithm (the distributed directory of Zoltan; S.
//! J. Plimpton, C. Knight, "Rendezvous algorithms for large-scale modeling and simulation", J. Parallel Distrib.
//! Comput. 147 (2021) 184-195). The range of ids is divided into equal chunks, one for each rank, which keeps the
//! owners of the particles in its chunk: its entries of the directory. Each rank registers the particles that it owns,
//! looks up those that its records name, and then sends the records. No rank ever holds more than its share of the
//! records and of the directory. If a rank's ids are consecutive, like those read from a checkpoint, it sends to few
//! others.

use super::migrate::deliver;
use super::sort_by_id::IdRange;
use super::{Communicator, ContactRecord, Message, WallContactRecord, records_of_bytes};
use crate::particles::ContactHistories;
use bytemuck::Pod;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// Owners of particles, by id.
type Owners = FxHashMap<u64, usize>;

/// Sends contact records, each of which is on one rank, to the ranks that own their particles. `owned` holds the ids of
/// the particles of this rank. Records of particles without an owner are dropped. This call is collective.
pub fn send_histories_to_owners(
    mut contacts: Vec<ContactRecord>,
    mut wall_contacts: Vec<WallContactRecord>,
    owned: &[u64],
    ranks: &dyn Communicator,
) -> ContactHistories {
    if ranks.size() > 1 {
        let ids_of_pair = |record: &ContactRecord| [record.lower, record.higher];
        let ids_at_wall = |record: &WallContactRecord| [record.particle; 2];
        let mut ids: Vec<u64> = contacts.iter().flat_map(ids_of_pair).collect();
        ids.extend(wall_contacts.iter().map(|record| record.particle));
        ids.sort_unstable();
        ids.dedup();
        let owners = find_owners(&ids, owned, ranks);
        contacts = to_owners(contacts, ids_of_pair, &owners, ranks);
        wall_contacts = to_owners(wall_contacts, ids_at_wall, &owners, ranks);
    }
    ContactHistories { pairs: contacts, walls: wall_contacts, partners: Vec::new() }
}

/// The owners of the particles with these ids; those without an owner are left out. This call is collective.
fn find_owners(ids: &[u64], owned: &[u64], ranks: &dyn Communicator) -> Owners {
    let range = IdRange::of(owned.iter().copied(), ranks);
    let send_to_directory = |ids: &[u64]| {
        let mut by_rank = BTreeMap::<usize, Vec<u64>>::new();
        for &id in ids {
            by_rank.entry(range.chunk_of(id, ranks.size())).or_default().push(id);
        }
        ranks.sparse_exchange(&messages(by_rank))
    };
    let mut directory = Owners::default();
    for message in send_to_directory(owned) {
        directory.extend(records_of_bytes(&message.bytes).map(|id: u64| (id, message.rank)));
    }
    let answers = send_to_directory(ids).into_iter().map(|message| {
        let known = |id: u64| directory.get(&id).map(|&owner| [id, owner as u64]);
        (message.rank, records_of_bytes(&message.bytes).filter_map(known).collect())
    });
    let answers = ranks.sparse_exchange(&messages::<[u64; 2]>(answers.collect()));
    let answers = answers.iter().flat_map(|message| records_of_bytes::<[u64; 2]>(&message.bytes));
    answers.map(|[id, owner]| (id, owner as usize)).collect()
}

fn messages<T: Pod>(by_rank: BTreeMap<usize, Vec<T>>) -> Vec<Message> {
    by_rank.into_iter().map(|(rank, records)| Message::of(rank, &records)).collect()
}

/// Sends each record to the owners of its two particles, once if they are the same. This call is collective.
fn to_owners<T: Pod>(
    records: Vec<T>,
    ids_of: impl Fn(&T) -> [u64; 2],
    owners: &Owners,
    ranks: &dyn Communicator,
) -> Vec<T> {
    let mut outgoing = vec![Vec::new(); ranks.size()];
    for record in records {
        let mut owners = ids_of(&record).map(|id| owners.get(&id));
        if owners[0] == owners[1] {
            owners[1] = None;
        }
        owners.into_iter().flatten().for_each(|&owner| outgoing[owner].push(record));
    }
    deliver(outgoing, ranks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::run_on_threads;
    use bytemuck::Zeroable;

    /// Ids with gaps, whose owners do not follow from their order.
    fn id(number: u64) -> u64 {
        7 * number + 3
    }

    fn owner(id: u64, ranks: u64) -> u64 {
        id * id % 11 % ranks
    }

    #[test]
    fn every_history_arrives_once_at_each_owner() {
        for n in 1..=4 {
            run_on_threads(n, |ranks| {
                let (here, size) = (ranks.rank() as u64, ranks.size() as u64);
                let owned: Vec<u64> =
                    (0..100).map(id).filter(|&id| owner(id, size) == here).collect();
                let pairs: Vec<[u64; 2]> = (0..99)
                    .flat_map(|k| [[id(k), id(k + 1)], [id(k), id((k * k) % 100)]])
                    .collect();
                let on_this_rank = |&(index, _): &(usize, &[u64; 2])| index as u64 % size == here;
                let record = |[lower, higher]: [u64; 2]| ContactRecord {
                    lower,
                    higher,
                    ..Zeroable::zeroed()
                };
                let contacts =
                    pairs.iter().enumerate().filter(on_this_rank).map(|(_, &pair)| record(pair));
                let walls = (0..100).filter(|k| k % size == here).map(|k| WallContactRecord {
                    particle: id(99 - k),
                    wall: 2,
                    ..Zeroable::zeroed()
                });
                let ContactHistories { pairs: found, walls: at_walls, .. } =
                    send_histories_to_owners(contacts.collect(), walls.collect(), &owned, ranks);

                let mut found: Vec<[u64; 2]> =
                    found.iter().map(|pair| [pair.lower, pair.higher]).collect();
                found.sort_unstable();
                let is_mine = |pair: &&[u64; 2]| pair.iter().any(|&id| owner(id, size) == here);
                let mut expected: Vec<[u64; 2]> = pairs.iter().filter(is_mine).copied().collect();
                expected.sort_unstable();
                assert_eq!(found, expected);
                let mut at_walls: Vec<u64> = at_walls.iter().map(|wall| wall.particle).collect();
                at_walls.sort_unstable();
                assert_eq!(at_walls, owned);
            });
        }
    }

    #[test]
    fn histories_of_particles_without_an_owner_are_dropped() {
        run_on_threads(3, |ranks| {
            let owned = [10 + ranks.rank() as u64];
            let contact = |lower, higher| ContactRecord { lower, higher, ..Zeroable::zeroed() };
            let here = if ranks.is_root() {
                vec![contact(0, 99), contact(11, u64::MAX), contact(5, 12)]
            } else {
                Vec::new()
            };
            let ContactHistories { pairs, .. } =
                send_histories_to_owners(here, Vec::new(), &owned, ranks);
            let expected = [vec![], vec![[11, u64::MAX]], vec![[5, 12]]];
            let found: Vec<[u64; 2]> = pairs.iter().map(|pair| [pair.lower, pair.higher]).collect();
            assert_eq!(found, expected[ranks.rank()]);
        });
    }
}
