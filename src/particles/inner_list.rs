//! The inner list: the pairs that act on each other now or may do so within the next steps, and the contact histories of
//! those that touch.
//!
//! It is made from the pairs of the neighbour list, and is valid for some steps: as long as no two particles can have
//! approached each other by more than its margin. The law is evaluated on **active** pairs, those within the range of
//! contacts, at every step. Of the others, the **candidates**, only the distance is computed, and the attraction if there
//! is any; a candidate that comes within the range of contacts is promoted. Which pairs beyond the interaction range the
//! list holds changes no result, so every rank may choose its own margin and its own time to make the list anew.

use super::pair_blocks::{OrientedHistory, PairBlocks};
use super::proximity::{SetBits, branch_vector, close_pairs, close_partners, is_close};
use super::{Body, Pair, Particles};
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
#[derive(Clone, Debug, Default)]
pub(crate) struct InnerList {
    /// Pairs that are within the range of contacts, or were when the list was made; in the order of the neighbour list,
    /// those that have been promoted since behind.
    pub(crate) active: PairBlocks,
    /// Radius and mass, if all particles have the same.
    pub(crate) one_size: Option<[f64; 2]>,
    /// The other pairs. They may attract each other.
    candidates: Vec<Pair>,
    /// Separation of surfaces up to which contacts act, and a little more.
    contact_range: f64,
    /// Numbers of the candidates that have come within the range of contacts.
    to_promote: Vec<u32>,
    /// Slots of the neighbour list whose pairs are active, bit by bit.
    active_slots: Vec<u64>,
    validity: Validity,
}

/// The candidates, for a loop that looks for those to promote.
pub(crate) struct Candidates<'a> {
    pub(crate) pairs: &'a [Pair],
    /// Separation of surfaces below which a pair is to be promoted.
    pub(crate) contact_range: f64,
    /// To be filled, in rising order: the numbers of the pairs to promote.
    pub(crate) to_promote: &'a mut Vec<u32>,
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

/// Cost of searching the pairs of a particle, over the cost of the pairs that a margin of one diameter would add.
const COST_RATIO: f64 = 0.04;

/// The first margin, in diameters, before any displacement is known.
const FIRST_MARGIN: f64 = 0.005;

/// Addition to the range of contacts, since distances are rounded, in diameters.
const ALLOWANCE: f64 = 1.0e-9;

impl Validity {
    /// Whether the list is certain to hold every pair within the ranges.
    fn covers(&self, ranges: InteractionRanges) -> bool {
        self.age > 0 && ranges == self.ranges && 2.0 * self.displacement < 0.999 * self.margin
    }

    /// With s the displacement in a step, a list of margin m is valid for m / 2s steps. The cost 2 s a / m + b m is
    /// least for m^2 = 2 s a / b.
    fn renew(&mut self, diameter: f64, ranges: InteractionRanges) {
        if self.age > 0 {
            let margin =
                (2.0 * COST_RATIO * diameter * self.displacement / f64::from(self.age)).sqrt();
            self.margin = margin.clamp(1.0e-5 * diameter, 0.05 * diameter);
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

    /// Removes all pairs, for a new neighbour list.
    pub(super) fn clear(&mut self) {
        self.active.clear();
        self.candidates.clear();
        self.validity.age = 0;
    }

    /// Adds a touching pair with its history.
    pub(super) fn restore(&mut self, pair: Pair, history: OrientedHistory) {
        self.active.push(pair, Some(history));
    }

    /// Makes the list anew if it may lack a pair of the neighbour list that is within the range of any force. Candidates
    /// may have come within the range of contacts since it was made: [`InnerList::find_promotions`].
    pub(super) fn update(&mut self, particles: &Particles, rows: Rows, ranges: InteractionRanges) {
        if !self.validity.covers(ranges) {
            let diameter = particles.body.first().map_or(1.0, |body| 2.0 * body.radius);
            if self.validity.age == 0 {
                self.one_size = particles.one_size();
            }
            self.validity.renew(diameter, ranges);
            self.contact_range = ranges.contact + ALLOWANCE * diameter;
            self.make(particles, rows);
        }
        self.validity.age += 1;
    }

    /// The candidates, among them all pairs that attract each other without contact.
    pub(crate) fn candidates(&mut self) -> Candidates<'_> {
        self.to_promote.clear();
        let Self { candidates, contact_range, to_promote, .. } = self;
        Candidates { pairs: candidates, contact_range: *contact_range, to_promote }
    }

    /// The same pairs, to be read.
    pub(super) fn separated(&self) -> &[Pair] {
        &self.candidates
    }

    /// Finds the candidates that have come within the range of contacts.
    pub(crate) fn find_promotions(&mut self, particles: &Particles) {
        let is_new = self.validity.age == 1; // then no candidate is within the range of contacts
        let candidates = self.candidates();
        if !is_new {
            with_simd(PromotionSearch { bodies: &particles.body, candidates });
        }
    }

    /// Makes the candidates that were found active.
    pub(crate) fn promote(&mut self) {
        let Self { active, candidates, to_promote, .. } = self;
        for &number in &*to_promote {
            active.push(candidates[number as usize], None);
        }
        // From the back, so that those still to be removed keep their numbers.
        for &number in to_promote.iter().rev() {
            candidates.swap_remove(number as usize);
        }
    }

    fn make(&mut self, particles: &Particles, rows: Rows) {
        let (bodies, contact_range) = (&particles.body[..], self.contact_range);
        let is_within = |[one, other]: [u32; 2], range: f64| {
            is_close([one, other].map(|index| &bodies[index as usize]), range)
        };
        self.active.retain(|pair| is_within(pair, contact_range));
        mark(&mut self.active_slots, rows, self.active.pairs());
        self.candidates.clear();
        let Self { active, candidates, active_slots, validity, .. } = self;
        let add = |slot: usize, pair: [u32; 2]| {
            if active_slots[slot / 64] >> (slot % 64) & 1 == 1 {
            } else if is_within(pair, contact_range) {
                active.push(pair_of(particles, pair), None);
            } else {
                candidates.push(pair_of(particles, pair));
            }
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

/// Finds the candidates that have come within the range of contacts.
struct PromotionSearch<'a> {
    bodies: &'a [Body],
    candidates: Candidates<'a>,
}

impl SimdKernel for PromotionSearch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<Q: F64x4>(self) {
        let Self { bodies, candidates: Candidates { pairs, contact_range, to_promote } } = self;
        let contact_range = Q::splat(contact_range);
        for (four, pairs) in pairs.chunks(4).enumerate() {
            let mut branch_vectors = [Q::splat(0.0); 4];
            for (k, of_pair) in branch_vectors.iter_mut().enumerate() {
                let [one, other, _] = pairs[k.min(pairs.len() - 1)];
                *of_pair = branch_vector(&bodies[one as usize], &bodies[other as usize]);
            }
            let close = close_pairs(branch_vectors, contact_range) & ((1 << pairs.len()) - 1);
            to_promote.extend(SetBits(close).map(|bit| (4 * four + bit) as u32));
        }
    }
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
