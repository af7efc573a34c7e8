//! Near pairs evaluated side by side: gathered into lanes, run through the law, scattered.
//!
//! The law is written for one contact and without branches; in the loop over lanes the compiler turns it
//! into vector instructions. Every operation is an IEEE one, rounded once, so the width of the vectors
//! changes no bit.

use super::forces::{ForceLaws, ForceOutOfRange, NearPair, out_of_range, total};
use super::rolling::{NoRolling, Rolling};
use super::van_der_waals::{Attraction, Full, NearContact, NoAttraction};
use super::{CohesionExpression, Contact, ContactLaw, ContactModel};
use crate::numbers::within;
use crate::particles::{ContactMemory, Contacts, Particles};
use nalgebra::Vector3;

const LANES: usize = 8;

type Lanes = [f64; LANES];

/// Some near pairs, component by component.
#[derive(Default)]
struct Block {
    branch: [Lanes; 3],
    relative_velocity: [Lanes; 3],
    spin: [Lanes; 3],
    radius_i: Lanes,
    radius_j: Lanes,
    mass_i: Lanes,
    mass_j: Lanes,
    spring: [Lanes; 3],
    largest_overlap: Lanes,
    relative_spin: [Lanes; 3],
    rolling_angle: [Lanes; 3],
    overlap: Lanes,
    /// 1 where the bodies touch.
    touching: Lanes,
    force_on_j: [Lanes; 3],
    torque_on_i: [Lanes; 3],
    torque_on_j: [Lanes; 3],
    /// 1 where the force exceeds the limit or is undefined.
    out_of_range: Lanes,
}

/// Chooses law and attraction once, for all pairs.
#[inline(always)]
pub(super) fn evaluate_in_lanes(
    particles: &mut Particles,
    contacts: &mut Contacts,
    laws: &ForceLaws,
    near: &[NearPair],
) -> Result<(), ForceOutOfRange> {
    match &laws.contact.law {
        ContactModel::LinearSpringDashpot(law) => {
            with_rolling(law, particles, contacts, laws, near)
        }
        ContactModel::AdhesiveElasticPlastic(law) => {
            with_rolling(law, particles, contacts, laws, near)
        }
        ContactModel::HertzMindlin(law) => with_rolling(law, particles, contacts, laws, near),
        ContactModel::Jkr(law) => with_rolling(law, particles, contacts, laws, near),
        ContactModel::LinearHysteretic(law) => with_rolling(law, particles, contacts, laws, near),
    }
}

#[inline(always)]
fn with_rolling<L: ContactLaw>(
    law: &L,
    particles: &mut Particles,
    contacts: &mut Contacts,
    laws: &ForceLaws,
    near: &[NearPair],
) -> Result<(), ForceOutOfRange> {
    match laws.contact.rolling {
        None => with_attraction((law, NoRolling), particles, contacts, laws, near),
        Some(rolling) => with_attraction((law, rolling), particles, contacts, laws, near),
    }
}

#[inline(always)]
fn with_attraction<L: ContactLaw, R: Rolling>(
    (law, rolling): (&L, R),
    particles: &mut Particles,
    contacts: &mut Contacts,
    laws: &ForceLaws,
    near: &[NearPair],
) -> Result<(), ForceOutOfRange> {
    let Some(cohesion) = laws.cohesion else {
        return evaluate((law, NoAttraction, rolling), particles, contacts, laws, near);
    };
    match cohesion.expression() {
        CohesionExpression::NearContact => {
            evaluate((law, NearContact(cohesion), rolling), particles, contacts, laws, near)
        }
        CohesionExpression::Full => {
            evaluate((law, Full(cohesion), rolling), particles, contacts, laws, near)
        }
    }
}

#[inline(always)]
fn evaluate<L: ContactLaw, A: Attraction, R: Rolling>(
    law: (&L, A, R),
    particles: &mut Particles,
    contacts: &mut Contacts,
    laws: &ForceLaws,
    near: &[NearPair],
) -> Result<(), ForceOutOfRange> {
    let mut block = Block::default();
    for pairs in near.chunks(LANES) {
        gather(&mut block, pairs, particles, contacts);
        if R::ACTS {
            gather_rolling(&mut block, pairs, particles, contacts);
        }
        run(law, laws, &mut block);
        if let Some(lane) = (0..pairs.len()).find(|&lane| block.out_of_range[lane] != 0.0) {
            let force = Vector3::from_fn(|axis, _| block.force_on_j[axis][lane]);
            let (i, j) = (pairs[lane].row as usize, pairs[lane].partner as usize);
            let other = format!("particle {}", particles.id[j]);
            let overlap = block.overlap[lane];
            return Err(out_of_range(particles.id[i], other, force, overlap, laws.limit));
        }
        scatter(&block, pairs, particles, contacts);
        if R::ACTS {
            scatter_rolling(&block, pairs, contacts);
        }
    }
    Ok(())
}

#[inline(always)]
fn gather(block: &mut Block, pairs: &[NearPair], particles: &Particles, contacts: &Contacts) {
    let n = particles.count();
    let (position, velocity) = (&particles.position[..n], &particles.velocity[..n]);
    let (spin, radius, mass) =
        (&particles.angular_velocity[..n], &particles.radius[..n], &particles.mass[..n]);
    for (lane, pair) in pairs.iter().enumerate().take(LANES) {
        let (i, j) = (pair.row as usize, pair.partner as usize);
        assert!(i < n && j < n, "pairs are of known particles"); // the only bounds check of ten columns
        let memory = &contacts.memory[pair.slot as usize];
        for axis in 0..3 {
            block.branch[axis][lane] = position[j][axis] - position[i][axis];
            block.relative_velocity[axis][lane] = velocity[j][axis] - velocity[i][axis];
            block.spin[axis][lane] = spin[i][axis] * radius[i] + spin[j][axis] * radius[j];
            block.spring[axis][lane] = memory.tangential_spring[axis];
        }
        block.radius_i[lane] = radius[i];
        block.radius_j[lane] = radius[j];
        block.mass_i[lane] = mass[i];
        block.mass_j[lane] = mass[j];
        block.largest_overlap[lane] = memory.largest_overlap;
    }
}

#[inline(always)]
fn gather_rolling(
    block: &mut Block,
    pairs: &[NearPair],
    particles: &Particles,
    contacts: &Contacts,
) {
    for (lane, pair) in pairs.iter().enumerate().take(LANES) {
        let (i, j) = (pair.row as usize, pair.partner as usize);
        let spin = particles.angular_velocity[j] - particles.angular_velocity[i];
        let angle = &contacts.rolling_angle[pair.slot as usize];
        for axis in 0..3 {
            block.relative_spin[axis][lane] = spin[axis];
            block.rolling_angle[axis][lane] = angle[axis];
        }
    }
}

#[inline(always)]
fn scatter_rolling(block: &Block, pairs: &[NearPair], contacts: &mut Contacts) {
    for (lane, pair) in pairs.iter().enumerate().take(LANES) {
        let angle = Vector3::from_fn(|axis, _| block.rolling_angle[axis][lane]);
        contacts.rolling_angle[pair.slot as usize] = angle;
    }
}

/// All lanes, those beyond the last pair too: what they hold is never read.
#[inline(always)]
fn run<L: ContactLaw, A: Attraction, R: Rolling>(
    (law, attraction, rolling): (&L, A, R),
    laws: &ForceLaws,
    block: &mut Block,
) {
    for lane in 0..LANES {
        let vector =
            |lanes: &[Lanes; 3]| Vector3::new(lanes[0][lane], lanes[1][lane], lanes[2][lane]);
        let branch = vector(&block.branch);
        let distance = branch.dot(&branch).sqrt();
        let (radius_i, radius_j) = (block.radius_i[lane], block.radius_j[lane]);
        let (mass_i, mass_j) = (block.mass_i[lane], block.mass_j[lane]);
        let overlap = radius_i + radius_j - distance;
        let normal = branch * (1.0 / distance);
        let contact = Contact {
            overlap,
            normal,
            relative_velocity: vector(&block.relative_velocity)
                - vector(&block.spin).cross(&normal),
            relative_spin: vector(&block.relative_spin),
            reduced_mass: mass_i * mass_j / (mass_i + mass_j),
            reduced_radius: radius_i * radius_j / (radius_i + radius_j),
            reduced_inertia: reduced_inertia([radius_i, radius_j], [mass_i, mass_j]),
            cohesion: attraction.between(radius_i, radius_j, -overlap),
        };
        let mut memory = ContactMemory {
            tangential_spring: vector(&block.spring),
            largest_overlap: block.largest_overlap[lane],
        };
        let touches = law.touches(&contact, &memory);
        let mut force = law.force(&contact, &mut memory, laws.dt);
        // Apart, the law has nothing to say, whatever it gave.
        let if_touching = |value: f64| if touches { value } else { 0.0 };
        force.normal = if_touching(force.normal);
        force.tangential = force.tangential.map(if_touching);
        let on_j = laws.force_lattice.round_vector(total(&contact, &force));
        let twist = normal.cross(&force.tangential);
        let mut twists = [twist * radius_i, twist * radius_j];
        if R::ACTS {
            let mut angle = vector(&block.rolling_angle);
            let stiffness = law.stiffness_over(&contact, laws.dt);
            let torque = rolling.torque(&contact, force.grip, stiffness, &mut angle, laws.dt);
            let torque = torque.map(if_touching);
            twists = [twists[0] + torque, twists[1] - torque];
            (0..3).for_each(|axis| block.rolling_angle[axis][lane] = if_touching(angle[axis]));
        }
        for axis in 0..3 {
            block.force_on_j[axis][lane] = on_j[axis];
            block.torque_on_i[axis][lane] = -laws.torque_lattice.round(twists[0][axis]);
            block.torque_on_j[axis][lane] = -laws.torque_lattice.round(twists[1][axis]);
            block.spring[axis][lane] = if_touching(memory.tangential_spring[axis]);
        }
        block.largest_overlap[lane] = if_touching(memory.largest_overlap);
        block.overlap[lane] = overlap;
        block.touching[lane] = if_touching(1.0);
        block.out_of_range[lane] = if within(&on_j, laws.limit) { 0.0 } else { 1.0 };
    }
}

#[inline(always)]
fn scatter(block: &Block, pairs: &[NearPair], particles: &mut Particles, contacts: &mut Contacts) {
    let n = particles.count();
    let (force, torque) = (&mut particles.force[..n], &mut particles.torque[..n]);
    for (lane, pair) in pairs.iter().enumerate().take(LANES) {
        let (i, j, slot) = (pair.row as usize, pair.partner as usize, pair.slot as usize);
        assert!(i < n && j < n, "pairs are of known particles");
        let memory = &mut contacts.memory[slot];
        for axis in 0..3 {
            memory.tangential_spring[axis] = block.spring[axis][lane];
            force[j][axis] += block.force_on_j[axis][lane];
            force[i][axis] -= block.force_on_j[axis][lane];
            torque[i][axis] += block.torque_on_i[axis][lane];
            torque[j][axis] += block.torque_on_j[axis][lane];
        }
        memory.largest_overlap = block.largest_overlap[lane];
        contacts.touching[slot] = block.touching[lane] != 0.0;
    }
}

/// I* of two solid spheres.
#[inline(always)]
fn reduced_inertia(radius: [f64; 2], mass: [f64; 2]) -> f64 {
    let [one, other] = [0, 1].map(|side| 0.4 * mass[side] * radius[side] * radius[side]);
    one * other / (one + other)
}
