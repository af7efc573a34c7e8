//! Near pairs evaluated side by side: gathered into lanes, run through the law, scattered.
//!
//! The law is written for one contact and without branches; in the loop over lanes the compiler turns it
//! into vector instructions. Every operation is an IEEE one, rounded once, so the width of the vectors
//! changes no bit.

use super::forces::{ForceLaws, ForceOutOfRange, out_of_range, total};
use super::rolling::{NoRolling, Rolling};
use super::van_der_waals::{Attraction, Full, NearContact};
use super::{CohesionExpression, Contact, ContactLaw, ContactModel};
use crate::numbers::{Quad, QuadWork, within};
use crate::particles::{
    AngleLanes, Body, ContactMemory, LANES, Load, MEMORY_FIELDS, MemoryLanes, NearPairs, Particles,
};
use nalgebra::Vector3;

type Lanes = [f64; LANES];

/// Bodies and pairs, and what acts between them.
pub(super) struct PairWork<'a> {
    pub(super) particles: &'a mut Particles,
    pub(super) near: &'a mut NearPairs,
    pub(super) laws: &'a ForceLaws<'a>,
}

impl QuadWork for PairWork<'_> {
    type Output = Result<(), ForceOutOfRange>;

    /// Chooses the law once, for all pairs.
    #[inline(always)]
    fn run<Q: Quad>(self) -> Self::Output {
        match &self.laws.contact.law {
            ContactModel::LinearSpringDashpot(law) => self.with_rolling::<Q, _>(law),
            ContactModel::AdhesiveElasticPlastic(law) => self.with_rolling::<Q, _>(law),
            ContactModel::HertzMindlin(law) => self.with_rolling::<Q, _>(law),
            ContactModel::Jkr(law) => self.with_rolling::<Q, _>(law),
            ContactModel::LinearHysteretic(law) => self.with_rolling::<Q, _>(law),
        }
    }
}

impl PairWork<'_> {
    /// Chooses rolling and, without it, whether all particles are alike.
    #[inline(always)]
    fn with_rolling<Q: Quad, L: ContactLaw>(self, law: &L) -> Result<(), ForceOutOfRange> {
        match (self.laws.contact.rolling, self.near.one_size) {
            (Some(rolling), _) => self.evaluate::<Q, _, _, _>((law, rolling), ManySizes::default()),
            (None, None) => self.evaluate::<Q, _, _, _>((law, NoRolling), ManySizes::default()),
            (None, Some([radius, mass])) => {
                self.evaluate::<Q, _, _, _>((law, NoRolling), OneSize { radius, mass })
            }
        }
    }

    #[inline(always)]
    fn evaluate<Q: Quad, L: ContactLaw, R: Rolling, S: Sizes>(
        self,
        law: (&L, R),
        mut sizes: S,
    ) -> Result<(), ForceOutOfRange> {
        let Self { particles, near, laws } = self;
        let mut block = Block::default();
        let mut no_angles = [[0.0; LANES]; 3];
        for index in 0..near.first.len() {
            let pairs = [&near.first[index], &near.second[index]];
            gather::<Q, R, S>(&mut block, &mut sizes, pairs, &particles.body);
            approach(&mut block, &sizes);
            attract(&mut block, &sizes, laws);
            let angles = near.rolling_angle.get_mut(index).unwrap_or(&mut no_angles);
            run(law, &sizes, laws, &mut block, (&mut near.memory[index], angles));
            note_touching(&block, &mut near.touching[index]);
            if let Some(lane) = out_of_range_lane(&block) {
                let force = Vector3::from_fn(|axis, _| block.force_on_j[axis][lane]);
                let [i, j] = pairs.map(|of| particles.id[of[lane] as usize]);
                let (other, overlap) = (format!("particle {j}"), block.overlap[lane]);
                return Err(out_of_range(i, other, force, overlap, laws.limit));
            }
            let used = (near.count() - index * LANES).min(LANES);
            scatter::<Q, S>(&block, pairs, used, &mut particles.load);
        }
        Ok(())
    }
}

/// Radii and masses of the pairs of a block.
trait Sizes: Copy {
    /// Whether the two bodies of every pair are equal.
    const EQUAL: bool;

    fn gather(&mut self, lane: usize, pair: [&Body; 2]);
    fn radii(&self, lane: usize) -> [f64; 2];
    fn masses(&self, lane: usize) -> [f64; 2];
}

/// All particles are alike: what follows from sizes is found once, before the loop.
#[derive(Clone, Copy)]
struct OneSize {
    radius: f64,
    mass: f64,
}

impl Sizes for OneSize {
    const EQUAL: bool = true;

    #[inline(always)]
    fn gather(&mut self, _lane: usize, _pair: [&Body; 2]) {}

    #[inline(always)]
    fn radii(&self, _lane: usize) -> [f64; 2] {
        [self.radius; 2]
    }

    #[inline(always)]
    fn masses(&self, _lane: usize) -> [f64; 2] {
        [self.mass; 2]
    }
}

/// Sizes differ.
#[derive(Clone, Copy, Default)]
struct ManySizes {
    radii: [Lanes; 2],
    masses: [Lanes; 2],
}

impl Sizes for ManySizes {
    const EQUAL: bool = false;

    #[inline(always)]
    fn gather(&mut self, lane: usize, pair: [&Body; 2]) {
        for (side, body) in pair.into_iter().enumerate() {
            self.radii[side][lane] = body.radius;
            self.masses[side][lane] = body.mass;
        }
    }

    #[inline(always)]
    fn radii(&self, lane: usize) -> [f64; 2] {
        [self.radii[0][lane], self.radii[1][lane]]
    }

    #[inline(always)]
    fn masses(&self, lane: usize) -> [f64; 2] {
        [self.masses[0][lane], self.masses[1][lane]]
    }
}

/// The pairs of a block, component by component.
#[derive(Default)]
struct Block {
    branch: [Lanes; 3],
    /// Of the centres; then of the surfaces where they meet.
    relative_velocity: [Lanes; 3],
    /// omega_i r_i + omega_j r_j.
    surface_spin: [Lanes; 3],
    /// Only if rolling is resisted.
    relative_spin: [Lanes; 3],
    overlap: Lanes,
    normal: [Lanes; 3],
    cohesion: Lanes,
    force_on_j: [Lanes; 3],
    /// Less the torques.
    torque_off_i: [Lanes; 3],
    torque_off_j: [Lanes; 3],
    /// 1 where the bodies touch.
    touching: [u64; LANES],
    /// 1 where the force exceeds the limit or is undefined.
    out_of_range: [u64; LANES],
}

#[inline(always)]
fn gather<Q: Quad, R: Rolling, S: Sizes>(
    block: &mut Block,
    sizes: &mut S,
    [first, second]: [&[u32; LANES]; 2],
    bodies: &[Body],
) {
    let zero = [Q::splat(0.0); 4];
    let (mut branch, mut velocity, mut spin, mut relative_spin) = (zero, zero, zero, zero);
    for from in (0..LANES).step_by(4) {
        for row in 0..4 {
            let lane = from + row;
            let (i, j) = (&bodies[first[lane] as usize], &bodies[second[lane] as usize]);
            sizes.gather(lane, [i, j]);
            let [radius_i, radius_j] = sizes.radii(lane);
            let ([place_i, motion_i, spin_i], [place_j, motion_j, spin_j]) = (i.quads(), j.quads());
            branch[row] = Q::load(place_j).minus(Q::load(place_i));
            velocity[row] = Q::load(motion_j).minus(Q::load(motion_i));
            let (spin_i, spin_j) = (Q::load(spin_i), Q::load(spin_j));
            let surface_i = spin_i.times(Q::splat(radius_i));
            spin[row] = surface_i.plus(spin_j.times(Q::splat(radius_j)));
            relative_spin[row] = spin_j.minus(spin_i);
        }
        store(&mut block.branch, from, branch);
        store(&mut block.relative_velocity, from, velocity);
        store(&mut block.surface_spin, from, spin);
        if R::ACTS {
            store(&mut block.relative_spin, from, relative_spin);
        }
    }
}

/// Vectors of four pairs to components in lanes.
#[inline(always)]
fn store<Q: Quad>(components: &mut [Lanes; 3], from: usize, vectors: [Q; 4]) {
    let columns = Q::transposed(vectors);
    for axis in 0..3 {
        columns[axis].store(quad_mut(&mut components[axis], from));
    }
}

/// Components in lanes to vectors of four pairs.
#[inline(always)]
fn load<Q: Quad>(components: &[Lanes; 3], from: usize) -> [Q; 4] {
    let [x, y, z] = components;
    Q::transposed([
        Q::load(quad(x, from)),
        Q::load(quad(y, from)),
        Q::load(quad(z, from)),
        Q::splat(0.0),
    ])
}

#[inline(always)]
fn quad(lanes: &Lanes, from: usize) -> &[f64; 4] {
    lanes[from..].first_chunk().expect("lanes are whole quads")
}

#[inline(always)]
fn quad_mut(lanes: &mut Lanes, from: usize) -> &mut [f64; 4] {
    lanes[from..].first_chunk_mut().expect("lanes are whole quads")
}

/// How the surfaces of the pairs meet. A loop of its own: a processor sees only so far ahead, and here it sees
/// several square roots at once.
#[inline(always)]
fn approach<S: Sizes>(block: &mut Block, sizes: &S) {
    for lane in 0..LANES {
        let branch = vector(&block.branch, lane);
        let distance = branch.dot(&branch).sqrt();
        let [radius_i, radius_j] = sizes.radii(lane);
        let normal = branch * (1.0 / distance);
        let velocity = vector(&block.relative_velocity, lane)
            - vector(&block.surface_spin, lane).cross(&normal);
        block.overlap[lane] = radius_i + radius_j - distance;
        for axis in 0..3 {
            block.normal[axis][lane] = normal[axis];
            block.relative_velocity[axis][lane] = velocity[axis];
        }
    }
}

/// Attraction of the pairs, if there is any.
#[inline(always)]
fn attract<S: Sizes>(block: &mut Block, sizes: &S, laws: &ForceLaws) {
    let Some(cohesion) = laws.cohesion else { return };
    match cohesion.expression() {
        CohesionExpression::NearContact => attract_by(NearContact(cohesion), block, sizes),
        CohesionExpression::Full => attract_by(Full(cohesion), block, sizes),
    }
}

#[inline(always)]
fn attract_by<A: Attraction, S: Sizes>(attraction: A, block: &mut Block, sizes: &S) {
    for lane in 0..LANES {
        let [radius_i, radius_j] = sizes.radii(lane);
        block.cohesion[lane] = attraction.between(radius_i, radius_j, -block.overlap[lane]);
    }
}

#[inline(always)]
fn vector(components: &[Lanes; 3], lane: usize) -> Vector3<f64> {
    Vector3::new(components[0][lane], components[1][lane], components[2][lane])
}

/// All lanes, those that only fill up the last block too: what they give is not used.
#[inline(always)]
fn run<L: ContactLaw, R: Rolling, S: Sizes>(
    (law, rolling): (&L, R),
    sizes: &S,
    laws: &ForceLaws,
    block: &mut Block,
    (memories, angles): (&mut MemoryLanes, &mut AngleLanes),
) {
    for lane in 0..LANES {
        let contact = contact_of(block, sizes, lane);
        let [radius_i, radius_j] = sizes.radii(lane);
        let mut numbers = [0.0; MEMORY_FIELDS];
        for (number, field) in numbers.iter_mut().zip(&*memories) {
            *number = field[lane];
        }
        let mut memory: ContactMemory = bytemuck::cast(numbers);
        let touches = law.touches(&contact, &memory);
        let mut force = law.force(&contact, &mut memory, laws.dt);
        // Apart, the law has nothing to say, whatever it gave.
        let if_touching = |value: f64| if touches { value } else { 0.0 };
        force.normal = if_touching(force.normal);
        force.tangential = force.tangential.map(if_touching);
        let on_j = laws.force_lattice.round_vector(total(&contact, &force));
        let twist = contact.normal.cross(&force.tangential);
        let mut twists = [twist * radius_i, twist * radius_j];
        if R::ACTS {
            let mut angle = vector(angles, lane);
            let stiffness = law.stiffness_over(&contact, laws.dt);
            let torque = rolling.torque(&contact, force.grip, stiffness, &mut angle, laws.dt);
            let torque = torque.map(if_touching);
            twists = [twists[0] + torque, twists[1] - torque];
            (0..3).for_each(|axis| angles[axis][lane] = if_touching(angle[axis]));
        }
        for axis in 0..3 {
            block.force_on_j[axis][lane] = on_j[axis];
            block.torque_off_i[axis][lane] = laws.torque_lattice.round(twists[0][axis]);
            if !S::EQUAL {
                block.torque_off_j[axis][lane] = laws.torque_lattice.round(twists[1][axis]);
            }
        }
        let numbers: [f64; MEMORY_FIELDS] = bytemuck::cast(memory);
        for (number, field) in numbers.into_iter().zip(&mut *memories) {
            field[lane] = if_touching(number);
        }
        block.touching[lane] = u64::from(touches);
        block.out_of_range[lane] = u64::from(!within(&on_j, laws.limit));
    }
}

#[inline(always)]
fn contact_of<S: Sizes>(block: &Block, sizes: &S, lane: usize) -> Contact {
    let ([radius_i, radius_j], [mass_i, mass_j]) = (sizes.radii(lane), sizes.masses(lane));
    Contact {
        overlap: block.overlap[lane],
        normal: vector(&block.normal, lane),
        relative_velocity: vector(&block.relative_velocity, lane),
        relative_spin: vector(&block.relative_spin, lane),
        reduced_mass: mass_i * mass_j / (mass_i + mass_j),
        reduced_radius: radius_i * radius_j / (radius_i + radius_j),
        reduced_inertia: reduced_inertia([radius_i, radius_j], [mass_i, mass_j]),
        cohesion: block.cohesion[lane],
    }
}

#[inline(always)]
fn note_touching(block: &Block, touching: &mut [bool; LANES]) {
    for (touching, &flag) in touching.iter_mut().zip(&block.touching) {
        *touching = flag != 0;
    }
}

/// The first pair with a force that has no meaning.
#[inline(always)]
fn out_of_range_lane(block: &Block) -> Option<usize> {
    let mut any = 0;
    for lane in 0..LANES {
        any |= block.out_of_range[lane];
    }
    if any == 0 {
        return None;
    }
    block.out_of_range.iter().position(|&flag| flag != 0)
}

/// I* of two solid spheres.
#[inline(always)]
fn reduced_inertia(radius: [f64; 2], mass: [f64; 2]) -> f64 {
    let one = 0.4 * mass[0] * radius[0] * radius[0];
    let other = 0.4 * mass[1] * radius[1] * radius[1];
    one * other / (one + other)
}

/// Puts forces and torques of the first `used` pairs on their bodies.
#[inline(always)]
fn scatter<Q: Quad, S: Sizes>(
    block: &Block,
    [first, second]: [&[u32; LANES]; 2],
    used: usize,
    loads: &mut [Load],
) {
    for from in (0..used).step_by(4) {
        let force = load::<Q>(&block.force_on_j, from);
        let torque_off_i = load::<Q>(&block.torque_off_i, from);
        let torque_off_j = if S::EQUAL { torque_off_i } else { load(&block.torque_off_j, from) };
        for row in 0..4 {
            if from + row >= used {
                break;
            }
            let [force_i, torque_i] = loads[first[from + row] as usize].quads_mut();
            Q::load(force_i).minus(force[row]).store(force_i);
            Q::load(torque_i).minus(torque_off_i[row]).store(torque_i);
            let [force_j, torque_j] = loads[second[from + row] as usize].quads_mut();
            Q::load(force_j).plus(force[row]).store(force_j);
            Q::load(torque_j).minus(torque_off_j[row]).store(torque_j);
        }
    }
}
