//! Energies of all contacts of a rank: work over a step, and stored energy. Each pair is counted on one rank.

use super::energy::overlap_before;
use super::force_laws::{ForceLaws, PairLaws};
use super::lanes::overlap_and_normal;
use super::rolling::Rolling;
use super::walls::{contact_with, total_force};
use super::{Contact, ContactForceLaw, ContactModel, ContactStep, ContactWork, VanDerWaalsNow};
use crate::domain::PosedWalls;
use crate::particles::{ContactState, Contacts, PairGroup, Particles};
use nalgebra::Vector3;

/// Work of a wall's contact with a particle in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallWork {
    /// Number of the wall.
    pub(crate) wall: usize,
    /// Work of the contact.
    pub(crate) work: ContactWork,
    /// Force on the wall at the end of the step.
    pub(crate) force: Vector3<f64>,
    /// Torque on the wall about the point of contact, of resistance to rolling and twisting.
    pub(crate) couple: Vector3<f64>,
    /// The point of contact.
    pub(crate) point: Vector3<f64>,
}

/// Work of the contacts of a group of pairs over a step; histories are those before the step, positions those at its
/// end.
pub(crate) fn work_of_pairs(
    particles: &Particles,
    contacts: &Contacts,
    laws: &ForceLaws,
    group: PairGroup,
    mut sink: impl FnMut(ContactWork),
) {
    for (kind, pair, before) in contacts.inner.active_pairs(group) {
        let laws = laws.of_kind(kind);
        let contact = contact_of_pair(particles, pair, laws.cohesion);
        if let Some((work, _)) = work_over_step(laws.contact, &contact, before, laws.dt) {
            sink(work);
        }
    }
}

/// Work of all contacts with walls over a step.
pub(crate) fn work_of_walls(
    particles: &Particles,
    contacts: &Contacts,
    walls: PosedWalls<'_>,
    laws: &ForceLaws,
    mut sink: impl FnMut(WallWork),
) {
    for slot in contacts.wall_slots() {
        let WallContact { wall, contact, point, before, model } =
            wall_contact(particles, contacts, walls, laws, slot);
        let (work, force) = work_over_step(model, &contact, before, laws.dt).unwrap_or_default();
        let total = total_force(&contact, force.normal, force.tangential);
        let (force, couple) = (laws.force_quantum.round_vector(total), force.couple);
        sink(WallWork { wall, work, force, couple, point });
    }
}

/// A particle near a wall: the present contact, its state at the previous step if the two touched then, and its model.
struct WallContact<'a> {
    wall: usize,
    contact: Contact,
    point: Vector3<f64>,
    before: Option<ContactState>,
    model: &'a ContactModel,
}

fn wall_contact<'a>(
    particles: &Particles,
    contacts: &Contacts,
    walls: PosedWalls<'_>,
    laws: &ForceLaws<'a>,
    slot: usize,
) -> WallContact<'a> {
    let pair = &contacts.wall_pairs[slot];
    let (particle, wall) = (pair.particle as usize, pair.wall as usize);
    let body = &particles.body[particle];
    let at_wall = laws.at_wall(wall, body.species());
    let contact = contact_with(walls, pair, particles, at_wall.cohesion);
    WallContact {
        wall,
        contact,
        point: body.position + contact.normal * (contact.reduced_radius - contact.overlap),
        before: contacts.wall_touching[slot].then(|| contacts.wall_state[slot]),
        model: at_wall.contact,
    }
}

/// The force of a contact law.
#[derive(Clone, Copy, Default)]
struct LawForce {
    normal: f64,
    tangential: Vector3<f64>,
    /// Torque on the second body of resistance to rolling and twisting.
    couple: Vector3<f64>,
}

/// Work of a contact over a step, and its force at the end; `None` if the bodies touch neither before nor after.
fn work_over_step(
    model: &ContactModel,
    contact: &Contact,
    before: Option<ContactState>,
    dt: f64,
) -> Option<(ContactWork, LawForce)> {
    let ContactModel { law, rolling, twisting, .. } = model;
    let (touched, before) = (before.is_some(), before.unwrap_or_default());
    let history_before = before.history();
    if !law.touches(contact, &history_before) {
        return touched
            .then(|| (work_of_parting(model, contact, &before, dt), LawForce::default()));
    }
    let mut history = history_before;
    let force = law.force(contact, &mut history, dt);
    let mut work = law.work(&ContactStep {
        contact,
        before: &history_before,
        after: &history,
        force: &force,
        began: !touched,
        dt,
    });
    let mut couple = Vector3::zeros();
    if let Some(rolling) = rolling {
        let stiffness = law.stiffness_over(contact, dt);
        let angle_before = Vector3::from(before.rolling_angle);
        let mut angle = angle_before;
        let torque = rolling.torque(contact, force.friction_normal, stiffness, &mut angle, dt);
        couple += torque;
        let angles = [angle_before, angle];
        work = work + rolling.work(contact, stiffness, angles, torque, dt);
    }
    if let Some(twisting) = twisting {
        let stiffness = law.stiffness_over(contact, dt);
        let mut angle = before.twisting_angle;
        let torque = twisting.torque(contact, force.friction_normal, stiffness, &mut angle, dt);
        couple += contact.normal * torque;
        let angles = [before.twisting_angle, angle];
        work = work + twisting.work(contact, stiffness, angles, torque, dt);
    }
    Some((work, LawForce { normal: force.normal, tangential: force.tangential, couple }))
}

/// Work of a contact that ends in a step: the energy that its springs still hold is lost.
fn work_of_parting(
    model: &ContactModel,
    contact: &Contact,
    before: &ContactState,
    dt: f64,
) -> ContactWork {
    let law = &model.law;
    let overlap = overlap_before(contact, dt);
    let last = Contact { overlap, ..*contact };
    let end = Contact { overlap: -law.contact_range(contact.reduced_radius), ..*contact };
    let stiffness = law.stiffness(overlap, contact.reduced_radius);
    let spin = energy_of_spin(model, contact, stiffness, before);
    ContactWork {
        friction: -law.stored_energy(&last, &before.history()).tangential - spin,
        plasticity: -law.stored_energy(&end, &before.history()).normal,
        ..ContactWork::default()
    }
}

/// Energy of the rolling and the twisting spring at a given stiffness of the law.
fn energy_of_spin(
    model: &ContactModel,
    contact: &Contact,
    stiffness: f64,
    before: &ContactState,
) -> f64 {
    let rolling = model.rolling.map_or(0.0, |rolling| {
        rolling.stored_energy(contact, stiffness, &before.rolling_angle.into())
    });
    let twisting = model
        .twisting
        .map_or(0.0, |twisting| twisting.stored_energy(contact, stiffness, before.twisting_angle));
    rolling + twisting
}

/// Energy of the springs of all contacts.
pub(crate) fn elastic_energy(
    particles: &Particles,
    contacts: &Contacts,
    walls: PosedWalls<'_>,
    laws: &ForceLaws,
    mut sink: impl FnMut(f64),
) {
    let stored = |model: &ContactModel, contact: &Contact, before: &ContactState| {
        let law = &model.law;
        let springs = law.stored_energy(contact, &before.history());
        let stiffness = law.stiffness(contact.overlap, contact.reduced_radius);
        let spin = energy_of_spin(model, contact, stiffness, before);
        springs.normal + springs.tangential + spin
    };
    let groups = PairGroup::ALL.into_iter();
    for (kind, pair, before) in groups.flat_map(|group| contacts.inner.active_pairs(group)) {
        let Some(before) = before else { continue };
        let PairLaws { contact, cohesion, .. } = laws.of_kind(kind);
        sink(stored(contact, &contact_of_pair(particles, pair, cohesion), &before));
    }
    for slot in (0..contacts.wall_pairs.len()).filter(|&slot| contacts.wall_touching[slot]) {
        let WallContact { contact, before, model, .. } =
            wall_contact(particles, contacts, walls, laws, slot);
        sink(stored(model, &contact, &before.unwrap_or_default()));
    }
}

/// Energy of the attraction of all pairs, and of particles and walls; zero without attraction.
pub(crate) fn attraction_energy(
    particles: &Particles,
    contacts: &Contacts,
    walls: PosedWalls<'_>,
    laws: &ForceLaws,
    mut sink: impl FnMut(f64),
) {
    let Some(cohesion) = &laws.cohesion else { return };
    for [i, j] in contacts.listed_pairs() {
        let [one, other] = [i, j].map(|index| &particles.body[index as usize]);
        let (overlap, _) =
            overlap_and_normal(other.position - one.position, [one.radius, other.radius]);
        let cohesion = cohesion.of([one.species(), other.species()]);
        sink(cohesion.energy_of_particles(one.radius, other.radius, -overlap));
    }
    let acting = contacts.wall_pairs.iter().zip(&contacts.wall_acts).filter(|&(_, acts)| *acts);
    for (pair, _) in acting {
        let (wall, body) = (pair.wall as usize, &particles.body[pair.particle as usize]);
        let (wall, pose) = (&walls.walls[wall], &walls.poses[wall]);
        let (height, _) = wall.height_and_normal(&body.position, pose, pair.facet);
        let cohesion = cohesion.of([body.species(); 2]);
        sink(cohesion.energy_at_wall(body.radius, height - body.radius));
    }
}

/// The contact of two particles.
fn contact_of_pair(
    particles: &Particles,
    pair: [u32; 2],
    cohesion: Option<VanDerWaalsNow>,
) -> Contact {
    let [one, other] = pair.map(|index| &particles.body[index as usize]);
    let radii = [one.radius, other.radius];
    let (overlap, normal) = overlap_and_normal(other.position - one.position, radii);
    let spin = one.angular_velocity * radii[0] + other.angular_velocity * radii[1];
    let attraction =
        |cohesion: VanDerWaalsNow| cohesion.between_particles(radii[0], radii[1], -overlap);
    let reduced = |a: f64, b: f64| a * b / (a + b);
    Contact {
        overlap,
        normal,
        relative_velocity: other.velocity - one.velocity - spin.cross(&normal),
        relative_spin: other.angular_velocity - one.angular_velocity,
        reduced_mass: reduced(one.mass, other.mass),
        reduced_radius: reduced(radii[0], radii[1]),
        reduced_inertia: reduced(one.inertia(), other.inertia()),
        cohesion: cohesion.map_or(0.0, attraction),
    }
}
