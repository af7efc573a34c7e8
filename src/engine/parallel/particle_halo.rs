//! Ghosts: copies of the particles near the faces of this rank's subdomain that other ranks own, and periodic images.
//!
//! A rank only has those ghosts that are [ahead](Subdomain::is_ahead) of its subdomain: the others are in pairs that
//! other ranks evaluate, or that are found through an image of the other particle.
//!
//! When lists are made, ghosts are sent axis by axis: those received along one axis are sent on along the next, so that
//! edges and corners need no messages of their own. Each ghost records where its original is. For the ghosts that are
//! in a pair of its list, each rank then names the originals to their owners. At a step an owner sends the velocities
//! of such a particle once, whatever the number of its copies; the copies move by these velocities exactly as the
//! original did, bit for bit. The forces on copies are sent back the other way.

mod columns;

use self::columns::{TO_NEW_GHOSTS, give_to_new_ghost, new_ghost_bytes, returned_bytes};
use super::records::{GhostForces, GhostVelocities, NewGhost, Origin};
use super::{AxisNeighbours, Communicator, Exchange, Message, Pending, records_of_bytes};
use crate::domain::Subdomain;
use crate::fields::Travel;
use crate::particles::{DriftStep, ForceTorque, Particles, drift_copies, follow_originals};
use nalgebra::Vector3;

/// The ghosts of this rank and of others, from one rebuild of the neighbour list to the next.
#[derive(Debug, Default)]
pub struct ParticleHalo {
    /// Where the originals of the ghosts are.
    origins: Vec<Origin>,
    images: Vec<Images>,
    copies: Vec<Copies>,
    /// The particles of this rank of which other ranks have copies, for each of these ranks.
    exported: Vec<Vec<u32>>,
    /// Velocities of the exported particles, sent to those ranks, and of the copies, received from their owners, in the
    /// order of `exported` and of `copies`.
    velocities: Exchange,
    /// Forces on the copies, sent to their owners, and on exported particles, received from other ranks.
    forces: Exchange,
}

/// Periodic images of owned particles with the same shift: ghost and original.
#[derive(Clone, Debug)]
struct Images {
    /// Shift along x, y and z, and a zero.
    shift: [f64; 4],
    pairs: Vec<[u32; 2]>,
}

/// The ghosts that are copies of particles of one other rank: the place of the particle in that rank's message, and the
/// index of the ghost.
type Copies = Vec<[u32; 2]>;

/// The particles that are sent to one neighbour along an axis, and their shift if it is beyond a periodic face.
struct SendList {
    indices: Vec<u32>,
    shift: f64,
}

impl ParticleHalo {
    /// Makes ghosts of all particles within `width` of this rank's subdomain that are ahead of it. This call is
    /// collective.
    ///
    /// Before: each rank owns the particles of its subdomain, wrapped, and has no ghosts. After: the ghosts follow the
    /// owned particles, with current position (of the image), velocity, angular velocity, radius and mass; none is
    /// updated before [`ParticleHalo::follow`].
    pub fn make_ghosts(
        &mut self,
        particles: &mut Particles,
        subdomain: Subdomain,
        width: f64,
        ranks: &dyn Communicator,
    ) {
        self.origins.clear();
        let axes = (0..3).filter(|&axis| subdomain.neighbours(axis) != [None, None]);
        let last = axes.clone().next_back();
        for axis in axes {
            let list = |side| {
                if side == 1 && last == Some(axis) {
                    // Ghosts that were sent up would be behind the rank above, and are not sent on.
                    SendList { indices: Vec::new(), shift: 0.0 }
                } else {
                    send_list(particles, subdomain, width, axis, side)
                }
            };
            let (lists, neighbours) = ([0, 1].map(list), subdomain.neighbours(axis));
            self.send_new_ghosts((axis, neighbours), &lists, particles, ranks);
        }
        let is_ahead = subdomain.is_ahead();
        let ghosts = particles.owned_count() as u32..particles.count() as u32;
        let ahead: Vec<u32> =
            ghosts.filter(|&ghost| is_ahead(&particles.body[ghost as usize].position)).collect();
        particles.keep_ghosts(&ahead);
        let owned = particles.owned_count();
        self.origins = ahead.iter().map(|&ghost| self.origins[ghost as usize - owned]).collect();
    }

    /// Selects the ghosts that are updated from now on: those for whose index `is_followed` holds. This call is
    /// collective.
    pub fn follow(
        &mut self,
        particles: &Particles,
        is_followed: impl Fn(usize) -> bool,
        ranks: &dyn Communicator,
    ) {
        let asked = self.divide(particles, is_followed, ranks.rank() as u32);
        if ranks.size() > 1 {
            self.ask_owners(&asked, particles, ranks);
        }
    }

    /// Updates velocity and angular velocity of the selected ghosts, and the position of images. This call is
    /// collective.
    ///
    /// Before: owned particles are current, the ghosts are those of the last rebuild, and copies are where their
    /// originals are.
    pub fn refresh(&mut self, particles: &mut Particles, ranks: &dyn Communicator) {
        self.pack_velocities(particles);
        self.velocities.complete(ranks);
        for (message, copies) in self.velocities.incoming.iter().zip(&self.copies) {
            for &[place, ghost] in copies {
                let velocities: GhostVelocities = message.record(place as usize);
                velocities.give_to(&mut particles.body[ghost as usize]);
            }
        }
        self.give_numbers_to_copies(particles);
    }

    /// Updates images from their originals, and puts the velocities that other ranks need into the messages to them.
    pub fn pack_velocities(&mut self, particles: &mut Particles) {
        for Images { shift, pairs } in &self.images {
            follow_originals(&mut particles.body, pairs, *shift);
        }
        for (message, exported) in self.velocities.outgoing.iter_mut().zip(&self.exported) {
            let of_particle = |&index| GhostVelocities::of(&particles.body[index as usize]);
            message.overwrite(exported.iter().map(of_particle));
        }
        self.pack_numbers(particles);
    }

    /// Sends the velocities. This call is collective, as is [`ParticleHalo::receive_velocities`].
    pub fn send_velocities<'r>(&mut self, ranks: &'r dyn Communicator) -> Pending<'r, Exchange> {
        self.velocities.start(ranks)
    }

    /// Waits for the velocities of the copies.
    pub fn receive_velocities(&mut self, velocities: Pending<'_, Exchange>) {
        self.velocities = velocities.finish();
    }

    /// Gives the copies the received velocities, and moves each as its original was moved.
    pub(crate) fn drift_copies(&self, particles: &mut Particles, step: DriftStep) {
        for (message, copies) in self.velocities.incoming.iter().zip(&self.copies) {
            let velocities = |place| {
                let GhostVelocities { velocity, angular_velocity } = message.record(place);
                [velocity, angular_velocity]
            };
            drift_copies(&mut particles.body, copies, velocities, step);
        }
        self.give_numbers_to_copies(particles);
    }

    /// Moves the forces on copies into the messages to their owners.
    pub fn pack_forces(&mut self, particles: &mut Particles) {
        for (message, copies) in self.forces.outgoing.iter_mut().zip(&self.copies) {
            let taken = |of_particle: &[[u32; 2]]| {
                let mut sum = ForceTorque::default();
                for &[_, ghost] in of_particle {
                    sum += std::mem::take(&mut particles.forces[ghost as usize]);
                }
                GhostForces::of(&sum)
            };
            message.overwrite(by_particle(copies).map(taken));
        }
        self.pack_returned(particles);
    }

    /// Sends the forces. This call is collective, as is [`ParticleHalo::receive_forces`].
    pub fn return_forces<'r>(&mut self, ranks: &'r dyn Communicator) -> Pending<'r, Exchange> {
        self.forces.start(ranks)
    }

    /// Waits for the forces on particles of this rank.
    pub fn receive_forces(&mut self, forces: Pending<'_, Exchange>) {
        self.forces = forces.finish();
    }

    /// Adds the received forces to the owned particles. Sums are exact, so the order of the ranks changes no bit.
    pub fn unpack_forces(&self, particles: &mut Particles) {
        for (message, exported) in self.forces.incoming.iter().zip(&self.exported) {
            for (forces, &index) in records_of_bytes::<GhostForces>(&message.bytes).zip(exported) {
                particles.forces[index as usize] += forces.force_and_torque();
            }
        }
        self.add_returned(particles);
    }

    /// Adds the counts of copies to those of their originals, on the ranks that own these. `counts` has an entry for
    /// every particle of this rank, owned ones and ghosts. This call is collective.
    pub fn return_counts(&self, counts: &mut [u32], ranks: &dyn Communicator) {
        let to_owner = |(message, copies): (&Message, &Copies)| {
            let of_particle = |same: &[[u32; 2]]| -> u32 {
                same.iter().map(|&[_, ghost]| counts[ghost as usize]).sum()
            };
            let sums = by_particle(copies).map(of_particle);
            Message::of(message.rank, &sums.collect::<Vec<u32>>())
        };
        let outgoing = self.forces.outgoing.iter().zip(&self.copies).map(to_owner);
        let room = |(message, exported): (&Message, &Vec<u32>)| Message::of(message.rank, exported);
        let incoming = self.forces.incoming.iter().zip(&self.exported).map(room);
        let mut exchange = Exchange { outgoing: outgoing.collect(), incoming: incoming.collect() };
        exchange.complete(ranks);
        for (message, exported) in exchange.incoming.iter().zip(&self.exported) {
            for (count, &index) in records_of_bytes::<u32>(&message.bytes).zip(exported) {
                counts[index as usize] += count;
            }
        }
    }

    /// Sends the particles of both lists to the neighbours along an axis, and adds the received particles as ghosts.
    fn send_new_ghosts(
        &mut self,
        (axis, neighbours): (usize, AxisNeighbours),
        lists: &[SendList; 2],
        particles: &mut Particles,
        ranks: &dyn Communicator,
    ) {
        let (here, owned) = (ranks.rank() as u32, particles.owned_count());
        let outgoing = lists.each_ref().map(|list| {
            let mut bytes = Vec::with_capacity(list.indices.len() * new_ghost_bytes(particles));
            let mut numbers = Vec::new();
            for &index in &list.indices {
                let index = index as usize;
                let origin = if index < owned {
                    Origin { rank: here, index: index as u32 }
                } else {
                    self.origins[index - owned]
                };
                let mut ghost = NewGhost::of(particles, index, origin);
                ghost.position[axis] += list.shift; // exact: both are multiples of the quantum
                bytes.extend_from_slice(bytemuck::bytes_of(&ghost));
                numbers.clear();
                for travel in TO_NEW_GHOSTS {
                    particles.columns.append_row(travel, index, &mut numbers);
                }
                bytes.extend_from_slice(bytemuck::cast_slice(&numbers));
            }
            bytes
        });
        let outgoing = [&outgoing[0][..], &outgoing[1][..]];
        let mut incoming = [Vec::new(), Vec::new()];
        ranks.exchange(neighbours, outgoing, &mut incoming);
        let arrived: usize = incoming.iter().map(Vec::len).sum();
        let row = new_ghost_bytes(particles);
        particles.make_room_for_ghosts(arrived / row);
        for bytes in incoming.iter().flat_map(|bytes| bytes.chunks_exact(row)) {
            let (ghost, numbers) = bytes.split_at(size_of::<NewGhost>());
            let ghost: NewGhost = bytemuck::pod_read_unaligned(ghost);
            let is_image = ghost.origin.rank == here;
            let image_of = is_image.then_some(ghost.origin.index as usize);
            particles.push_ghost(ghost.id, ghost.body(), image_of);
            give_to_new_ghost(particles, numbers);
            self.origins.push(ghost.origin);
        }
    }

    /// Divides the selected ghosts into images of owned particles and copies of particles of other ranks. Returns for
    /// each owner of copies the message that names their originals.
    fn divide(
        &mut self,
        particles: &Particles,
        is_followed: impl Fn(usize) -> bool,
        here: u32,
    ) -> Vec<Message> {
        self.images.clear();
        let mut copies = Vec::new();
        for ghost in
            (particles.owned_count()..particles.count()).filter(|&ghost| is_followed(ghost))
        {
            let origin = self.origins[ghost - particles.owned_count()];
            if origin.rank == here {
                let [image, original] =
                    [ghost, origin.index as usize].map(|index| particles.body[index].position);
                self.add_image([ghost as u32, origin.index], image - original);
            } else {
                copies.push((origin, ghost as u32));
            }
        }
        copies.sort_unstable();
        self.copies.clear();
        let mut messages = Vec::new();
        for of_rank in copies.chunk_by(|(one, _), (other, _)| one.rank == other.rank) {
            let mut asked: Vec<u32> = of_rank.iter().map(|(origin, _)| origin.index).collect();
            asked.dedup();
            let mut place = 0;
            let place_of = |&(origin, ghost): &(Origin, u32)| {
                while asked[place] != origin.index {
                    place += 1;
                }
                [place as u32, ghost]
            };
            self.copies.push(of_rank.iter().map(place_of).collect());
            messages.push(Message::of(of_rank[0].0.rank as usize, &asked));
        }
        messages
    }

    fn add_image(&mut self, pair: [u32; 2], shift: Vector3<f64>) {
        let shift = [shift.x, shift.y, shift.z, 0.0];
        // Ghosts of one shift follow each other, except for those of edges and corners.
        let known = self.images.iter_mut().rev().find(|images| images.shift == shift);
        match known {
            Some(images) => images.pairs.push(pair),
            None => self.images.push(Images { shift, pairs: vec![pair] }),
        }
    }

    /// Sends the indices of the originals to the owners of copies, and prepares the messages of a step. This call is
    /// collective.
    fn ask_owners(&mut self, asked: &[Message], particles: &Particles, ranks: &dyn Communicator) {
        let asked_here = ranks.sparse_exchange(asked);
        let indices = |message: &Message| records_of_bytes(&message.bytes).collect();
        self.exported = asked_here.iter().map(indices).collect();
        let lengths = |messages: &[Message], of_particle: usize| -> Vec<(usize, usize)> {
            let count = |message: &Message| message.bytes.len() / size_of::<u32>();
            messages.iter().map(|message| (message.rank, count(message) * of_particle)).collect()
        };
        let [sent, returned] =
            [Travel::EachStep, Travel::Returned].map(|travel| particles.columns.width_of(travel));
        let sent = size_of::<GhostVelocities>() + sent * size_of::<f64>();
        self.velocities = Exchange::with_lengths(lengths(&asked_here, sent), lengths(asked, sent));
        let returned = returned_bytes(returned);
        self.forces =
            Exchange::with_lengths(lengths(asked, returned), lengths(&asked_here, returned));
    }
}

/// The copies of each particle; those of one particle follow each other, since they are in the order of their places.
fn by_particle(copies: &Copies) -> impl Iterator<Item = &[[u32; 2]]> {
    copies.chunk_by(|[one, _], [other, _]| one == other)
}

/// The particles that become ghosts of the neighbour on one side along an axis; none if there is no neighbour.
fn send_list(
    particles: &Particles,
    subdomain: Subdomain,
    width: f64,
    axis: usize,
    side: usize,
) -> SendList {
    let ([lower, upper], length) = (subdomain.corners(), subdomain.bounds.lengths()[axis]);
    let shift = match side {
        0 if lower[axis] == 0.0 => length,
        1 if upper[axis] == length => -length,
        _ => 0.0,
    };
    let near_face = |index: &u32| {
        let position = particles.body[*index as usize].position[axis];
        match side {
            0 => position - lower[axis] < width,
            _ => upper[axis] - position <= width,
        }
    };
    let indices = match subdomain.neighbours(axis)[side] {
        Some(_) => (0..particles.count() as u32).filter(near_face).collect(),
        None => Vec::new(),
    };
    SendList { indices, shift }
}

#[cfg(test)]
mod tests;
