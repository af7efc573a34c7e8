//! Selection of the particles near a wall that are evaluated.

use super::geometry::WallNow;
use crate::contact::lanes::FourVectors;
use crate::numbers::{F64x4, fetch_ahead, vectorised};
use crate::particles::{Contacts, Particles, four_of, push_set_bits};
use std::ops::Range;

/// Number of slots ahead at which particles are prefetched if they do not fit into a cache.
const AHEAD: usize = 16;

vectorised!(
    /// Finds, among the particles near a wall with these slots, those on which it may exert a force, and those whose
    /// contact with it still has to end. Adds their slots to `acting`, in ascending order. `range` is the separation up
    /// to which any force acts.
    pub(super) fn find_acting<Q: F64x4>(
        particles: &Particles,
        contacts: &Contacts,
        slots: Range<usize>,
        wall: WallNow,
        range: f64,
        acting: &mut Vec<u32>,
    ) {
        let (bodies, range) = (&particles.body[..], Q::splat(range));
        let fetches = particles.exceed_caches();
        for from in slots.clone().step_by(4) {
            let four = from..slots.end.min(from + 4);
            if fetches {
                let coming = contacts.wall_pairs.iter().skip(from + AHEAD).take(4);
                coming.for_each(|pair| fetch_ahead(bodies, pair.particle as usize));
            }
            let mut places = [Q::splat(0.0); 4];
            for (place, pair) in places.iter_mut().zip(four_of(&contacts.wall_pairs[four.clone()]))
            {
                *place = Q::load(&bodies[pair.particle as usize].vectors()[0]);
            }
            let [x, y, z, radius] = Q::transposed(places);
            let separation = wall.heights_of_four(FourVectors([x, y, z])).minus(radius);
            let beyond = range.below(separation); // not so if it is undefined: the force then ends the run
            let touching = four_of(&contacts.wall_touching[four.clone()]);
            let touching = (0..4).fold(0, |bits, k| bits | u32::from(*touching[k]) << k);
            let used = (1 << four.len()) - 1;
            push_set_bits(acting, (!beyond | touching) & used, |bit| from as u32 + bit);
        }
    }
);
