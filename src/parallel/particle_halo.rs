//! Ghosts: copies of the particles beyond this rank's borders, and periodic images.
//!
//! They travel axis by axis, what came along one axis being passed on along the next, so that edges and
//! corners need no messages of their own.

use super::records_of_bytes;
use super::{AxisNeighbours, Communicator};
use crate::domain::Subdomain;
use crate::particles::Particles;
use bytemuck::{Pod, Zeroable};
use nalgebra::Vector3;

/// A ghost as it is first sent.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct NewGhost {
    id: u64,
    radius: f64,
    mass: f64,
    motion: GhostMotion,
}

/// What a ghost needs at every step.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct GhostMotion {
    position: [f64; 3],
    velocity: [f64; 3],
    angular_velocity: [f64; 3],
}

/// Which particles go to one neighbour, and by how much they shift on the way through a periodic face.
#[derive(Clone, Debug, Default)]
struct Shipment {
    indices: Vec<u32>,
    shift: f64,
}

/// One axis: shipments down and up, and where the ghosts that come from there begin.
#[derive(Clone, Debug, Default)]
struct AxisPlan {
    neighbours: AxisNeighbours,
    shipments: [Shipment; 2],
    first_ghost: [usize; 2],
}

/// Who is whose ghost, from one rebuild of the neighbour list to the next.
#[derive(Debug, Default)]
pub struct ParticleHalo {
    plans: [AxisPlan; 3],
    outgoing: [Vec<u8>; 2],
    incoming: [Vec<u8>; 2],
}

impl ParticleHalo {
    /// Chooses the ghosts anew: every particle within `width` of this rank's block.
    ///
    /// Before: each rank owns the particles of its block, wrapped, and has no ghosts. After: ghosts follow
    /// the owned particles, with current position (of the image), velocity and spin, radius and mass.
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
            for (side, shipment) in plan.shipments.iter_mut().enumerate() {
                shipment.shift = match (at_end[side], side) {
                    (false, _) => 0.0,
                    (true, 0) => length,
                    (true, _) => -length,
                };
                shipment.indices.clear();
                if plan.neighbours[side].is_none() {
                    continue;
                }
                let near_border = |position: &Vector3<f64>| match side {
                    0 => position[axis] - lower[axis] < width,
                    _ => upper[axis] - position[axis] <= width,
                };
                let chosen =
                    (0..particles.count()).filter(|&i| near_border(&particles.body[i].position));
                shipment.indices.extend(chosen.map(|i| i as u32));
            }
            self.send_new_ghosts(axis, particles, ranks);
        }
    }

    /// Brings position, velocity and spin of all ghosts up to date.
    ///
    /// Before: owned particles are current; the halo is that of the last rebuild. After: ghosts equal their
    /// owners; their order is unchanged.
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
            for (shipment, buffer) in plan.shipments.iter().zip(&mut self.outgoing) {
                buffer.clear();
                for &index in &shipment.indices {
                    let motion = motion_of(particles, index as usize, axis, shipment.shift);
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
        for (shipment, buffer) in plan.shipments.iter().zip(&mut self.outgoing) {
            buffer.clear();
            for &index in &shipment.indices {
                let index = index as usize;
                let ghost = NewGhost {
                    id: particles.id[index],
                    radius: particles.body[index].radius,
                    mass: particles.body[index].mass,
                    motion: motion_of(particles, index, axis, shipment.shift),
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
                // What comes from below was sent up.
                let source = || plan.shipments[1 - side].indices[row] as usize;
                let image_of = from_here.then(source);
                let index = particles.count();
                let motion = &ghost.motion;
                let (position, velocity) = (motion.position.into(), motion.velocity.into());
                let size = (ghost.radius, ghost.mass);
                particles.push_ghost(ghost.id, position, velocity, size, image_of);
                set_motion(particles, index, motion);
            }
        }
    }
}

/// Along an axis that this rank spans alone, ghosts are copied from their originals.
fn refresh_images(plan: &AxisPlan, axis: usize, particles: &mut Particles) {
    for (side, &first) in plan.first_ghost.iter().enumerate() {
        let shipment = &plan.shipments[1 - side];
        for (row, &source) in shipment.indices.iter().enumerate() {
            let (source, ghost) = (source as usize, first + row);
            particles.body[ghost] = particles.body[source];
            particles.body[ghost].position[axis] += shipment.shift;
        }
    }
}

fn motion_of(particles: &Particles, index: usize, axis: usize, shift: f64) -> GhostMotion {
    let mut position: [f64; 3] = particles.body[index].position.into();
    position[axis] += shift; // exact: both are lattice numbers
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
