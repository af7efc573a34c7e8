//! The pairs within reach of each other's force, those that soon may be, and what the touching ones remember.
//!
//! They are found among the pairs of the neighbour list, and hold for some steps: as long as no two particles can
//! have come nearer to each other by the margin. The contacts of pairs that act are evaluated at every step; the others
//! wait: only their distance is looked at, and their attraction, if there is any. Which pairs beyond reach are among
//! either changes no result, so every rank may choose its own margin and its own time to find them anew.

use super::closeness::{Places, branch, is_near, near_branches, near_partners};
use super::pair_blocks::{PairBlocks, Remembered};
use super::{Body, Pair, Particles};
use crate::numbers::{F64x4, SimdKernel, with_simd};

/// Separations of surfaces up to which pairs act on each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ranges {
    /// By their contact.
    pub contact: f64,
    /// At all: by contact or attraction.
    pub any: f64,
}

/// Rows of the neighbour list: row i holds the partners `partners[start[i]..start[i + 1]]`.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    pub(super) start: &'a [u32],
    pub(super) partners: &'a [u32],
}

/// Near pairs.
#[derive(Clone, Debug, Default)]
pub struct NearPairs {
    /// Those within reach of a contact, or that were when they were last looked through; row by row, but for those that
    /// have joined since.
    pub acting: PairBlocks,
    /// Radius and mass, if all particles have the same.
    pub one_size: Option<[f64; 2]>,
    /// Those that are not. They may attract each other.
    waiting: Vec<Pair>,
    /// Separation of surfaces up to which contacts act, and a little more.
    reach: f64,
    /// Of the waiting ones, which have come within reach of a contact.
    arrived: Vec<u32>,
    /// Slots of the list whose pairs act, bit by bit.
    taken: Vec<u64>,
    validity: Validity,
}

/// Pairs that wait.
pub(crate) struct Waiting<'a> {
    pub(crate) pairs: &'a [Pair],
    /// Separation of surfaces below which a contact reaches them.
    pub(crate) reach: f64,
    /// To be filled, in rising order: places of pairs that are within reach.
    pub(crate) arrived: &'a mut Vec<u32>,
}

/// How long the pairs hold.
#[derive(Clone, Debug, Default)]
struct Validity {
    /// Separation that pairs may have beyond the range of forces; zero if there are none yet.
    margin: f64,
    /// The ranges they were found for.
    ranges: Ranges,
    /// How far a particle may have moved since.
    displacement: f64,
    /// Evaluations since; none if the list is a new one.
    age: u32,
}

/// Cost of finding the pairs of a particle, over the cost of looking at the pairs that a margin of one diameter
/// would add.
const COST_RATIO: f64 = 0.04;

/// The margin of a list of which nothing is known, in diameters.
const FIRST_MARGIN: f64 = 0.005;

/// Pairs act from a little before they can feel each other: distances are rounded. In diameters.
const ALLOWANCE: f64 = 1.0e-9;

impl Validity {
    /// Whether every pair within the ranges is in the list.
    fn holds(&self, ranges: Ranges) -> bool {
        self.age > 0 && ranges == self.ranges && 2.0 * self.displacement < 0.999 * self.margin
    }

    /// With s the way of a step, a margin m lasts m / 2s steps: 2 s a / m + b m is least for m^2 = 2 s a / b.
    fn renew(&mut self, diameter: f64, ranges: Ranges) {
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

impl NearPairs {
    /// Takes note that no particle has moved farther than this since the last time.
    pub(super) fn moved(&mut self, displacement: f64) {
        self.validity.displacement += displacement;
    }

    /// Begins with a new list, of which no pair remembers anything.
    pub(super) fn forget(&mut self) {
        self.acting.clear();
        self.waiting.clear();
        self.validity.age = 0;
    }

    /// Gives a pair of the new list its memory back.
    pub(super) fn recall(&mut self, pair: Pair, remembered: Remembered) {
        self.acting.push(pair, Some(remembered));
    }

    /// Makes sure that all pairs of the list whose surfaces are closer than the range of any force act or wait. Of those
    /// that wait some may have come within reach of a contact: [`NearPairs::look_for_arrivals`].
    pub(super) fn update(&mut self, particles: &Particles, rows: Rows, ranges: Ranges) {
        if !self.validity.holds(ranges) {
            let diameter = particles.body.first().map_or(1.0, |body| 2.0 * body.radius);
            if self.validity.age == 0 {
                self.one_size = particles.one_size();
            }
            self.validity.renew(diameter, ranges);
            self.reach = ranges.contact + ALLOWANCE * diameter;
            self.find(particles, rows);
        }
        self.validity.age += 1;
    }

    /// The pairs that wait, among them all that attract each other without touching.
    pub(crate) fn waiting(&mut self) -> Waiting<'_> {
        self.arrived.clear();
        let Self { waiting, reach, arrived, .. } = self;
        Waiting { pairs: waiting, reach: *reach, arrived }
    }

    /// Finds the waiting pairs that have come within reach of a contact.
    pub(crate) fn look_for_arrivals(&mut self, particles: &Particles) {
        let just_found = self.validity.age == 1; // then those within reach do not wait
        let waiting = self.waiting();
        if !just_found {
            with_simd(Arrivals { bodies: &particles.body, waiting });
        }
    }

    /// Waiting pairs that were found to have come within reach act from now on.
    pub(crate) fn let_in(&mut self) {
        let Self { acting, waiting, arrived, .. } = self;
        for &place in &*arrived {
            acting.push(waiting[place as usize], None);
        }
        // From the back, so that those still to be removed stay where they are.
        for &place in arrived.iter().rev() {
            waiting.swap_remove(place as usize);
        }
    }

    fn find(&mut self, particles: &Particles, rows: Rows) {
        let (bodies, reach) = (&particles.body[..], self.reach);
        let is_within = |[one, other]: [u32; 2], reach: f64| {
            is_near([one, other].map(|index| &bodies[index as usize]), reach)
        };
        self.acting.retain(|pair| is_within(pair, reach));
        mark(&mut self.taken, rows, self.acting.pairs());
        self.waiting.clear();
        let Self { acting, waiting, taken, validity, .. } = self;
        let take = |slot: usize, pair: [u32; 2]| {
            if taken[slot / 64] >> (slot % 64) & 1 == 1 {
            } else if is_within(pair, reach) {
                acting.push(pair_of(particles, pair), None);
            } else {
                waiting.push(pair_of(particles, pair));
            }
        };
        let margin = validity.ranges.any + validity.margin;
        with_simd(Candidates { bodies, rows, margin, take });
    }
}

/// Sets the bits of the slots in which these pairs are.
fn mark(bits: &mut Vec<u64>, rows: Rows, pairs: impl Iterator<Item = [u32; 2]>) {
    bits.clear();
    bits.resize(rows.partners.len().div_ceil(64), 0);
    for [first, second] in pairs {
        let [begin, end] = [0, 1].map(|next| rows.start[first as usize + next] as usize);
        let place = rows.partners[begin..end].iter().position(|&partner| partner == second);
        let slot = begin + place.expect("pairs that act are in the list");
        bits[slot / 64] |= 1 << (slot % 64);
    }
}

/// A pair, with who feels the force on the partner.
pub(super) fn pair_of(particles: &Particles, [first, second]: [u32; 2]) -> Pair {
    let original = particles.owned_original(second as usize);
    [first, second, original.map_or(second, |index| index as u32)]
}

/// Which waiting pairs have come within reach.
struct Arrivals<'a> {
    bodies: &'a [Body],
    waiting: Waiting<'a>,
}

impl SimdKernel for Arrivals<'_> {
    type Output = ();

    #[inline(always)]
    fn run<Q: F64x4>(self) {
        let Self { bodies, waiting: Waiting { pairs, reach, arrived } } = self;
        let reach = Q::splat(reach);
        for (four, pairs) in pairs.chunks(4).enumerate() {
            let mut branches = [Q::splat(0.0); 4];
            for (place, of_pair) in branches.iter_mut().enumerate() {
                let [one, other, _] = pairs[place.min(pairs.len() - 1)];
                *of_pair = branch(&bodies[one as usize], &bodies[other as usize]);
            }
            let near = near_branches(branches, reach) & ((1 << pairs.len()) - 1);
            arrived.extend(Places(near).map(|place| (4 * four + place) as u32));
        }
    }
}

/// Calls `take` with the slot and the pair of every pair of the list that is closer than the margin.
struct Candidates<'a, F> {
    bodies: &'a [Body],
    rows: Rows<'a>,
    margin: f64,
    take: F,
}

impl<F: FnMut(usize, [u32; 2])> SimdKernel for Candidates<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<Q: F64x4>(mut self) {
        let margin = Q::splat(self.margin);
        for (row, ends) in self.rows.start.windows(2).enumerate() {
            let body = &self.bodies[row];
            let [begin, end] = [ends[0] as usize, ends[1] as usize];
            for from in (begin..end).step_by(4) {
                let partners = &self.rows.partners[from..end.min(from + 4)];
                for place in Places(near_partners(body, partners, self.bodies, margin)) {
                    (self.take)(from + place, [row as u32, partners[place]]);
                }
            }
        }
    }
}
