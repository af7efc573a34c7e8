//! The pairs within reach of each other's force, or nearly so, and what the touching ones remember.
//!
//! They are found among the slots of the neighbour list, and hold for some steps: as long as no particle has
//! moved more than half the margin. Which pairs beyond reach are among them changes no result, so every rank
//! chooses its own margin and its own time to find them anew.

use super::displacement::{Reference, largest_move_squared, take_reference};
use super::{Body, ContactMemory, Particles};
use nalgebra::Vector3;

/// Pairs are kept, and evaluated, in blocks of this many. With fewer than about 16 the compiler unrolls the loop
/// over lanes before it has made vectors of them.
pub const LANES: usize = 32;

/// Numbers that a contact remembers.
pub const MEMORY_FIELDS: usize = size_of::<ContactMemory>() / size_of::<f64>();

/// What the pairs of one block remember, number by number.
pub type MemoryLanes = [[f64; LANES]; MEMORY_FIELDS];

/// Angles of rolling springs, axis by axis.
pub type AngleLanes = [[f64; LANES]; 3];

/// What the touching pair of a slot remembers, seen from the row's particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Remembered {
    pub(super) slot: u32,
    pub(super) memory: ContactMemory,
    /// Zero without a rolling spring.
    pub(super) rolling_angle: Vector3<f64>,
}

/// Near pairs in the order of their slots, by blocks. The last block is filled up with a pair that nobody reads.
#[derive(Clone, Debug, Default)]
pub struct NearPairs {
    /// Row particle of each pair.
    pub first: Vec<[u32; LANES]>,
    /// Its partner, an owned particle or a ghost.
    pub second: Vec<[u32; LANES]>,
    /// Who feels the force on the partner: the owned particle that it is an image of, or itself.
    pub target: Vec<[u32; LANES]>,
    /// Whether they touched when the force was last evaluated.
    pub touching: Vec<[bool; LANES]>,
    /// What they remember, seen from the first.
    pub memory: Vec<MemoryLanes>,
    /// Angles of rolling springs, seen from the first; of no pair without such springs.
    pub rolling_angle: Vec<AngleLanes>,
    /// Radius and mass, if all particles have the same.
    pub one_size: Option<[f64; 2]>,
    /// Whether there are rolling springs.
    rolling: bool,
    /// Slot of each pair.
    slot: Vec<u32>,
    validity: Validity,
}

/// How long the pairs hold.
#[derive(Clone, Debug, Default)]
struct Validity {
    /// Separation that pairs may have beyond the range of forces; zero if there are none yet.
    margin: f64,
    /// The range they were found for.
    range: f64,
    /// Where the bodies were.
    reference: Reference,
    /// Evaluations since.
    age: u32,
}

/// Cost of finding the pairs of a particle, over the cost of the pairs that a margin of one diameter would add.
const COST_RATIO: f64 = 0.15;

/// The margin of a list of which nothing is known, in diameters.
const FIRST_MARGIN: f64 = 0.005;

impl Validity {
    /// Whether every pair within `range` is in the list.
    fn holds(&self, bodies: &[Body], range: f64) -> bool {
        let limit = (0.499 * self.margin).powi(2);
        self.age > 0
            && range == self.range
            && self.reference.len() == bodies.len()
            && largest_move_squared(bodies, &self.reference) < limit
    }

    /// With s the way of a step, a margin m lasts m / 2s steps: 2 s a / m + b m is least for m^2 = 2 s a / b.
    fn renew(&mut self, bodies: &[Body], range: f64) {
        let diameter = bodies.first().map_or(1.0, |body| 2.0 * body.radius);
        if self.age > 0 && self.reference.len() == bodies.len() {
            let moved = largest_move_squared(bodies, &self.reference).sqrt();
            let margin = (2.0 * COST_RATIO * diameter * moved / f64::from(self.age)).sqrt();
            self.margin = margin.clamp(1.0e-5 * diameter, 0.05 * diameter);
        } else if self.margin == 0.0 {
            self.margin = FIRST_MARGIN * diameter;
        }
        self.range = range;
        take_reference(&mut self.reference, bodies);
        self.age = 0;
    }
}

impl NearPairs {
    /// Makes sure that all pairs of the list `rows` whose surfaces are closer than `range` are here. A touching pair
    /// that no longer is near has parted, and forgets.
    ///
    /// `carried` are memories that slots had before, in the order of slots; they are taken.
    pub(super) fn update(
        &mut self,
        particles: &Particles,
        (row_start, partners): (&[u32], &[u32]),
        range: f64,
        carried: &mut Vec<Remembered>,
    ) {
        if !self.validity.holds(particles.moving(), range) {
            carried.extend(self.remembered());
            self.validity.renew(particles.moving(), range);
            self.clear();
            self.find(particles, (row_start, partners), carried);
            self.one_size = particles.one_size();
            carried.clear();
        }
        self.validity.age += 1;
    }

    /// What all touching pairs remember.
    pub(super) fn remembered(&self) -> impl Iterator<Item = Remembered> + '_ {
        self.slot.iter().enumerate().filter_map(|(pair, &slot)| {
            let (block, lane) = (pair / LANES, pair % LANES);
            let memory = || bytemuck::cast(self.memory[block].map(|field| field[lane]));
            let angle = || match self.rolling_angle.get(block) {
                Some(angle) => Vector3::from_fn(|axis, _| angle[axis][lane]),
                None => Vector3::zeros(),
            };
            self.touching[block][lane].then(|| Remembered {
                slot,
                memory: memory(),
                rolling_angle: angle(),
            })
        })
    }

    /// Makes room for the angles of rolling springs, all zero, or drops them: a spring that was switched off
    /// does not come back bent.
    pub fn hold_rolling_angles(&mut self, hold: bool) {
        self.rolling = hold;
        let blocks = if hold { self.first.len() } else { 0 };
        self.rolling_angle.resize(blocks, [[0.0; LANES]; 3]);
    }

    /// Forgets all pairs, so that they are found anew.
    pub(super) fn forget(&mut self) {
        self.clear();
        self.validity.reference.clear();
    }

    fn clear(&mut self) {
        self.first.clear();
        self.second.clear();
        self.target.clear();
        self.touching.clear();
        self.memory.clear();
        self.rolling_angle.clear();
        self.slot.clear();
    }

    fn find(
        &mut self,
        particles: &Particles,
        (row_start, partners): (&[u32], &[u32]),
        carried: &[Remembered],
    ) {
        let bodies = &particles.body[..];
        let margin = self.validity.range + self.validity.margin;
        let mut carried = carried.iter().copied().peekable();
        for (row, ends) in row_start.windows(2).enumerate() {
            let body = &bodies[row];
            for slot in ends[0]..ends[1] {
                let partner = partners[slot as usize];
                let remembered = carried.next_if(|pair| pair.slot == slot);
                if is_near(body, &bodies[partner as usize], margin) {
                    let original = particles.owned_original(partner as usize);
                    let target = original.map_or(partner, |index| index as u32);
                    self.push([row as u32, partner, target], slot, remembered);
                }
            }
        }
    }

    /// Pairs in the blocks.
    pub fn count(&self) -> usize {
        self.slot.len()
    }

    fn push(
        &mut self,
        [first, second, target]: [u32; 3],
        slot: u32,
        remembered: Option<Remembered>,
    ) {
        let lane = self.slot.len() % LANES;
        if lane == 0 {
            if self.rolling {
                self.rolling_angle.push([[0.0; LANES]; 3]);
            }
            // Should no more pairs come, this one fills up the block.
            self.first.push([first; LANES]);
            self.second.push([second; LANES]);
            self.target.push([target; LANES]);
            self.touching.push([false; LANES]);
            self.memory.push([[0.0; LANES]; MEMORY_FIELDS]);
        }
        let block = self.first.len() - 1;
        self.first[block][lane] = first;
        self.second[block][lane] = second;
        self.target[block][lane] = target;
        self.touching[block][lane] = remembered.is_some();
        if let Some(Remembered { memory, rolling_angle, .. }) = remembered {
            let numbers: [f64; MEMORY_FIELDS] = bytemuck::cast(memory);
            for (field, number) in self.memory[block].iter_mut().zip(numbers) {
                field[lane] = number;
            }
            if let Some(angle) = self.rolling_angle.get_mut(block) {
                (0..3).for_each(|axis| angle[axis][lane] = rolling_angle[axis]);
            }
        }
        self.slot.push(slot);
    }
}

/// Whether the surfaces of two bodies are closer than `margin`.
#[inline(always)]
fn is_near(one: &Body, other: &Body, margin: f64) -> bool {
    let reach = one.radius + other.radius + margin;
    (other.position - one.position).norm_squared() < reach * reach
}
