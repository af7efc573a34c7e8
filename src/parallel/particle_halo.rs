//! Ghosts: copies of the particles near the faces of this rank's subdomain that other ranks own, and periodic images.
//!
//! They are exchanged axis by axis. Ghosts received along one axis are sent on along the next, so that edges and
//! corners need no messages of their own.

use super::{AxisNeighbours, Communicator, GhostMotion, NewGhost, records_of_bytes};
use crate::domain::Subdomain;
use crate::particles::{Body, Particles};
use nalgebra::Vector3;

/// The particles that are sent to one neighbour, and their shift along the axis if that is beyond a periodic face.
#[derive(Clone, Debug, Default)]
struct SendList {
    indices: Vec<u32>,
    shift: f64,
}

/// One axis: what is sent down and up, and the index of the first ghost received from below and from above.
#[derive(Clone, Debug, Default)]
struct AxisPlan {
    neighbours: AxisNeighbours,
    send_lists: [SendList; 2],
    first_ghost: [usize; 2],
}

/// The ghosts of this rank and of its neighbours, from one rebuild of the neighbour list to the next.
#[derive(Debug, Default)]
pub struct ParticleHalo {
    plans: [AxisPlan; 3],
    outgoing: [Vec<u8>; 2],
    incoming: [Vec<u8>; 2],
}

impl ParticleHalo {
    /// Chooses the ghosts: every particle within `width` of this rank's subdomain. This call is collective.
    ///
    /// Before: each rank owns the particles of its subdomain, wrapped, and has no ghosts. After: the ghosts
    /// follow the owned particles, with current position (of the image), velocity, angular velocity, radius and mass.
    pub fn rebuild(
        &mut self,
        particles: &mut Particles,
        subdomain: Subdomain,
        width: f64,
        ranks: &dyn Communicator,
    ) {
        let [lower, upper] = subdomain.corners();
        for axis in 0..3 {
            let plan = &mut self.plans[axis];
            plan.neighbours = subdomain.neighbours(axis);
            let length = subdomain.bounds.lengths()[axis];
            let at_end = [lower[axis] == 0.0, upper[axis] == length];
            for (side, send_list) in plan.send_lists.iter_mut().enumerate() {
                send_list.shift = match (at_end[side], side) {
                    (false, _) => 0.0,
                    (true, 0) => length,
                    (true, _) => -length,
                };
                send_list.indices.clear();
                if plan.neighbours[side].is_none() {
                    continue;
                }
                let near_face = |position: &Vector3<f64>| match side {
                    0 => position[axis] - lower[axis] < width,
                    _ => upper[axis] - position[axis] <= width,
                };
                let chosen =
                    (0..particles.count()).filter(|&i| near_face(&particles.body[i].position));
                send_list.indices.extend(chosen.map(|i| i as u32));
            }
            self.send_new_ghosts(axis, particles, ranks);
        }
    }

    /// Updates position, velocity and angular velocity of all ghosts. This call is collective.
    ///
    /// Before: owned particles are current, and the ghosts are those of the last rebuild. After: ghosts equal their
    /// originals; their order is unchanged.
    pub fn refresh(&mut self, particles: &mut Particles, ranks: &dyn Communicator) {
        for axis in 0..3 {
            let plan = &self.plans[axis];
            if plan.neighbours == [None, None] {
                continue;
            }
            if plan.neighbours == [Some(ranks.rank()); 2] {
                refresh_images(plan, axis, particles);
                continue;
            }
            for (send_list, buffer) in plan.send_lists.iter().zip(&mut self.outgoing) {
                buffer.clear();
                for &index in &send_list.indices {
                    let motion = motion_of(particles, index as usize, axis, send_list.shift);
                    buffer.extend_from_slice(bytemuck::bytes_of(&motion));
                }
            }
            let outgoing = [&self.outgoing[0][..], &self.outgoing[1][..]];
            ranks.exchange(plan.neighbours, outgoing, &mut self.incoming);
            for (&first, buffer) in plan.first_ghost.iter().zip(&self.incoming) {
                for (offset, motion) in records_of_bytes::<GhostMotion>(buffer).enumerate() {
                    set_motion(particles, first + offset, &motion);
                }
            }
        }
    }

    fn send_new_ghosts(
        &mut self,
        axis: usize,
        particles: &mut Particles,
        ranks: &dyn Communicator,
    ) {
        let plan = &mut self.plans[axis];
        if plan.neighbours == [None, None] {
            return;
        }
        for (send_list, buffer) in plan.send_lists.iter().zip(&mut self.outgoing) {
            buffer.clear();
            for &index in &send_list.indices {
                let index = index as usize;
                let ghost = NewGhost {
                    id: particles.id[index],
                    radius: particles.body[index].radius,
                    mass: particles.body[index].mass,
                    species: particles.body[index].species() as f64,
                    motion: motion_of(particles, index, axis, send_list.shift),
                };
                buffer.extend_from_slice(bytemuck::bytes_of(&ghost));
            }
        }
        let outgoing = [&self.outgoing[0][..], &self.outgoing[1][..]];
        ranks.exchange(plan.neighbours, outgoing, &mut self.incoming);
        for (side, buffer) in self.incoming.iter().enumerate() {
            plan.first_ghost[side] = particles.count();
            let from_here = plan.neighbours[side] == Some(ranks.rank());
            for (row, ghost) in records_of_bytes::<NewGhost>(buffer).enumerate() {
                // Ghosts received from below were sent upwards.
                let source = || plan.send_lists[1 - side].indices[row] as usize;
                let image_of = from_here.then(source);
                let index = particles.count();
                let motion = &ghost.motion;
                let (position, velocity) = (motion.position.into(), motion.velocity.into());
                let body = Body::new(position, velocity, ghost.radius, ghost.mass);
                let body = body.of_species(ghost.species as usize);
                particles.push_ghost(ghost.id, body, image_of);
                set_motion(particles, index, motion);
            }
        }
    }
}

/// Along an axis that is not divided, ghosts are copied from their originals.
fn refresh_images(plan: &AxisPlan, axis: usize, particles: &mut Particles) {
    for (side, &first) in plan.first_ghost.iter().enumerate() {
        let send_list = &plan.send_lists[1 - side];
        for (row, &source) in send_list.indices.iter().enumerate() {
            let (source, ghost) = (source as usize, first + row);
            particles.body[ghost] = particles.body[source];
            particles.body[ghost].position[axis] += send_list.shift;
        }
    }
}

fn motion_of(particles: &Particles, index: usize, axis: usize, shift: f64) -> GhostMotion {
    let mut position: [f64; 3] = particles.body[index].position.into();
    position[axis] += shift; // exact: both are multiples of the quantum of positions
    GhostMotion {
        position,
        velocity: particles.body[index].velocity.into(),
        angular_velocity: particles.body[index].angular_velocity.into(),
    }
}

fn set_motion(particles: &mut Particles, index: usize, motion: &GhostMotion) {
    particles.body[index].position = motion.position.into();
    particles.body[index].velocity = motion.velocity.into();
    particles.body[index].angular_velocity = motion.angular_velocity.into();
}
