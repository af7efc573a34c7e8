//! Read-only access to the present forces of single contacts: histories are not advanced, and nothing is changed.
//!
//! Velocities are those of the particles at the time of the clock, while the forces of the last step were evaluated at
//! half-step velocities: dashpot and rate-dependent parts differ by terms of the order of the step.

use super::{
    ByPair, Contact, ContactForce, ContactForceLaw, ContactModel, VanDerWaalsNow, WallLaws,
    lanes::overlap_and_normal, walls::contact_with,
};
use crate::domain::PosedWalls;
use crate::particles::{Body, ContactHistory, Contacts, Particles, kind_of_bodies};
use nalgebra::Vector3;

/// A pair that touches, or attracts each other without touching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairForce {
    /// The lower id.
    pub lower: u64,
    /// The higher id.
    pub higher: u64,
    /// Whether the two are in contact.
    pub touching: bool,
    /// Centre of the particle with the lower id, in the image that this rank holds.
    pub position: Vector3<f64>,
    /// Vector from that centre to the centre of the other.
    pub branch: Vector3<f64>,
    /// Overlap; a negative value is a separation.
    pub overlap: f64,
    /// Normal force of spring, dashpot and the law's own adhesion; positive if it pushes the two apart.
    pub normal: f64,
    /// Tangential force on the particle with the higher id.
    pub tangential: Vector3<f64>,
    /// Magnitude of the van der Waals attraction.
    pub cohesion: f64,
}

/// A particle and a wall that touch, or attract each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPairForce {
    /// Index of the particle on this rank.
    pub particle: u32,
    /// Number of the wall.
    pub wall: u32,
    /// Whether the two are in contact.
    pub touching: bool,
    /// Vector from the particle's centre to the contact point on the wall.
    pub branch: Vector3<f64>,
    /// Force on the particle by spring, dashpot and friction.
    pub contact: Vector3<f64>,
    /// Force on the particle by van der Waals attraction.
    pub cohesive: Vector3<f64>,
}

impl PairForce {
    /// Forces on the particle with the lower id: by spring, dashpot and friction, and by van der Waals attraction.
    #[inline(always)]
    pub fn on_lower(&self) -> [Vector3<f64>; 2] {
        // Unit vector from the lower to the higher.
        let direction = self.branch * (1.0 / self.branch.norm());
        [-(direction * self.normal + self.tangential), direction * self.cohesion]
    }
}

/// Passes the forces of all pairs of this rank that touch or attract each other to a function.
///
/// Before: ghosts have the velocities of their originals.
#[inline]
pub fn for_each_pair_force(
    particles: &Particles,
    contacts: &Contacts,
    models: &ByPair<ContactModel>,
    cohesion: Option<&ByPair<VanDerWaalsNow>>,
    mut take: impl FnMut(PairForce),
) {
    let attraction = |pair: [&Body; 2], overlap: f64| {
        let [one, two] = pair.map(|body| body.radius);
        let kind = kind_of_bodies(pair);
        cohesion.map_or(0.0, |laws| laws.of_kind(kind).between_particles(one, two, -overlap))
    };
    for (pair, history) in contacts.near_pairs() {
        // Most pairs of the list do not touch.
        if history.is_none() && cohesion.is_none() {
            continue;
        }
        let Ordered { pair, history } = ordered(particles, pair, history);
        let (one, two) = (&particles.body[pair[0]], &particles.body[pair[1]]);
        let (radii, position, other) = ([one.radius, two.radius], one.position, two.position);
        let (overlap, normal) = overlap_and_normal(other - position, radii);
        let cohesion = attraction([one, two], overlap);
        if history.is_none() && cohesion == 0.0 {
            continue;
        }
        let contact = contact_of(particles, pair, overlap, normal, cohesion);
        let force = history.map_or_else(ContactForce::zero, |mut history| {
            let law = &models.of_kind(kind_of_bodies([one, two])).law;
            law.force(&contact, &mut history, 0.0)
        });
        take(PairForce {
            lower: particles.id[pair[0]],
            higher: particles.id[pair[1]],
            touching: history.is_some(),
            position,
            branch: other - position,
            overlap,
            normal: force.normal,
            tangential: force.tangential,
            cohesion,
        });
    }
}

/// A pair by ascending ids, with its history seen from the first.
struct Ordered {
    pair: [usize; 2],
    history: Option<ContactHistory>,
}

/// A pair by ascending ids.
#[inline(always)]
fn ordered(
    particles: &Particles,
    [first, second]: [u32; 2],
    history: Option<ContactHistory>,
) -> Ordered {
    let pair = [first as usize, second as usize];
    if particles.id[pair[0]] < particles.id[pair[1]] {
        return Ordered { pair, history };
    }
    let reversed = |history: ContactHistory| ContactHistory {
        tangential_spring: -history.tangential_spring,
        ..history
    };
    Ordered { pair: [pair[1], pair[0]], history: history.map(reversed) }
}

/// The contact of two particles; the second body is the one with the higher id.
#[inline(always)]
fn contact_of(
    particles: &Particles,
    pair: [usize; 2],
    overlap: f64,
    normal: Vector3<f64>,
    cohesion: f64,
) -> Contact {
    let (i, j) = (&particles.body[pair[0]], &particles.body[pair[1]]);
    let surface_spin = i.angular_velocity * i.radius + j.angular_velocity * j.radius;
    let reduced = |one: f64, other: f64| one * other / (one + other);
    Contact {
        overlap,
        normal,
        relative_velocity: j.velocity - i.velocity - surface_spin.cross(&normal),
        relative_spin: j.angular_velocity - i.angular_velocity,
        reduced_mass: reduced(i.mass, j.mass),
        reduced_radius: reduced(i.radius, j.radius),
        reduced_inertia: reduced(i.inertia(), j.inertia()),
        cohesion,
    }
}

/// The forces of particles and walls that touch or attract each other, by the laws `at_wall` of a wall and a species.
pub fn wall_pair_forces<'a>(
    particles: &Particles,
    contacts: &Contacts,
    walls: PosedWalls<'_>,
    at_wall: impl Fn(usize, usize) -> WallLaws<'a>,
) -> Vec<WallPairForce> {
    let mut found = Vec::new();
    for (pair, history) in contacts.near_walls() {
        let body = &particles.body[pair.particle as usize];
        let WallLaws { contact: model, cohesion } = at_wall(pair.wall as usize, body.species());
        let contact = contact_with(walls, &pair, particles, cohesion);
        if history.is_none() && contact.cohesion == 0.0 {
            continue;
        }
        let law = &model.law;
        let force = history
            .map_or_else(ContactForce::zero, |mut history| law.force(&contact, &mut history, 0.0));
        found.push(WallPairForce {
            particle: pair.particle,
            wall: pair.wall,
            touching: history.is_some(),
            branch: contact.normal * (body.radius - contact.overlap),
            contact: -(contact.normal * force.normal + force.tangential),
            cohesive: contact.normal * contact.cohesion,
        });
    }
    found
}
