//! Ghosts: copies of the particles near the faces of this rank's subdomain that other ranks own, and periodic images.
//!
//! A rank has those of them that are [ahead](Subdomain::is_ahead) of its subdomain: the others are in pairs that other ranks
//! evaluate, or that are met through an image of the other particle.
//!
//! When lists are made, ghosts are sent axis by axis: those received along one axis are sent on along the next, so that
//! edges and corners need no messages of their own. Each says where its original is, and each rank then tells the owners
//! of those ghosts that are in a pair of its list which particles they are copies of. At a step an owner sends the
//! velocities of such a particle once, whatever the number of its copies; these move by them as the original did, to the
//! bit. The forces on copies then go back the other way.

use super::records::{GhostForces, GhostVelocities, NewGhost, Origin};
use super::{AxisNeighbours, Communicator, Exchange, Message, Pending, records_of_bytes};
use crate::domain::Subdomain;
use crate::particles::{DriftStep, ForceTorque, Particles, drift_copies, follow_originals};
use nalgebra::Vector3;

/// The ghosts of this rank and of others, from one rebuild of the neighbour list to the next.
#[derive(Debug, Default)]
pub struct ParticleHalo {
    /// Where the originals of the ghosts are.
    origins: Vec<Origin>,
    images: Vec<Images>,
    copies: Vec<Copies>,
    /// For each rank that has copies of this rank's particles, which particles these are.
    exported: Vec<Vec<u32>>,
    /// Velocities of these particles go to those ranks, velocities of the copies come from their owners, in the order of
    /// `exported` and of `copies`.
    velocities: Exchange,
    /// Forces on the copies go to their owners, forces on exported particles come back.
    forces: Exchange,
}

/// Periodic images of owned particles, by one shift: ghost and original.
#[derive(Clone, Debug)]
struct Images {
    /// Along x, y and z, and zero.
    shift: [f64; 4],
    pairs: Vec<[u32; 2]>,
}

/// The ghosts that are copies of particles of one other rank: the place of the particle in that rank's message, and the
/// index of the ghost.
type Copies = Vec<[u32; 2]>;

/// The particles that are sent to one neighbour along an axis, and their shift if that is beyond a periodic face.
struct SendList {
    indices: Vec<u32>,
    shift: f64,
}

impl ParticleHalo {
    /// Makes ghosts of all particles within `width` of this rank's subdomain that are ahead of it. This call is collective.
    ///
    /// Before: each rank owns the particles of its subdomain, wrapped, and has no ghosts. After: the ghosts
    /// follow the owned particles, with current position (of the image), velocity, angular velocity, radius and mass; none
    /// is brought up to date before [`ParticleHalo::follow`].
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
            let list = |side| match side == 1 && last == Some(axis) {
                // What went up would be behind the rank above, and is sent on no more.
                true => SendList { indices: Vec::new(), shift: 0.0 },
                false => send_list(particles, subdomain, width, axis, side),
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

    /// From now on the ghosts for which `is_followed` holds, given their index, are brought up to date. This call is
    /// collective.
    pub fn follow(
        &mut self,
        particles: &Particles,
        is_followed: impl Fn(usize) -> bool,
        ranks: &dyn Communicator,
    ) {
        let asked = self.divide(particles, is_followed, ranks.rank() as u32);
        if ranks.size() > 1 {
            self.ask_owners(&asked, ranks);
        }
    }

    /// Brings velocity and angular velocity of the ghosts that are followed up to date, and the position of images. This
    /// call is collective.
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
    }

    /// Images become like their originals; the velocities that other ranks need go into the messages to them.
    pub fn pack_velocities(&mut self, particles: &mut Particles) {
        for Images { shift, pairs } in &self.images {
            follow_originals(&mut particles.body, pairs, *shift);
        }
        for (message, exported) in self.velocities.outgoing.iter_mut().zip(&self.exported) {
            let of_particle = |&index| GhostVelocities::of(&particles.body[index as usize]);
            message.overwrite(exported.iter().map(of_particle));
        }
    }

    /// Sends the velocities. This call is collective, as is [`ParticleHalo::receive_velocities`].
    pub fn send_velocities<'r>(&mut self, ranks: &'r dyn Communicator) -> Pending<'r, Exchange> {
        self.velocities.start(ranks)
    }

    /// Waits for the velocities of the copies.
    pub fn receive_velocities(&mut self, velocities: Pending<'_, Exchange>) {
        self.velocities = velocities.finish();
    }

    /// Gives the copies the velocities that have come, and moves each as its original was moved.
    pub(crate) fn drift_copies(&self, particles: &mut Particles, step: DriftStep) {
        for (message, copies) in self.velocities.incoming.iter().zip(&self.copies) {
            let velocities = |place| {
                let GhostVelocities { velocity, angular_velocity } = message.record(place);
                [velocity, angular_velocity]
            };
            drift_copies(&mut particles.body, copies, velocities, step);
        }
    }

    /// Takes the forces off the copies, into the messages to their owners.
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
    }

    /// Sends the forces. This call is collective, as is [`ParticleHalo::receive_forces`].
    pub fn return_forces<'r>(&mut self, ranks: &'r dyn Communicator) -> Pending<'r, Exchange> {
        self.forces.start(ranks)
    }

    /// Waits for the forces on particles of this rank.
    pub fn receive_forces(&mut self, forces: Pending<'_, Exchange>) {
        self.forces = forces.finish();
    }

    /// Adds the forces that have come to the owned particles. Sums are exact: the order of the ranks changes no bit.
    pub fn unpack_forces(&self, particles: &mut Particles) {
        for (message, exported) in self.forces.incoming.iter().zip(&self.exported) {
            for (forces, &index) in records_of_bytes::<GhostForces>(&message.bytes).zip(exported) {
                particles.forces[index as usize] += forces.force_and_torque();
            }
        }
    }

    /// Adds the counts of copies to those of their originals, on the ranks that own these: of counts for all particles of a
    /// rank, owned ones and ghosts. This call is collective.
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

    /// Sends the particles of both lists to the neighbours along an axis, and adds what they send as ghosts.
    fn send_new_ghosts(
        &mut self,
        (axis, neighbours): (usize, AxisNeighbours),
        lists: &[SendList; 2],
        particles: &mut Particles,
        ranks: &dyn Communicator,
    ) {
        let (here, owned) = (ranks.rank() as u32, particles.owned_count());
        let outgoing = lists.each_ref().map(|list| {
            let mut bytes = Vec::with_capacity(list.indices.len() * size_of::<NewGhost>());
            for &index in &list.indices {
                let index = index as usize;
                let origin = match index < owned {
                    true => Origin { rank: here, index: index as u32 },
                    false => self.origins[index - owned],
                };
                let mut ghost = NewGhost::of(particles, index, origin);
                ghost.position[axis] += list.shift; // exact: both are multiples of the quantum
                bytes.extend_from_slice(bytemuck::bytes_of(&ghost));
            }
            bytes
        });
        let outgoing = [&outgoing[0][..], &outgoing[1][..]];
        let mut incoming = [Vec::new(), Vec::new()];
        ranks.exchange(neighbours, outgoing, &mut incoming);
        let arrived: usize = incoming.iter().map(Vec::len).sum();
        particles.make_room_for_ghosts(arrived / size_of::<NewGhost>());
        for ghost in incoming.iter().flat_map(|bytes| records_of_bytes::<NewGhost>(bytes)) {
            let is_image = ghost.origin.rank == here;
            let image_of = is_image.then_some(ghost.origin.index as usize);
            particles.push_ghost(ghost.id, ghost.body(), image_of);
            self.origins.push(ghost.origin);
        }
    }

    /// Divides the ghosts that are followed into images of owned particles and copies of other ranks'. Returns for each owner of
    /// copies the message that names their originals.
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
        // Ghosts of one shift follow each other, but for those of edges and corners.
        let known = self.images.iter_mut().rev().find(|images| images.shift == shift);
        match known {
            Some(images) => images.pairs.push(pair),
            None => self.images.push(Images { shift, pairs: vec![pair] }),
        }
    }

    /// Sends the owners of copies the indices of the originals, and makes the messages of a step. This call is collective.
    fn ask_owners(&mut self, asked: &[Message], ranks: &dyn Communicator) {
        let asked_here = ranks.sparse_exchange(asked);
        let indices = |message: &Message| records_of_bytes(&message.bytes).collect();
        self.exported = asked_here.iter().map(indices).collect();
        let lengths = |message: &Message| {
            (message.rank, message.bytes.len() / size_of::<u32>() * size_of::<GhostVelocities>())
        };
        let (of_exported, of_copies) = (asked_here.iter().map(lengths), asked.iter().map(lengths));
        self.velocities = Exchange::with_lengths(of_exported.clone(), of_copies.clone());
        const { assert!(size_of::<GhostVelocities>() == size_of::<GhostForces>()) };
        self.forces = Exchange::with_lengths(of_copies, of_exported);
    }
}

/// The copies of each particle: they are in the order of their places, so that those of one particle follow each other.
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
mod tests {
    use super::super::run_on_threads;
    use super::*;
    use crate::domain::{Bounds, Decomposition, Face, RankGrid};
    use crate::numbers::{Quantum, random_of, uniform};
    use crate::particles::{Body, Weight};
    use std::collections::BTreeMap;

    const WIDTH: f64 = 1.1;
    const TIME_STEP: f64 = 0.01;

    fn bounds() -> Bounds {
        let periodic = [Face::Periodic; 2];
        Bounds::new(Vector3::new(6.0, 2.5, 9.0), [periodic, periodic, [Face::Wall; 2]])
    }

    fn drift(body: &mut Body, quantum: Quantum) {
        body.position += quantum.round_vector(body.velocity * TIME_STEP);
    }

    /// The particles of a rank, at random, and all in the box by their ids.
    fn particles_of(subdomain: Subdomain) -> (Particles, BTreeMap<u64, Body>) {
        let quantum = bounds().position_quantum();
        let (mut particles, mut all) = (Particles::default(), BTreeMap::new());
        let ([lower, upper], lengths) = (subdomain.corners(), bounds().lengths());
        for id in 0..300 {
            let mut random = random_of(7, id, "halo");
            let mut numbers = || Vector3::from_fn(|_, _| uniform(&mut random));
            let position = quantum.round_vector(numbers().component_mul(&lengths));
            let mut body = Body::new(position, numbers(), 0.5, 1.0);
            body.angular_velocity = numbers();
            all.insert(id, body);
            if (0..3).all(|axis| (lower[axis]..upper[axis]).contains(&position[axis])) {
                particles.push(id, position, body.velocity, 0.5, 1.0);
                particles.body.last_mut().expect("it was pushed").angular_velocity =
                    body.angular_velocity;
            }
        }
        (particles, all)
    }

    /// Moves all particles on a grid of ranks, the ghosts too if `moves` says so, and returns for each rank how many
    /// ghosts are copies of other ranks' particles, how many particles it was sent, and how many ghosts are not where an
    /// image of their original can be, or move otherwise than that.
    fn moved_on(grid: [usize; 3], moves: bool) -> Vec<[usize; 3]> {
        let (bounds, quantum) = (bounds(), bounds().position_quantum());
        let decomposition = Decomposition::even(RankGrid(grid), &bounds);
        run_on_threads(grid.iter().product(), |ranks| {
            let subdomain = decomposition.subdomain(&bounds, ranks.rank());
            let (mut particles, mut all) = particles_of(subdomain);
            let mut halo = ParticleHalo::default();
            halo.make_ghosts(&mut particles, subdomain, WIDTH, ranks);
            halo.follow(&particles, |_| true, ranks);
            let owned = particles.owned_count();
            for body in particles.body[..owned].iter_mut().chain(all.values_mut()) {
                body.velocity.x += 1.0;
                drift(body, quantum);
            }
            halo.pack_velocities(&mut particles);
            let velocities = halo.send_velocities(ranks);
            halo.receive_velocities(velocities);
            let dt = if moves { TIME_STEP } else { 0.0 };
            let weight = Weight { gravity: 0.0, quantum };
            halo.drift_copies(&mut particles, DriftStep { dt, quantum, weight });
            let is_wrong = |ghost: &usize| {
                let (id, body) = (particles.id[*ghost], particles.body[*ghost]);
                let original = all[&id];
                let shift = body.position - original.position;
                let lengths = bounds.lengths();
                let is_image = (0..3).all(|axis| [0.0, lengths[axis]].contains(&shift[axis].abs()));
                let moves = [body.velocity, body.angular_velocity];
                !is_image || moves != [original.velocity, original.angular_velocity]
            };
            let copies: usize = halo.copies.iter().map(Vec::len).sum();
            let images: usize = halo.images.iter().map(|images| images.pairs.len()).sum();
            assert_eq!(copies + images, particles.count() - owned);
            let incoming = &halo.velocities.incoming;
            let bytes: usize = incoming.iter().map(|message| message.bytes.len()).sum();
            let sent = bytes / size_of::<GhostVelocities>();
            [copies, sent, (owned..particles.count()).filter(is_wrong).count()]
        })
    }

    /// Pairs of an owned particle and a ghost that are nearer than the width of the halo, by their ids, on all ranks of a grid,
    /// and how many there are of two owned particles.
    fn pairs_on(grid: [usize; 3]) -> (Vec<[u64; 2]>, usize) {
        let bounds = bounds();
        let decomposition = Decomposition::even(RankGrid(grid), &bounds);
        let found = run_on_threads(grid.iter().product(), |ranks| {
            let subdomain = decomposition.subdomain(&bounds, ranks.rank());
            let mut particles = particles_of(subdomain).0;
            ParticleHalo::default().make_ghosts(&mut particles, subdomain, WIDTH, ranks);
            let (mut with_ghosts, mut owned) = (Vec::new(), 0);
            for i in 0..particles.owned_count() {
                for j in i + 1..particles.count() {
                    let branch = particles.body[j].position - particles.body[i].position;
                    let ids = [particles.id[i], particles.id[j]];
                    match branch.norm() < WIDTH {
                        true if j < particles.owned_count() => owned += 1,
                        true => with_ghosts.push([ids[0].min(ids[1]), ids[0].max(ids[1])]),
                        false => (),
                    }
                }
            }
            (with_ghosts, owned)
        });
        let owned = found.iter().map(|(_, owned)| owned).sum();
        (found.into_iter().flat_map(|(with_ghosts, _)| with_ghosts).collect(), owned)
    }

    #[test]
    fn a_pair_with_a_ghost_is_on_one_rank_only() {
        let (images, alone) = pairs_on([1, 1, 1]);
        for grid in [[1, 1, 1], [2, 1, 1], [1, 1, 3], [2, 1, 2], [3, 1, 1], [4, 1, 4]] {
            let (mut pairs, owned) = pairs_on(grid);
            let count = pairs.len();
            assert_eq!(count + owned, images.len() + alone, "{grid:?}");
            pairs.sort_unstable();
            pairs.dedup();
            assert_eq!(pairs.len(), count, "{grid:?}");
            assert!(grid == [1, 1, 1] || count > images.len());
        }
    }

    #[test]
    fn ghosts_move_as_their_originals_on_any_grid() {
        for grid in [[1, 1, 1], [2, 1, 1], [1, 1, 3], [2, 1, 2], [3, 1, 1]] {
            for [_, _, wrong] in moved_on(grid, true) {
                assert_eq!(wrong, 0, "{grid:?}");
            }
        }
        // The control: copies that stay behind are found.
        for [copies, _, wrong] in moved_on([2, 1, 1], false) {
            assert!(copies > 0 && wrong == copies);
        }
    }

    /// Puts a force and a torque on each copy, different for each particle, and brings them to the owners on a grid of ranks.
    /// Returns for each rank how many copies it has, how many forces have come, and how many particles have another force than
    /// that of their copies.
    fn returned_on(grid: [usize; 3]) -> Vec<[usize; 3]> {
        let bounds = bounds();
        let decomposition = Decomposition::even(RankGrid(grid), &bounds);
        run_on_threads(grid.iter().product(), |ranks| {
            let subdomain = decomposition.subdomain(&bounds, ranks.rank());
            let mut particles = particles_of(subdomain).0;
            let mut halo = ParticleHalo::default();
            halo.make_ghosts(&mut particles, subdomain, WIDTH, ranks);
            halo.follow(&particles, |_| true, ranks);
            let of_id = |id: u64| {
                let number = id as f64;
                ForceTorque::new(Vector3::new(1.0, number, 0.0), Vector3::new(0.0, 0.0, -number))
            };
            let mut counts = vec![0; particles.count()];
            let copies: Vec<u32> = halo.copies.iter().flatten().map(|&[_, ghost]| ghost).collect();
            for &ghost in &copies {
                particles.forces[ghost as usize] = of_id(particles.id[ghost as usize]);
                counts[ghost as usize] = 1;
            }
            halo.pack_forces(&mut particles);
            let forces = halo.return_forces(ranks);
            halo.receive_forces(forces);
            halo.unpack_forces(&mut particles);
            halo.return_counts(&mut counts, ranks);
            let is_wrong = |&i: &usize| {
                let (mut expected, count) = (ForceTorque::default(), counts[i]);
                (0..count).for_each(|_| expected += of_id(particles.id[i]));
                particles.forces[i] != expected
            };
            let owned = 0..particles.owned_count();
            let came: f64 = particles.forces[owned.clone()].iter().map(|load| load.force.x).sum();
            assert!(
                copies
                    .iter()
                    .all(|&ghost| particles.forces[ghost as usize] == ForceTorque::default())
            );
            [copies.len(), came as usize, owned.filter(is_wrong).count()]
        })
    }

    #[test]
    fn forces_on_copies_come_to_their_owners_on_any_grid() {
        for grid in [[1, 1, 1], [2, 1, 1], [1, 1, 3], [2, 1, 2], [3, 1, 1]] {
            let found = returned_on(grid);
            let [copies, came] =
                [0, 1].map(|k| found.iter().map(|of_rank| of_rank[k]).sum::<usize>());
            assert_eq!(copies, came, "{grid:?}");
            assert_eq!(copies > 0, grid != [1, 1, 1]);
            assert!(found.iter().all(|of_rank| of_rank[2] == 0), "{grid:?}");
        }
    }

    #[test]
    fn a_particle_is_sent_once_to_each_rank_with_copies_of_it() {
        // The box is 2.5 wide along y: nearly each copy has an image there. None is ahead of the upper rank.
        let [[copies, sent, _], [none, ..]] = moved_on([1, 1, 2], true)[..] else { unreachable!() };
        assert!(10 * copies > 17 * sent, "{copies} copies of {sent} particles");
        assert_eq!(none, 0);
        // On three ranks along x, where nothing but images makes a second copy, the copies are no fewer.
        for [copies, sent, _] in moved_on([3, 1, 1], true) {
            assert!(copies >= sent && sent > 0);
        }
    }
}
