//! The loop over particles at walls.

use super::force_laws::{ForceLaws, ForceOutOfRange, out_of_range};
use super::rolling::Rolling;
use super::{Contact, ContactForce, ContactForceLaw, ContactModel, VanDerWaalsNow, WallTallies};
use crate::domain::{PosedWalls, Wall, WallPose};
use crate::numbers::within;
use crate::particles::{ContactHistory, Contacts, Particles};
use nalgebra::Vector3;

/// Adds the forces and torques of walls on particles; tallies the force on each wall.
///
/// A wall is a contact partner of infinite mass and radius (m* = m, R* = r, I* = I) with its own law, attraction and
/// velocity. Beyond the range of any force the law is not asked, unless a contact still has to end.
///
/// # Errors
/// If a force exceeds the limit or is undefined.
pub(crate) fn add_wall_forces(
    particles: &mut Particles,
    contacts: &mut Contacts,
    walls: PosedWalls<'_>,
    laws: &ForceLaws,
    on_walls: &mut WallTallies,
) -> Result<(), ForceOutOfRange> {
    on_walls.clear();
    for slot in 0..contacts.wall_pairs.len() {
        let pair = contacts.wall_pairs[slot];
        let (i, number) = (pair.particle as usize, pair.wall as usize);
        let (wall, pose, body) = (&walls.walls[number], &walls.poses[number], &particles.body[i]);
        let separation = wall.height_at(&body.position, pose) - body.radius;
        if separation > laws.ranges.any && !contacts.wall_touching[slot] {
            continue;
        }
        let at_wall = laws.at_wall(number, body.species());
        let contact = contact_with(wall, pose, particles, i, at_wall.cohesion);
        let (force, rolling) = evaluate(at_wall.contact, &contact, contacts, slot, laws.dt);
        let on_wall =
            laws.force_quantum.round_vector(total_force(&contact, force.normal, force.tangential));
        if !within(&on_wall, laws.limit) {
            let other = format!("wall \"{}\"", walls.walls[number].name);
            let overlap = contact.overlap;
            return Err(out_of_range(particles.id[i], other, on_wall, overlap, laws.limit));
        }
        particles.forces[i].force -= on_wall;
        let twist = contact.normal.cross(&force.tangential) * particles.body[i].radius + rolling;
        particles.forces[i].torque -= laws.torque_quantum.round_vector(twist);
        let counts = [0, 1, 2].map(|axis| laws.force_quantum.count(on_wall[axis]));
        on_walls.add(number, particles.body[i].radius, counts);
    }
    Ok(())
}

/// The contact of a particle and a wall.
pub(super) fn contact_with(
    wall: &Wall,
    pose: &WallPose,
    particles: &Particles,
    i: usize,
    cohesion: Option<VanDerWaalsNow>,
) -> Contact {
    let radius = particles.body[i].radius;
    let position = &particles.body[i].position;
    let overlap = radius - wall.height_at(position, pose);
    let spin = particles.body[i].angular_velocity;
    let normal = -wall.normal_at(position, pose);
    Contact {
        overlap,
        normal,
        relative_velocity: pose.velocity
            - particles.body[i].velocity
            - (spin * radius).cross(&normal),
        relative_spin: -spin,
        reduced_mass: particles.body[i].mass,
        reduced_radius: radius,
        reduced_inertia: particles.inertia(i),
        cohesion: cohesion.map_or(0.0, |cohesion| cohesion.to_wall(radius, -overlap)),
    }
}

/// Force and rolling torque on the wall; advances the history of the contact, or clears it.
fn evaluate(
    model: &ContactModel,
    contact: &Contact,
    contacts: &mut Contacts,
    slot: usize,
    dt: f64,
) -> (ContactForce, Vector3<f64>) {
    let ContactModel { law, rolling, twisting, .. } = model;
    let history: &mut ContactHistory = &mut contacts.wall_history[slot];
    let angle = &mut contacts.wall_rolling_angle[slot];
    let twisting_angle = &mut contacts.wall_twisting_angle[slot];
    if !law.touches(contact, history) {
        contacts.wall_touching[slot] = false;
        *history = ContactHistory::default();
        (*angle, *twisting_angle) = (Vector3::zeros(), 0.0);
        return (ContactForce::zero(), Vector3::zeros());
    }
    contacts.wall_touching[slot] = true;
    let force = law.force(contact, history, dt);
    let limiting = force.friction_normal;
    let stiffness = || law.stiffness_over(contact, dt);
    let mut torque = match rolling {
        Some(rolling) => rolling.torque(contact, limiting, stiffness(), angle, dt),
        None => {
            *angle = Vector3::zeros();
            Vector3::zeros()
        }
    };
    match twisting {
        Some(twisting) => {
            let twist = twisting.torque(contact, limiting, stiffness(), twisting_angle, dt);
            torque += contact.normal * twist;
        }
        None => *twisting_angle = 0.0,
    }
    (force, torque)
}

/// Force of contact and attraction on the wall.
#[inline(always)]
pub(super) fn total_force(
    contact: &Contact,
    normal: f64,
    tangential: Vector3<f64>,
) -> Vector3<f64> {
    contact.normal * (normal - contact.cohesion) + tangential
}
