//! The inner list: the pairs that act on each other now or may do so within the next steps, and the contact histories
//! of the touching ones.
//!
//! It is made from the pairs of the neighbour list, and is valid for some steps: as long as no two particles can have
//! approached each other by more than its margin. The law is evaluated at every step for **active** pairs, which are
//! within the range of contacts. For the other pairs, the **candidates**, only the distance is computed, and the
//! attraction if there is any; a candidate that comes within the range of contacts is promoted. The result does not
//! depend on which pairs beyond the interaction range the list holds. All ranks nevertheless choose the same margin, so
//! that they rebuild their lists at the same steps; otherwise all ranks would wait at each step at which one of them
//! rebuilds.
//!
//! Pairs are held apart by their two species, so that one law holds for all pairs of a block. Pairs with a particle of
//! another rank are also held apart, so that all others can be evaluated while the motion of such particles is being
//! sent.

use super::contact_state::{ContactHistory, ContactState};
use super::pair_blocks::Pair;
use super::pair_kind::kind_of_bodies;
use super::pairs_of_kind::PairsOfKind;
use super::proximity::{FourPairs, SetBits, is_close};
use super::{Body, Particles};
use crate::numbers::{F64x4, vectorised};

/// Interaction ranges: separations of surfaces up to which pairs act on each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct InteractionRanges {
    /// Range of contacts.
    pub(crate) contact: f64,
    /// Range of any force, whether contact or attraction.
    pub(crate) any: f64,
    /// Largest diameter of a particle, the unit of margins.
    pub(crate) diameter: f64,
}

/// Rows of the neighbour list: row i holds the partners `partners[start[i]..start[i + 1]]`, owned particles before
/// ghosts.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    pub(super) start: &'a [u32],
    pub(super) partners: &'a [u32],
}

/// A group of pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PairGroup {
    /// Pairs of two owned particles, also through a periodic face.
    Own,
    /// Pairs with a particle of another rank.
    Shared,
}

impl PairGroup {
    /// Both groups.
    pub(crate) const ALL: [Self; 2] = [Self::Own, Self::Shared];

    /// The group of a pair of an owned particle with a second one.
    fn of(particles: &Particles, second: u32) -> Self {
        match particles.owned_original(second as usize) {
            Some(_) => Self::Own,
            None => Self::Shared,
        }
    }
}

/// The inner list.
#[derive(Clone, Debug)]
pub(crate) struct InnerList {
    /// The pairs of each group, by kind; a bed of one species has one kind.
    groups: [Vec<PairsOfKind>; 2],
    /// Radius and mass, if they are the same for all particles.
    pub(crate) one_size: Option<[f64; 2]>,
    /// Separation of surfaces up to which contacts act, slightly enlarged: a pair below it is to be promoted.
    pub(crate) contact_range: f64,
    /// Slots of the neighbour list whose pairs are active, one bit each.
    active_slots: Vec<u64>,
    validity: Validity,
}

impl Default for InnerList {
    fn default() -> Self {
        Self {
            groups: PairGroup::ALL.map(|_| vec![PairsOfKind::default()]),
            one_size: None,
            contact_range: 0.0,
            active_slots: Vec::new(),
            validity: Validity::default(),
        }
    }
}

/// The period for which the list is valid.
#[derive(Clone, Debug, Default)]
struct Validity {
    /// Separation beyond the range of forces up to which the list holds pairs; zero if it was never made.
    margin: f64,
    /// The ranges for which the list was made.
    ranges: InteractionRanges,
    /// Largest possible displacement of a particle since the list was made.
    displacement: f64,
    /// Number of evaluations since the list was made; zero if the neighbour list is new.
    age: u32,
    /// The largest numbers of pairs on any rank.
    pairs: PairCounts,
}

/// Numbers of pairs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PairCounts {
    /// Pairs of the neighbour list.
    pub(crate) listed: f64,
    /// Candidates per length of the margin, at least one.
    pub(crate) candidates: f64,
}

/// Cost of a listed pair when the list is made, including the marking and keeping of active pairs, relative to the cost
/// of a candidate at a step. Measured on one rank, for beds that are vibrated, bubble, have waves, are at rest, or are
/// dilute: 3 exceeds the least cost by at most 2 % for all of them, 1 exceeds it by 3 % for one of them.
const COST_RATIO: f64 = 3.0;

/// Smallest and largest margin, in diameters. Wider lists hardly last longer than the neighbour list.
const MARGINS: [f64; 2] = [1.0e-5, 0.2];

/// The first margin, in diameters, when no displacement is known yet.
const FIRST_MARGIN: f64 = 0.005;

/// Increment of the range of contacts, in diameters, since distances are rounded.
const ALLOWANCE: f64 = 1.0e-9;

impl Validity {
    /// Whether the list is certain to hold every pair within the ranges.
    fn covers(&self, ranges: InteractionRanges) -> bool {
        self.age > 0 && ranges == self.ranges && 2.0 * self.displacement < 0.999 * self.margin
    }

    /// Makes the list valid again, with a new margin. With s the displacement in a step, a list of margin m is valid
    /// for m / 2s steps. The cost of making it from L listed pairs and of its n m candidates, 2 s a L / m + b n m, is
    /// least for m^2 = 2 s (a / b) L / n.
    fn renew(&mut self, ranges: InteractionRanges) {
        let PairCounts { listed, candidates } = self.pairs;
        if self.age > 0 && candidates > 0.0 {
            let step = self.displacement / f64::from(self.age);
            let margin = (2.0 * step * COST_RATIO * listed / candidates).sqrt();
            self.margin = margin.clamp(MARGINS[0] * ranges.diameter, MARGINS[1] * ranges.diameter);
        } else if self.margin == 0.0 {
            self.margin = FIRST_MARGIN * ranges.diameter;
        }
        (self.ranges, self.displacement, self.age) = (ranges, 0.0, 0);
    }
}

impl InnerList {
    /// Number of candidates of this rank, at least one, per length of the margin; zero before there is a list.
    pub(super) fn candidates_per_length(&self) -> f64 {
        let Validity { margin, ranges, .. } = self.validity;
        let reach = ranges.any - ranges.contact + margin;
        let candidates: usize = self.all().map(|pairs| pairs.separated().len()).sum();
        if reach > 0.0 { candidates.max(1) as f64 / reach } else { 0.0 }
    }

    /// Adds an upper bound of the displacements of all particles since the last call; the numbers of pairs are the
    /// largest on any rank.
    pub(super) fn moved(&mut self, displacement: f64, pairs: PairCounts) {
        self.validity.displacement += displacement;
        self.validity.pairs = pairs;
    }

    /// Removes all pairs, for a new neighbour list of particles of these species.
    pub(super) fn clear(&mut self, particles: &Particles) {
        let count = particles.kinds_of_pairs();
        for kinds in &mut self.groups {
            kinds.resize_with(count, PairsOfKind::default);
            kinds.iter_mut().for_each(PairsOfKind::clear);
        }
        self.validity.age = 0;
    }

    /// The pairs of a group, by kind.
    pub(crate) fn kinds_mut(&mut self, group: PairGroup) -> &mut [PairsOfKind] {
        &mut self.groups[group as usize]
    }

    /// All pairs.
    fn all(&self) -> impl Iterator<Item = &PairsOfKind> + '_ {
        self.groups.iter().flatten()
    }

    /// Adds a touching pair with the state of its contact.
    pub(super) fn restore(&mut self, particles: &Particles, pair: Pair, state: ContactState) {
        let [first, second, _] = pair;
        let bodies = [first, second].map(|index| &particles.body[index as usize]);
        let group = PairGroup::of(particles, second);
        self.kinds_mut(group)[kind_of_bodies(bodies)].restore(pair, state);
    }

    /// Rebuilds the list if it may lack a pair of the neighbour list that is within the range of any force. Candidates
    /// may have come within the range of contacts since it was made; see [`InnerList::find_promotions`].
    pub(super) fn update(&mut self, particles: &Particles, rows: Rows, ranges: InteractionRanges) {
        if !self.validity.covers(ranges) {
            if self.validity.age == 0 {
                self.one_size = particles.one_size();
            }
            self.validity.renew(ranges);
            self.contact_range = ranges.contact + ALLOWANCE * ranges.diameter;
            self.make(particles, rows);
        }
        self.validity.age += 1;
    }

    /// Finds the candidates of a group that have come within the range of contacts.
    pub(crate) fn find_promotions(&mut self, particles: &Particles, group: PairGroup) {
        let is_new = self.validity.age == 1; // then no candidate is within the range of contacts
        let contact_range = self.contact_range;
        for pairs in self.kinds_mut(group) {
            pairs.find_promotions(particles, contact_range, is_new);
        }
    }

    /// Makes active the candidates of a group that have been found.
    pub(crate) fn promote(&mut self, group: PairGroup) {
        self.kinds_mut(group).iter_mut().for_each(PairsOfKind::promote);
    }

    /// The touching pairs, as first and second particle, and the states of their contacts.
    pub(super) fn touching(&self) -> impl Iterator<Item = ([u32; 2], ContactState)> + '_ {
        self.all().flat_map(|pairs| pairs.active.touching())
    }

    /// First and second particle of the touching pairs.
    pub(super) fn touching_indices(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.all().flat_map(|pairs| pairs.active.touching_indices())
    }

    /// First and second particle of the active pairs.
    pub(super) fn active_indices(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.all().flat_map(|pairs| pairs.active.pairs())
    }

    /// All pairs; active ones with the histories of the touching ones.
    pub(super) fn with_histories(
        &self,
    ) -> impl Iterator<Item = ([u32; 2], Option<ContactHistory>)> + '_ {
        self.all().flat_map(|pairs| {
            let separated = pairs.separated().iter().map(|&[one, other, _]| ([one, other], None));
            pairs.active.with_histories().chain(separated)
        })
    }

    /// The active pairs of a group with the number of their kind; touching ones with the state of their contact.
    pub(crate) fn active_pairs(
        &self,
        group: PairGroup,
    ) -> impl Iterator<Item = (usize, [u32; 2], Option<ContactState>)> + '_ {
        self.groups[group as usize].iter().enumerate().flat_map(|(kind, pairs)| {
            pairs.active.all().map(move |(pair, state)| (kind, pair, state))
        })
    }

    fn make(&mut self, particles: &Particles, rows: Rows) {
        let (bodies, contact_range) = (&particles.body[..], self.contact_range);
        let bodies_of = |pair: [u32; 2]| pair.map(|index| &bodies[index as usize]);
        let is_within = |pair: [u32; 2], range: f64| is_close(bodies_of(pair), range);
        for pairs in self.groups.iter_mut().flatten() {
            pairs.retain(|pair| is_within(pair, contact_range));
        }
        let active = self.groups.iter().flatten().flat_map(|pairs| pairs.active.pairs());
        mark(&mut self.active_slots, rows, active);
        let Self { groups, active_slots, validity, .. } = self;
        let (owned, one_species) = (particles.owned_count() as u32, groups[0].len() == 1);
        let add = |row: u32, partners: &[u32], bits: u32, is_active: bool| {
            let are_owned = partners.last().is_some_and(|&last| last < owned);
            if one_species && are_owned && !is_active {
                groups[PairGroup::Own as usize][0].add_candidates(row, partners, bits);
                return;
            }
            for bit in SetBits(bits) {
                let pair = [row, partners[bit]];
                let group = PairGroup::of(particles, pair[1]);
                let kind = if one_species { 0 } else { kind_of_bodies(bodies_of(pair)) };
                groups[group as usize][kind].add(pair_of(particles, pair), is_active);
            }
        };
        let separations = [validity.ranges.any + validity.margin, contact_range];
        find_close_pairs(bodies, rows, active_slots, separations, add);
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

/// A pair, with the particle to which the force on the second is added.
pub(super) fn pair_of(particles: &Particles, [first, second]: [u32; 2]) -> Pair {
    let original = particles.owned_original(second as usize);
    [first, second, original.map_or(second, |index| index as u32)]
}

vectorised!(
    /// Calls `add` with each particle, up to four of its partners, the bits of the partners to be added, and whether
    /// these are closer than the second separation, or only closer than the first. Active pairs are left out.
    fn find_close_pairs<Q: F64x4>(
        bodies: &[Body],
        rows: Rows,
        active_slots: &[u64],
        separations: [f64; 2],
        add: impl FnMut(u32, &[u32], u32, bool),
    ) {
        let (separations, mut add) = (separations.map(Q::splat), add);
        for (row, ends) in rows.start.windows(2).enumerate() {
            let body = &bodies[row];
            let [start, end] = [ends[0] as usize, ends[1] as usize];
            for from in (start..end).step_by(4) {
                let partners = &rows.partners[from..end.min(from + 4)];
                let pairs = FourPairs::of_partners(body, partners, bodies);
                let inactive = !four_bits(active_slots, from);
                let [close, closer] =
                    separations.map(|separation| pairs.closer_than(separation) & inactive);
                add(row as u32, partners, close & !closer, false);
                if closer != 0 {
                    add(row as u32, partners, closer, true);
                }
            }
        }
    }
);

/// Four consecutive bits, the first of which has this number; those beyond the last word are zero.
#[inline(always)]
fn four_bits(words: &[u64], from: usize) -> u32 {
    let (word, bit) = (from / 64, from % 64);
    let next = words.get(word + 1).map_or(0, |next| next << 1 << (63 - bit));
    (words[word] >> bit | next) as u32 & 15
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_bits_are_found_across_words() {
        let words = [0x8000_0000_0000_0000, 0b101];
        let found = [0, 60, 61, 63, 64, 66, 100].map(|from| four_bits(&words, from));
        assert_eq!(found, [0, 8, 12, 11, 5, 1, 0]);
    }

    const RANGES: InteractionRanges = InteractionRanges { contact: 0.0, any: 0.0, diameter: 1.0 };

    /// The margin after ten steps of a displacement, on a rank with `own` listed pairs; `largest` are those of all
    /// ranks.
    fn margin_of_rank(own: usize, largest: PairCounts, displacement: f64) -> f64 {
        let mut list = InnerList::default();
        let particles = Particles::default();
        let partners = vec![0; own];
        let rows = Rows { start: &[0], partners: &partners };
        list.update(&particles, rows, RANGES);
        assert_eq!(list.validity.margin, FIRST_MARGIN);
        (0..10).for_each(|_| list.moved(displacement, largest));
        list.validity.age = 10;
        list.update(&particles, rows, RANGES);
        list.validity.margin
    }

    #[test]
    fn ranks_with_few_and_with_many_pairs_choose_one_margin() {
        let largest = PairCounts { listed: 3000.0, candidates: 5.0e5 };
        let margins = [10, 3000].map(|own| margin_of_rank(own, largest, 1.0e-3));
        assert_eq!(margins[0], margins[1]);
        // The square root of 2 s 3 L / n for s = 1e-3.
        assert!((margins[0] - 6.0e-3).abs() < 1.0e-15, "{margins:?}");
        // Control: the margin does depend on the displacement.
        assert!(margin_of_rank(10, largest, 4.0e-3) > 1.9 * margins[0]);
    }
}
