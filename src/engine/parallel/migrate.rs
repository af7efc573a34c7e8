//! Change of owner: each particle is sent with its contact histories to the rank whose subdomain contains it.

use super::migration_message::MigrationMessage;
use super::{Communicator, Message, ParticleRecord, records_of_bytes};
use crate::domain::Decomposition;
use crate::particles::{ContactHistories, CustomFields, Particles};
use bytemuck::Pod;
use nalgebra::Vector3;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// Sends every owned particle with its contact histories to the rank whose subdomain contains its position. This call
/// is collective.
///
/// Before: there are no ghosts; positions are wrapped; the history of two particles on different ranks is on both
/// ranks, or on one that knows where the other's particle is. After: every rank owns exactly the particles in its
/// subdomain and holds the histories of all their contacts. A pair may be listed twice, with the same contents.
pub fn migrate(
    particles: &mut Particles,
    histories: &mut ContactHistories,
    decomposition: &Decomposition,
    ranks: &dyn Communicator,
) {
    if ranks.size() == 1 {
        return;
    }
    let here = ranks.rank();
    let owner: Vec<usize> =
        particles.body.iter().map(|body| decomposition.owner_of(&body.position)).collect();
    let of_partner = |(id, position): (u64, Vector3<f64>)| (id, decomposition.owner_of(&position));
    let partners = std::mem::take(&mut histories.partners).into_iter().map(of_partner);
    let owned = particles.id.iter().copied().zip(owner.iter().copied());
    let elsewhere: FxHashMap<u64, usize> =
        owned.chain(partners).filter(|&(_, rank)| rank != here).collect();
    let mut messages = OutgoingMessages::new();
    if !elsewhere.is_empty() {
        pack_histories(&mut messages, histories, &elsewhere);
    }
    if owner.iter().any(|&rank| rank != here) {
        pack_particles(&mut messages, particles, &owner, here);
    }
    let messages: Vec<Message> =
        messages.iter().map(|(&rank, message)| message.message_to(rank)).collect();
    for message in ranks.sparse_exchange(&messages) {
        let width = particles.columns.custom_width();
        let message = MigrationMessage::of(&message, width);
        for (number, record) in message.particles.iter().enumerate() {
            record.push_to(particles);
            let index = particles.count() - 1;
            particles.set_custom_row(index, &message.custom[number * width..][..width]);
        }
        histories.pairs.extend(message.pairs);
        histories.walls.extend(message.walls);
    }
}

/// Sends records, at the start of a run, to the ranks whose subdomains contain the particles, with the rows of custom
/// fields. This call is collective.
pub fn send_to_owners(
    records: Vec<ParticleRecord>,
    custom: CustomFields,
    decomposition: &Decomposition,
    ranks: &dyn Communicator,
) -> (Vec<ParticleRecord>, CustomFields) {
    if ranks.size() == 1 {
        return (records, custom);
    }
    let mut outgoing = vec![Vec::new(); ranks.size()];
    let mut rows = vec![Vec::new(); ranks.size()];
    for (index, record) in records.into_iter().enumerate() {
        let owner = decomposition.owner_of(&Vector3::from(record.position));
        outgoing[owner].push(record);
        rows[owner].extend_from_slice(custom.row(index));
    }
    // Both in the order of the senders.
    let numbers = if custom.fields.is_empty() { Vec::new() } else { deliver(rows, ranks) };
    (deliver(outgoing, ranks), CustomFields { numbers, ..custom })
}

/// Returns the records of all ranks, in the order of the ranks, on every rank; there must be few. They are gathered on
/// rank 0 along a binary tree and broadcast, which takes about 2 log2 n messages one after another on n ranks. This
/// call is collective.
pub fn share_with_all<T: Pod>(records: Vec<T>, ranks: &dyn Communicator) -> Vec<T> {
    if ranks.size() == 1 {
        return records;
    }
    let (here, size) = (ranks.rank(), ranks.size());
    let mut held: Vec<u8> = bytemuck::cast_slice(&records).to_vec();
    let mut incoming = <[Vec<u8>; 2]>::default();
    let mut width = 1;
    while width < size {
        let in_group = here % (2 * width);
        let lower = (in_group == width).then(|| here - width);
        let upper = Some(here + width).filter(|&rank| in_group == 0 && rank < size);
        ranks.exchange([lower, upper], [&held, &[]], &mut incoming);
        held.extend_from_slice(&incoming[1]);
        width *= 2;
    }
    ranks.broadcast_from_root(&mut held);
    records_of_bytes(&held).collect()
}

/// The messages, by the receiving rank.
type OutgoingMessages = BTreeMap<usize, MigrationMessage>;

/// Adds a history to the messages to those owners of its particles that are known to be on other ranks, and keeps it if
/// one of the particles may be here.
fn pack_histories(
    messages: &mut OutgoingMessages,
    ContactHistories { pairs, walls, .. }: &mut ContactHistories,
    elsewhere: &FxHashMap<u64, usize>,
) {
    let owner = |id: u64| elsewhere.get(&id).copied();
    pairs.retain(|&pair| {
        let owners = [owner(pair.lower), owner(pair.higher)];
        let to = if owners[0] == owners[1] { &owners[..1] } else { &owners[..] };
        for &rank in to.iter().flatten() {
            messages.entry(rank).or_default().pairs.push(pair);
        }
        owners.contains(&None)
    });
    walls.retain(|&contact| {
        let to = owner(contact.particle);
        if let Some(rank) = to {
            messages.entry(rank).or_default().walls.push(contact);
        }
        to.is_none()
    });
}

/// Adds particles to the messages to their owners; those that stay keep their order.
fn pack_particles(
    messages: &mut OutgoingMessages,
    particles: &mut Particles,
    owner: &[usize],
    here: usize,
) {
    for (index, &rank) in owner.iter().enumerate().filter(|&(_, &rank)| rank != here) {
        let message = messages.entry(rank).or_default();
        message.particles.push(ParticleRecord::of(particles, index));
        particles.append_custom_row(index, &mut message.custom);
    }
    let staying: Vec<u32> =
        (0..owner.len() as u32).filter(|&index| owner[index as usize] == here).collect();
    particles.select(&staying);
}

/// Sends `outgoing[r]` to rank r; returns the received records, in the order of the senders. The records of this rank
/// to itself are not copied. This call is collective.
pub(super) fn deliver<T: Pod>(mut outgoing: Vec<Vec<T>>, ranks: &dyn Communicator) -> Vec<T> {
    let mut own = std::mem::take(&mut outgoing[ranks.rank()]);
    if ranks.size() == 1 {
        return own;
    }
    let to_others = outgoing.into_iter().enumerate().filter(|(_, records)| !records.is_empty());
    let messages: Vec<Message> =
        to_others.map(|(rank, records)| Message::of(rank, &records)).collect();
    let incoming = ranks.sparse_exchange(&messages);
    drop(messages);
    let from_below = incoming.partition_point(|message| message.rank < ranks.rank());
    let (below, above) = incoming.split_at(from_below);
    let records = |messages: &[Message]| -> Vec<T> {
        messages.iter().flat_map(|message| records_of_bytes(&message.bytes)).collect()
    };
    let mut delivered = records(below);
    delivered.append(&mut own);
    delivered.extend(records(above));
    delivered
}
