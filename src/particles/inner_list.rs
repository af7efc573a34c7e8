//! The inner list: the pairs that act on each other now or may do so within the next steps, and the contact histories of
//! those that touch.
//!
//! It is made from the pairs of the neighbour list, and is valid for some steps: as long as no two particles can have
//! approached each other by more than its margin. The law is evaluated on **active** pairs, those within the range of
//! contacts, at every step. Of the others, the **candidates**, only the distance is computed, and the attraction if there
//! is any; a candidate that comes within the range of contacts is promoted. Which pairs beyond the interaction range the
//! list holds changes no result, so every rank may choose its own margin and its own time to make the list anew.
//!
//! The pairs of each two species are held apart, so that one law holds for all pairs of a block.

use super::contact_history::ContactHistory;
use super::pair_blocks::{OrientedHistory, Pair, Remembered};
use super::pair_kind::kind_of_bodies;
use super::pairs_of_kind::PairsOfKind;
use super::proximity::{SetBits, close_partners, is_close};
use super::{Body, Particles};
use crate::numbers::{F64x4, SimdKernel, with_simd};

/// Interaction ranges: separations of surfaces up to which pairs act on each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct InteractionRanges {
    /// Range of contacts.
    pub(crate) contact: f64,
    /// Range of any force, of contact or attraction.
    pub(crate) any: f64,
}

/// Rows of the neighbour list: row i holds the partners `partners[start[i]..start[i + 1]]`.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    pub(super) start: &'a [u32],
    pub(super) partners: &'a [u32],
}

/// The inner list.
#[derive(Clone, Debug)]
pub(crate) struct InnerList {
    /// The pairs by their kinds; a bed of one species has one kind.
    pub(crate) kinds: Vec<PairsOfKind>,
    /// Radius and mass, if all particles have the same.
    pub(crate) one_size: Option<[f64; 2]>,
    /// Separation of surfaces up to which contacts act, and a little more: a pair below it is to be promoted.
    pub(crate) contact_range: f64,
    /// Slots of the neighbour list whose pairs are active, bit by bit.
    active_slots: Vec<u64>,
    validity: Validity,
}

impl Default for InnerList {
    fn default() -> Self {
        Self {
            kinds: vec![PairsOfKind::default()],
            one_size: None,
            contact_range: 0.0,
            active_slots: Vec::new(),
            validity: Validity::default(),
        }
    }
}

/// How long the list is valid.
#[derive(Clone, Debug, Default)]
struct Validity {
    /// Separation beyond the range of forces up to which the list holds pairs; zero if it was never made.
    margin: f64,
    /// The ranges that the list was made for.
    ranges: InteractionRanges,
    /// Largest possible displacement of a particle since.
    displacement: f64,
    /// Evaluations since; zero if the neighbour list is new.
    age: u32,
}

/// Cost of a listed pair when the list is made, in which active pairs are marked and kept too, over the cost of a candidate at a
/// step. Measured on one rank, for beds that are vibrated, bubble, have waves, are at rest, or are dilute: 3 costs no
/// bed more than 2 % over its best, 1 costs one of them 3 %.
const COST_RATIO: f64 = 3.0;

/// Least and largest margin, in diameters. Wider lists hardly last longer than the neighbour list.
const MARGINS: [f64; 2] = [1.0e-5, 0.2];

/// The first margin, in diameters, before any displacement is known.
const FIRST_MARGIN: f64 = 0.005;

/// Addition to the range of contacts, since distances are rounded, in diameters.
const ALLOWANCE: f64 = 1.0e-9;

/// What the margin is chosen by.
#[derive(Clone, Copy)]
struct PairCounts {
    /// Pairs of the neighbour list.
    listed: usize,
    /// Candidates of the last inner list.
    candidates: usize,
}

impl Validity {
    /// Whether the list is certain to hold every pair within the ranges.
    fn covers(&self, ranges: InteractionRanges) -> bool {
        self.age > 0 && ranges == self.ranges && 2.0 * self.displacement < 0.999 * self.margin
    }

    /// With s the displacement in a step, a list of margin m is valid for m / 2s steps. The cost of making it from L listed
    /// pairs and of its n m candidates, 2 s a L / m + b n m, is least for m^2 = 2 s (a / b) L / n.
    fn renew(&mut self, diameter: f64, ranges: InteractionRanges, pairs: PairCounts) {
        if self.age > 0 {
            let step = self.displacement / f64::from(self.age);
            let reach = self.ranges.any - self.ranges.contact + self.margin;
            let per_length = pairs.candidates.max(1) as f64 / reach;
            let margin = (2.0 * step * COST_RATIO * pairs.listed as f64 / per_length).sqrt();
            self.margin = margin.clamp(MARGINS[0] * diameter, MARGINS[1] * diameter);
        } else if self.margin == 0.0 {
            self.margin = FIRST_MARGIN * diameter;
        }
        (self.ranges, self.displacement, self.age) = (ranges, 0.0, 0);
    }
}

impl InnerList {
    /// Adds a bound of the displacements of all particles since the last call.
    pub(super) fn moved(&mut self, displacement: f64) {
        self.validity.displacement += displacement;
    }

    /// Removes all pairs, for a new neighbour list of particles of these species.
    pub(super) fn clear(&mut self, particles: &Particles) {
        let kinds = particles.kinds_of_pairs();
        self.kinds.resize_with(kinds, PairsOfKind::default);
        self.kinds.iter_mut().for_each(PairsOfKind::clear);
        self.validity.age = 0;
    }

    /// Adds a touching pair with its history.
    pub(super) fn restore(&mut self, particles: &Particles, pair: Pair, history: OrientedHistory) {
        let [first, second, _] = pair;
        let bodies = [first, second].map(|index| &particles.body[index as usize]);
        self.kinds[kind_of_bodies(bodies)].restore(pair, history);
    }

    /// Makes the list anew if it may lack a pair of the neighbour list that is within the range of any force. Candidates
    /// may have come within the range of contacts since it was made: [`InnerList::find_promotions`].
    pub(super) fn update(&mut self, particles: &Particles, rows: Rows, ranges: InteractionRanges) {
        if !self.validity.covers(ranges) {
            let diameter = particles.body.first().map_or(1.0, |body| 2.0 * body.radius);
            if self.validity.age == 0 {
                self.one_size = particles.one_size();
            }
            let candidates = self.kinds.iter().map(|pairs| pairs.separated().len()).sum();
            let pairs = PairCounts { listed: rows.partners.len(), candidates };
            self.validity.renew(diameter, ranges, pairs);
            self.contact_range = ranges.contact + ALLOWANCE * diameter;
            self.make(particles, rows);
        }
        self.validity.age += 1;
    }

    /// Finds the candidates that have come within the range of contacts.
    pub(crate) fn find_promotions(&mut self, particles: &Particles) {
        let is_new = self.validity.age == 1; // then no candidate is within the range of contacts
        for pairs in &mut self.kinds {
            pairs.find_promotions(particles, self.contact_range, is_new);
        }
    }

    /// Makes the candidates that were found active.
    pub(crate) fn promote(&mut self) {
        self.kinds.iter_mut().for_each(PairsOfKind::promote);
    }

    /// The touching pairs, first and second particle, and their histories.
    pub(super) fn touching(&self) -> impl Iterator<Item = ([u32; 2], OrientedHistory)> + '_ {
        self.kinds.iter().flat_map(|pairs| pairs.active.touching())
    }

    /// First and second particle of the touching pairs.
    pub(super) fn touching_indices(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.kinds.iter().flat_map(|pairs| pairs.active.touching_indices())
    }

    /// All pairs, active ones with the histories of those that touch.
    pub(super) fn with_histories(
        &self,
    ) -> impl Iterator<Item = ([u32; 2], Option<ContactHistory>)> + '_ {
        self.kinds.iter().flat_map(|pairs| {
            let separated = pairs.separated().iter().map(|&[one, other, _]| ([one, other], None));
            pairs.active.with_histories().chain(separated)
        })
    }

    /// The active pairs with the number of their kind, and what they remember.
    pub(crate) fn active_pairs(&self) -> impl Iterator<Item = (usize, [u32; 2], Remembered)> + '_ {
        self.kinds.iter().enumerate().flat_map(|(kind, pairs)| {
            pairs.active.all().map(move |(pair, remembered)| (kind, pair, remembered))
        })
    }

    fn make(&mut self, particles: &Particles, rows: Rows) {
        let (bodies, contact_range) = (&particles.body[..], self.contact_range);
        let bodies_of = |pair: [u32; 2]| pair.map(|index| &bodies[index as usize]);
        let is_within = |pair: [u32; 2], range: f64| is_close(bodies_of(pair), range);
        for pairs in &mut self.kinds {
            pairs.retain(|pair| is_within(pair, contact_range));
        }
        let active = self.kinds.iter().flat_map(|pairs| pairs.active.pairs());
        mark(&mut self.active_slots, rows, active);
        let Self { kinds, active_slots, validity, .. } = self;
        let several_species = kinds.len() > 1;
        let add = |slot: usize, pair: [u32; 2]| {
            if active_slots[slot / 64] >> (slot % 64) & 1 == 1 {
                return;
            }
            let kind = if several_species { kind_of_bodies(bodies_of(pair)) } else { 0 };
            kinds[kind].add(pair_of(particles, pair), is_within(pair, contact_range));
        };
        let separation = validity.ranges.any + validity.margin;
        with_simd(PairSearch { bodies, rows, separation, add });
    }
}

/// Sets the bits of the slots of these pairs.
fn mark(bits: &mut Vec<u64>, rows: Rows, pairs: impl Iterator<Item = [u32; 2]>) {
    bits.clear();
    bits.resize(rows.partners.len().div_ceil(64), 0);
    for [first, second] in pairs {
        let [start, end] = [0, 1].map(|next| rows.start[first as usize + next] as usize);
        let offset = rows.partners[start..end].iter().position(|&partner| partner == second);
        let slot = start + offset.expect("active pairs are in the neighbour list");
        bits[slot / 64] |= 1 << (slot % 64);
    }
}

/// A pair, with the particle that the force on the second is added to.
pub(super) fn pair_of(particles: &Particles, [first, second]: [u32; 2]) -> Pair {
    let original = particles.owned_original(second as usize);
    [first, second, original.map_or(second, |index| index as u32)]
}

/// Calls `add` with the slot and the particles of every pair of the neighbour list closer than a separation.
struct PairSearch<'a, F> {
    bodies: &'a [Body],
    rows: Rows<'a>,
    separation: f64,
    add: F,
}

impl<F: FnMut(usize, [u32; 2])> SimdKernel for PairSearch<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<Q: F64x4>(mut self) {
        let separation = Q::splat(self.separation);
        for (row, ends) in self.rows.start.windows(2).enumerate() {
            let body = &self.bodies[row];
            let [start, end] = [ends[0] as usize, ends[1] as usize];
            for from in (start..end).step_by(4) {
                let partners = &self.rows.partners[from..end.min(from + 4)];
                for k in SetBits(close_partners(body, partners, self.bodies, separation)) {
                    (self.add)(from + k, [row as u32, partners[k]]);
                }
            }
        }
    }
}
