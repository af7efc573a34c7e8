//! Data that a sample of the particles of a rank takes from its lists.

use super::agglomerates::ParticleSample;
use super::ownership::Ownership;
use super::pair::{Pair, ascending};
use crate::domain::Bounds;
use crate::numbers::sorted_by_key;
use crate::parallel::Communicator;
use crate::particles::{Contacts, Particles};

/// The particles that this rank owns, by ascending id, with positions wrapped into the box, and the index of each.
pub fn samples(particles: &Particles, bounds: &Bounds) -> (Vec<ParticleSample>, Vec<usize>) {
    let sample = |&i: &usize| {
        let body = &particles.body[i];
        let position = bounds.wrap(body.position);
        let (mass, radius, velocity) = (body.mass, body.radius, body.velocity);
        ParticleSample { id: particles.id[i], mass, radius, position, velocity }
    };
    let order: Vec<usize> = (0..particles.owned_count()).collect();
    let order = sorted_by_key(order, |&i| particles.id[i]);
    (order.iter().map(sample).collect(), order)
}

/// The touching pairs of different particles, each once, on the rank that owns the lower id, in ascending order.
/// Collective.
pub fn touching_pairs(
    contacts: &Contacts,
    particles: &Particles,
    owned: &Ownership,
    ranks: &dyn Communicator,
) -> Vec<Pair> {
    let two = contacts.touching_pairs(particles).filter(|[lower, higher]| lower != higher);
    // There are about three contacts per particle.
    let mut pairs = Vec::with_capacity(3 * particles.owned_count());
    pairs.extend(two.map(|[lower, higher]| Pair { lower, higher }));
    let mut pairs = ascending(pairs, Pair::ends);
    owned.align(&mut pairs, Pair::ends, ranks);
    // In a narrow box two particles may touch in two images.
    pairs.dedup();
    pairs
}
