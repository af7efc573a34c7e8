//! The pairs of the neighbour list, and the contact histories of the touching ones.
//!
//! Every pair of particles closer than the range of the list has a slot, on one rank. A pair of particles of two ranks
//! is on the rank for which the other's particle is [ahead](crate::domain::Subdomain::is_ahead). Pairs are stored in
//! rows: the row of an owned particle lists its partners. Each pair of two owned particles is listed once, even if they
//! meet through a periodic face. The pairs that may act on each other within the next steps, and the histories of the
//! touching ones, are in the [`InnerList`]. [`Contacts::histories`] extracts the histories, and `Contacts::restore`
//! puts them back: when the list is rebuilt, on another rank, or from a checkpoint.

use super::contact_state::{
    ContactHistories, ContactHistory, ContactRecord, ContactState, WallContactRecord,
};
use super::inner_list::{Rows, pair_of};
use super::places::Places;
use super::range::ListRange;
use super::{InnerList, InteractionRanges, PairCounts, Particles};
use crate::domain::PosedWalls;
use nalgebra::Vector3;
use rustc_hash::FxHashSet;
use std::ops::Range;
use thiserror::Error;

/// A pair within the interaction range that is missing from the new neighbour list: an error of the program, never of
/// the case.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("internal error: the contact of particle {0} with {1} was lost in a list rebuild")]
pub struct LostContact(u64, String);

/// A pair of an owned particle and a wall near it, or a facet of a mesh near it. Pairs are sorted by their fields in
/// order, so that those with the same law follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct WallPair {
    pub(crate) wall: u32,
    /// Species of the particle.
    pub(crate) species: u32,
    pub(crate) particle: u32,
    /// Number of the facet; 0 unless the wall is a mesh.
    pub(crate) facet: u32,
}

impl WallPair {
    fn of(particles: &Particles, wall: u32, particle: u32, facet: u32) -> Self {
        let species = particles.body[particle as usize].species() as u32;
        Self { wall, species, particle, facet }
    }

    /// Whether both pairs have the same law.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        (self.wall, self.species) == (other.wall, other.species)
    }
}

/// The facets of a mesh that have to be evaluated for a particle while it is near the place where they were found. It
/// saves work and changes no result.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MeshMargin {
    /// The place, relative to the mesh.
    pub(crate) place: Vector3<f64>,
    /// All other facets are at least so far from the surface of the particle there; 0 before they are known.
    pub(crate) gap: f64,
}

/// The pairs of the neighbour list, of particles and of particles with walls, and their contact histories.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Row i holds the slots `row_start[i]..row_start[i + 1]`.
    pub(crate) row_start: Vec<u32>,
    /// Partner of each slot, an owned particle or a ghost.
    pub(crate) partner: Vec<u32>,
    /// The pairs that may act on each other within the next steps.
    pub(crate) inner: InnerList,
    pub(crate) wall_pairs: Vec<WallPair>,
    /// Whether the wall may act on the particle in each of these pairs. Of the facets of a mesh that a particle touches,
    /// one acts for all that are one contact.
    pub(crate) wall_acts: Vec<bool>,
    /// For the first pair of each particle with each mesh: how far the particle may move until another facet is near.
    pub(crate) mesh_margins: Vec<MeshMargin>,
    /// Whether the facet of each of these pairs is evaluated until then.
    pub(crate) facet_is_close: Vec<bool>,
    pub(crate) wall_touching: Vec<bool>,
    /// State of these contacts; zero for those that do not touch.
    pub(crate) wall_state: Vec<ContactState>,
}

/// Marks a slot whose pair has no history.
const NO_HISTORY: u32 = u32::MAX;

impl Contacts {
    /// Number of slots.
    pub fn pair_count(&self) -> usize {
        self.partner.len()
    }

    /// For each particle, owned or ghost, whether it is the second of a listed pair.
    pub(crate) fn are_partners(&self, particles: &Particles) -> Vec<bool> {
        let mut are_partners = vec![false; particles.count()];
        self.partner.iter().for_each(|&partner| are_partners[partner as usize] = true);
        are_partners
    }

    /// The pairs of the neighbour list: all pairs within the range of any force, and more.
    pub(crate) fn listed_pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let rows = self.row_start.windows(2).enumerate();
        rows.flat_map(|(row, ends)| {
            let partners = &self.partner[ends[0] as usize..ends[1] as usize];
            partners.iter().map(move |&partner| [row as u32, partner])
        })
    }

    /// For each owned particle, the number of pairs within the range of contacts whose first particle it is.
    pub(crate) fn active_counts(&self, particles: &Particles) -> Vec<u32> {
        let mut counts = vec![0; particles.owned_count()];
        self.inner.active_indices().for_each(|[first, _]| counts[first as usize] += 1);
        counts
    }

    /// Number of touching pairs.
    pub fn touching_count(&self) -> usize {
        self.inner.touching_indices().count()
    }

    /// The touching pairs by ascending ids.
    pub fn touching_pairs<'a>(
        &'a self,
        particles: &'a Particles,
    ) -> impl Iterator<Item = [u64; 2]> + 'a {
        self.inner.touching_indices().map(|pair| {
            let [here, there] = pair.map(|index| particles.id[index as usize]);
            [here.min(there), here.max(there)]
        })
    }

    /// For each particle, owned or ghost, the number of this rank's touching pairs that contain it; pairs of an image
    /// are counted with its original.
    pub fn touching_by_particle(&self, particles: &Particles) -> Vec<u32> {
        let mut numbers = vec![0; particles.count()];
        for [first, second] in self.inner.touching_indices() {
            numbers[first as usize] += 1;
            let second = second as usize;
            numbers[particles.owned_original(second).unwrap_or(second)] += 1;
        }
        numbers
    }

    /// All pairs that may act on each other now, with the histories of the touching ones, seen from the first particle.
    pub(crate) fn near_pairs(
        &self,
    ) -> impl Iterator<Item = ([u32; 2], Option<ContactHistory>)> + '_ {
        self.inner.with_histories()
    }

    /// Owned particles and walls that may act on each other now, with the histories of the touching ones.
    pub(crate) fn near_walls(
        &self,
    ) -> impl Iterator<Item = (WallPair, Option<ContactHistory>)> + '_ {
        self.wall_slots().map(|slot| {
            let history = self.wall_touching[slot].then(|| self.wall_state[slot].history());
            (self.wall_pairs[slot], history)
        })
    }

    /// The slots of particles and walls that may act on each other now, or whose contact still has to end.
    pub(crate) fn wall_slots(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.wall_pairs.len()).filter(|&slot| self.wall_acts[slot] || self.wall_touching[slot])
    }

    /// Removes all pairs of particles, for a new list.
    pub(super) fn clear_pairs(&mut self, particles: &Particles) {
        self.row_start.clear();
        // If this vector grew while the partners grow, each would leave holes in the memory of the other.
        self.row_start.reserve_exact(particles.owned_count() + 1);
        self.row_start.push(0);
        self.partner.clear();
        self.inner.clear(particles);
    }

    /// The numbers of this rank's pairs, from which the margin of the inner list is chosen.
    pub(crate) fn pair_counts(&self) -> PairCounts {
        let candidates = self.inner.candidates_per_length();
        PairCounts { listed: self.pair_count() as f64, candidates }
    }

    /// Adds an upper bound of the displacements of all particles since the last call; the numbers of pairs are the
    /// largest on any rank.
    pub(crate) fn moved(&mut self, displacement: f64, pairs: PairCounts) {
        self.inner.moved(displacement, pairs);
    }

    /// Ensures that the inner list holds all pairs within the interaction ranges.
    pub(crate) fn update_inner_list(&mut self, particles: &Particles, ranges: InteractionRanges) {
        let rows = Rows { start: &self.row_start, partners: &self.partner };
        self.inner.update(particles, rows, ranges);
    }

    /// The histories of all contacts of this rank.
    pub fn histories(&self, particles: &Particles) -> ContactHistories {
        let mut histories = ContactHistories {
            walls: self.wall_histories(particles),
            ..ContactHistories::default()
        };
        for (pair, state) in self.inner.touching() {
            let [first, second] = pair.map(|index| index as usize);
            let ids = [particles.id[first], particles.id[second]];
            histories.pairs.push(ContactRecord::of(ids, state));
            if particles.owned_original(second).is_none() {
                histories.partners.push((ids[1], particles.body[second].position));
            }
        }
        histories
    }

    fn wall_histories(&self, particles: &Particles) -> Vec<WallContactRecord> {
        (0..self.wall_pairs.len())
            .filter(|&slot| self.wall_touching[slot])
            .map(|slot| {
                let WallPair { particle, wall, facet, .. } = self.wall_pairs[slot];
                let (particle, wall) = (particles.id[particle as usize], u64::from(wall));
                let (state, facet) = (self.wall_state[slot], f64::from(facet));
                WallContactRecord { particle, wall, state, facet }
            })
            .collect()
    }

    /// Lists the owned particles near walls, and the facets of meshes near them, without histories.
    pub(crate) fn find_wall_pairs(
        &mut self,
        particles: &Particles,
        walls: PosedWalls<'_>,
        range: ListRange,
    ) {
        self.wall_pairs.clear();
        let reach = range.interaction + range.skin;
        let owned = &particles.body[..particles.owned_count()];
        for (number, (wall, pose)) in walls.iter().enumerate() {
            for (particle, body) in owned.iter().enumerate() {
                let pair =
                    |facet: u32| WallPair::of(particles, number as u32, particle as u32, facet);
                if let Some(mesh) = wall.mesh() {
                    let place = pose.seen_at_rest(&body.position);
                    let near = |&facet: &u32| {
                        mesh.nearest_on(&place, facet).from.distance - body.radius < reach
                    };
                    let facets = mesh.facets_near(&place, body.radius + reach);
                    self.wall_pairs.extend(facets.filter(near).map(pair));
                } else if wall.height_at(&body.position, pose) - body.radius < reach {
                    self.wall_pairs.push(pair(0));
                }
            }
        }
        self.wall_pairs.sort_unstable(); // in a bed of one species they are sorted already
        let is_whole = |pair: &WallPair| walls.walls[pair.wall as usize].mesh().is_none();
        self.wall_acts = self.wall_pairs.iter().map(is_whole).collect();
        self.mesh_margins = vec![MeshMargin::default(); self.wall_pairs.len()];
        self.facet_is_close = vec![true; self.wall_pairs.len()];
        self.wall_touching.clear();
        self.wall_touching.resize(self.wall_pairs.len(), false);
        self.wall_state.clear();
        self.wall_state.resize(self.wall_pairs.len(), ContactState::default());
    }

    /// Restores the histories of the pairs of a new list; those of pairs that other ranks evaluate are dropped. A pair
    /// that has separated since the last step by more than the range of the list has no slot, and is no longer a
    /// contact: its history ends, as it would at the next evaluation of forces.
    ///
    /// # Errors
    /// If a pair within the interaction range has no slot.
    pub(crate) fn restore(
        &mut self,
        particles: &Particles,
        interaction_range: f64,
        histories: &ContactHistories,
    ) -> Result<(), LostContact> {
        let ContactHistories { pairs, walls, .. } = histories;
        let places = Places::of(&particles.id[..particles.owned_count()]);
        let of_slots = self.histories_of_slots(particles, &places, interaction_range, pairs)?;
        for row in 0..particles.owned_count() {
            for slot in self.slots_of(row).filter(|&slot| of_slots[slot] != NO_HISTORY) {
                let pair = pair_of(particles, [row as u32, self.partner[slot]]);
                let state = pairs[of_slots[slot] as usize].seen_from(particles.id[row]);
                self.inner.restore(particles, pair, state);
            }
        }
        self.restore_walls(particles, &places, walls);
        Ok(())
    }

    /// The slots of an owned particle.
    fn slots_of(&self, row: usize) -> Range<usize> {
        self.row_start[row] as usize..self.row_start[row + 1] as usize
    }

    /// The number of the history of each slot's pair, or [`NO_HISTORY`].
    fn histories_of_slots(
        &self,
        particles: &Particles,
        places: &Places,
        interaction_range: f64,
        pairs: &[ContactRecord],
    ) -> Result<Vec<u32>, LostContact> {
        let owned = particles.owned_count();
        let ghosts: FxHashSet<u64> = particles.id[owned..].iter().copied().collect();
        let is_here = |id: u64| places.get(id).is_some() || ghosts.contains(&id);
        let mut of_slots = vec![NO_HISTORY; self.partner.len()];
        for (number, pair) in pairs.iter().enumerate() {
            let ids = [pair.lower, pair.higher];
            let [lower, higher] = ids.map(|id| places.get(id));
            let mut is_listed = false;
            for (row, there, id) in [(lower, higher, ids[1]), (higher, lower, ids[0])] {
                let Some(row) = row else { continue };
                let slots = self.slots_of(row);
                let partners = &self.partner[slots.clone()];
                for (&partner, of_slot) in partners.iter().zip(&mut of_slots[slots]) {
                    let partner = partner as usize;
                    let is_there = if partner < owned {
                        there == Some(partner)
                    } else {
                        particles.id[partner] == id
                    };
                    if is_there {
                        *of_slot = number as u32;
                        is_listed = true;
                    }
                }
            }
            // If another rank evaluates the pair, one of its particles is not known here.
            let is_missing = !is_listed && ids.into_iter().all(is_here);
            if is_missing && is_within(particles, ids, interaction_range) {
                return Err(LostContact(pair.lower, format!("particle {}", pair.higher)));
            }
        }
        Ok(of_slots)
    }

    /// Restores contacts with walls; a particle without a pair with the wall is away from it.
    fn restore_walls(
        &mut self,
        particles: &Particles,
        places: &Places,
        walls: &[WallContactRecord],
    ) {
        for contact in walls {
            let Some(index) = places.get(contact.particle) else { continue };
            let pair =
                WallPair::of(particles, contact.wall as u32, index as u32, contact.facet as u32);
            let Ok(slot) = self.wall_pairs.binary_search(&pair) else { continue };
            self.wall_state[slot] = contact.state;
            self.wall_touching[slot] = true;
        }
    }
}

/// Whether an owned particle with one of two ids is within the interaction range of a particle with the other id that
/// is known here. Ghosts ahead extend at least this far beyond the subdomain.
fn is_within(particles: &Particles, [lower, higher]: [u64; 2], interaction_range: f64) -> bool {
    let of_id = |id: u64, count: usize| {
        let bodies = particles.id[..count].iter().zip(&particles.body);
        bodies.filter(move |&(&other, _)| other == id).map(|(_, body)| body)
    };
    let (owned, all) = (particles.owned_count(), particles.count());
    [[lower, higher], [higher, lower]].into_iter().any(|[here, there]| {
        of_id(here, owned).any(|one| {
            of_id(there, all).any(|other| {
                let distance = (one.position - other.position).norm();
                distance - one.radius - other.radius <= interaction_range
            })
        })
    })
}
