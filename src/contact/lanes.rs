//! Near pairs evaluated side by side: gathered into lanes, run through the law, scattered.
//!
//! The law is written for one contact and without branches; in the loop over lanes the compiler turns it
//! into vector instructions. Every operation is an IEEE one, rounded once, so the width of the vectors
//! changes no bit.

use super::forces::{ForceLaws, ForceOutOfRange, out_of_range, total};
use super::van_der_waals::{Attraction, Full, NearContact, NoAttraction};
use super::{CohesionExpression, Contact, ContactLaw, ContactModel};
use crate::numbers::{Quad, QuadWork, within};
use crate::particles::{
    Bodies, Body, ContactMemory, LANES, Load, MEMORY_FIELDS, MemoryLanes, NearPairs,
};
use nalgebra::Vector3;

type Lanes = [f64; LANES];

/// Bodies and pairs, and what acts between them.
pub(super) struct PairWork<'a> {
    pub(super) bodies: &'a mut Bodies,
    pub(super) near: &'a mut NearPairs,
    pub(super) laws: &'a ForceLaws<'a>,
    pub(super) id: &'a [u64],
}

impl QuadWork for PairWork<'_> {
    type Output = Result<(), ForceOutOfRange>;

    /// Chooses law and attraction once, for all pairs.
    #[inline(always)]
    fn run<Q: Quad>(self) -> Self::Output {
        match self.laws.contact {
            ContactModel::LinearSpringDashpot(law) => self.with_attraction::<Q, _>(law),
        }
    }
}

impl PairWork<'_> {
    #[inline(always)]
    fn with_attraction<Q: Quad, L: ContactLaw>(self, law: &L) -> Result<(), ForceOutOfRange> {
        let Some(cohesion) = self.laws.cohesion else {
            return self.with_sizes::<Q, _>((law, NoAttraction));
        };
        match cohesion.expression() {
            CohesionExpression::NearContact => {
                self.with_sizes::<Q, _>((law, NearContact(cohesion)))
            }
            CohesionExpression::Full => self.with_sizes::<Q, _>((law, Full(cohesion))),
        }
    }

    #[inline(always)]
    fn with_sizes<Q: Quad, F: PairForce>(self, force: F) -> Result<(), ForceOutOfRange> {
        match self.near.one_size {
            Some([radius, mass]) => self.evaluate::<Q, _, _>(force, OneSize { radius, mass }),
            None => self.evaluate::<Q, _, _>(force, ManySizes::default()),
        }
    }

    #[inline(always)]
    fn evaluate<Q: Quad, F: PairForce, S: Sizes>(
        self,
        force: F,
        mut sizes: S,
    ) -> Result<(), ForceOutOfRange> {
        let Self { bodies, near, laws, id } = self;
        let mut block = Block::default();
        let pairs = near.first.iter().zip(&near.second);
        let memories = near.memory.iter_mut().zip(&mut near.touching);
        for ((first, second), (memory, touching)) in pairs.zip(memories) {
            gather::<Q, S>(&mut block, &mut sizes, [first, second], &bodies.body);
            run(&force, &sizes, laws, &mut block, memory);
            *touching = block.overlap.map(|overlap| overlap > 0.0);
            if let Some(lane) = (0..LANES).find(|&lane| block.out_of_range[lane] != 0.0) {
                let force = Vector3::from_fn(|axis, _| block.force_on_j[axis][lane]);
                let (i, j) = (first[lane] as usize, second[lane] as usize);
                let other = format!("particle {}", id[j]);
                return Err(out_of_range(id[i], other, force, block.overlap[lane], laws.limit));
            }
            scatter::<Q, S>(&block, [first, second], &mut bodies.load);
        }
        Ok(())
    }
}

/// Contact law and attraction.
trait PairForce {
    type Law: ContactLaw;
    type Attraction: Attraction;

    fn law(&self) -> &Self::Law;
    fn attraction(&self) -> Self::Attraction;
}

impl<L: ContactLaw, A: Attraction> PairForce for (&L, A) {
    type Law = L;
    type Attraction = A;

    #[inline(always)]
    fn law(&self) -> &L {
        self.0
    }

    #[inline(always)]
    fn attraction(&self) -> A {
        self.1
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
            self.radii[side][lane] = body.place[3];
            self.masses[side][lane] = body.motion[3];
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
    relative_velocity: [Lanes; 3],
    /// omega_i r_i + omega_j r_j.
    spin: [Lanes; 3],
    overlap: Lanes,
    force_on_j: [Lanes; 3],
    torque_on_i: [Lanes; 3],
    torque_on_j: [Lanes; 3],
    /// 1 where the force exceeds the limit or is undefined.
    out_of_range: Lanes,
}

#[inline(always)]
fn gather<Q: Quad, S: Sizes>(
    block: &mut Block,
    sizes: &mut S,
    [first, second]: [&[u32; LANES]; 2],
    bodies: &[Body],
) {
    let zero = [Q::splat(0.0); 4];
    let (mut branch, mut relative_velocity, mut spin) = (zero, zero, zero);
    for from in (0..LANES).step_by(4) {
        for row in 0..4 {
            let lane = from + row;
            let (i, j) = (&bodies[first[lane] as usize], &bodies[second[lane] as usize]);
            sizes.gather(lane, [i, j]);
            let [radius_i, radius_j] = sizes.radii(lane);
            branch[row] = Q::load(&j.place).minus(Q::load(&i.place));
            relative_velocity[row] = Q::load(&j.motion).minus(Q::load(&i.motion));
            let spin_i = Q::load(&i.spin).times(Q::splat(radius_i));
            spin[row] = spin_i.plus(Q::load(&j.spin).times(Q::splat(radius_j)));
        }
        store(&mut block.branch, from, branch);
        store(&mut block.relative_velocity, from, relative_velocity);
        store(&mut block.spin, from, spin);
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

/// All lanes, those that only fill up the last block too: nothing acts between their bodies.
#[inline(always)]
fn run<F: PairForce, S: Sizes>(
    pair_force: &F,
    sizes: &S,
    laws: &ForceLaws,
    block: &mut Block,
    memories: &mut MemoryLanes,
) {
    for lane in 0..LANES {
        let vector =
            |lanes: &[Lanes; 3]| Vector3::new(lanes[0][lane], lanes[1][lane], lanes[2][lane]);
        let branch = vector(&block.branch);
        let distance = branch.dot(&branch).sqrt();
        let ([radius_i, radius_j], [mass_i, mass_j]) = (sizes.radii(lane), sizes.masses(lane));
        let overlap = radius_i + radius_j - distance;
        let normal = branch * (1.0 / distance);
        let contact = Contact {
            overlap,
            normal,
            relative_velocity: vector(&block.relative_velocity)
                - vector(&block.spin).cross(&normal),
            reduced_mass: mass_i * mass_j / (mass_i + mass_j),
            cohesion: pair_force.attraction().between(radius_i, radius_j, -overlap),
        };
        let mut numbers = [0.0; MEMORY_FIELDS];
        for (number, field) in numbers.iter_mut().zip(&*memories) {
            *number = field[lane];
        }
        let mut memory: ContactMemory = bytemuck::cast(numbers);
        let mut force = pair_force.law().force(&contact, &mut memory, laws.dt);
        // Apart, the law has nothing to say, whatever it gave.
        let if_touching = |value: f64| if overlap > 0.0 { value } else { 0.0 };
        force.normal = if_touching(force.normal);
        force.tangential = force.tangential.map(if_touching);
        let on_j = laws.force_lattice.round_vector(total(&contact, &force));
        let twist = normal.cross(&force.tangential);
        for axis in 0..3 {
            block.force_on_j[axis][lane] = on_j[axis];
            block.torque_on_i[axis][lane] = laws.torque_lattice.round(twist[axis] * radius_i);
            if !S::EQUAL {
                block.torque_on_j[axis][lane] = laws.torque_lattice.round(twist[axis] * radius_j);
            }
        }
        let numbers: [f64; MEMORY_FIELDS] = bytemuck::cast(memory);
        for (number, field) in numbers.into_iter().zip(&mut *memories) {
            field[lane] = if_touching(number);
        }
        block.overlap[lane] = overlap;
        block.out_of_range[lane] = if within(&on_j, laws.limit) { 0.0 } else { 1.0 };
    }
}

#[inline(always)]
fn scatter<Q: Quad, S: Sizes>(
    block: &Block,
    [first, second]: [&[u32; LANES]; 2],
    loads: &mut [Load],
) {
    for from in (0..LANES).step_by(4) {
        let force = load::<Q>(&block.force_on_j, from);
        let torque_on_i = load::<Q>(&block.torque_on_i, from);
        let torque_on_j = if S::EQUAL { torque_on_i } else { load(&block.torque_on_j, from) };
        for row in 0..4 {
            let on_i = &mut loads[first[from + row] as usize];
            Q::load(&on_i.force).minus(force[row]).store(&mut on_i.force);
            Q::load(&on_i.torque).minus(torque_on_i[row]).store(&mut on_i.torque);
            let on_j = &mut loads[second[from + row] as usize];
            Q::load(&on_j.force).plus(force[row]).store(&mut on_j.force);
            Q::load(&on_j.torque).minus(torque_on_j[row]).store(&mut on_j.torque);
        }
    }
}
