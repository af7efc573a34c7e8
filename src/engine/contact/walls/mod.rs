//! The loop over particles at walls.

mod block;
mod geometry;
mod mesh;
mod search;

pub(crate) use self::block::{WallLoop, add_wall};
use self::geometry::WallNow;
pub(crate) use self::mesh::find_mesh_contacts;
use self::search::find_acting;
use super::force_laws::{ForceLaws, ForceOutOfRange, PairLaws, WallLaws};
use super::{Contact, VanDerWaalsNow, WallTallies};
use crate::domain::PosedWalls;
use crate::particles::{Contacts, Particles, WallPair};
use nalgebra::Vector3;

/// Adds the forces and torques of walls on particles; tallies the force on each wall.
///
/// A wall is a contact partner of infinite mass and radius (m* = m, R* = r, I* = I) with its own law, attraction and
/// velocity. Beyond the range of any force the law is not evaluated, unless a contact still has to end.
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
    let (mut start, mut acting) = (0, Vec::new());
    while let Some(&first) = contacts.wall_pairs.get(start) {
        let number = first.wall as usize;
        let alike = contacts.wall_pairs[start..].partition_point(|pair| pair.is_like(&first));
        let slots = start..start + alike;
        let wall = WallNow { number, wall: &walls.walls[number], pose: &walls.poses[number] };
        let range = laws.ranges.any;
        acting.clear();
        if wall.wall.mesh().is_some() {
            let acts = |&slot: &usize| contacts.wall_acts[slot] || contacts.wall_touching[slot];
            acting.extend(slots.filter(acts).map(|slot| slot as u32));
        } else {
            find_acting(particles, contacts, slots, wall, range, &mut acting);
        }
        let WallLaws { contact, cohesion } = laws.at_wall(number, first.species as usize);
        let ForceLaws { dt, limit, force_quantum, torque_quantum, .. } = *laws;
        contact.law.as_block_law().add_wall(WallLoop {
            particles,
            contacts,
            acting: &acting,
            wall,
            laws: PairLaws { contact, cohesion, dt, limit, force_quantum, torque_quantum },
            on_walls,
        })?;
        start += alike;
    }
    Ok(())
}

/// The contact of a particle and a wall.
pub(super) fn contact_with(
    walls: PosedWalls<'_>,
    pair: &WallPair,
    particles: &Particles,
    cohesion: Option<VanDerWaalsNow>,
) -> Contact {
    let (number, i) = (pair.wall as usize, pair.particle as usize);
    let (wall, pose) = (&walls.walls[number], &walls.poses[number]);
    let radius = particles.body[i].radius;
    let position = &particles.body[i].position;
    let (height, into_bed) = wall.height_and_normal(position, pose, pair.facet);
    let overlap = radius - height;
    let spin = particles.body[i].angular_velocity;
    let normal = -into_bed;
    Contact {
        overlap,
        normal,
        relative_velocity: pose.velocity_at(&(position + normal * height))
            - particles.body[i].velocity
            - (spin * radius).cross(&normal),
        relative_spin: pose.turn.map_or(-spin, |turn| turn.angular_velocity - spin),
        reduced_mass: particles.body[i].mass,
        reduced_radius: radius,
        reduced_inertia: particles.inertia(i),
        cohesion: cohesion.map_or(0.0, |cohesion| cohesion.to_wall(radius, -overlap)),
    }
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

#[cfg(test)]
mod tests;
