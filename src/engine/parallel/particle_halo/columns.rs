//! Columns of particles in the messages of ghosts. Numbers for new ghosts follow the record of a ghost, numbers for
//! ghosts at each step follow the velocities, and returned numbers follow the forces. Without such columns nothing is
//! done.

use super::{ParticleHalo, by_particle};
use crate::fields::Travel;
use crate::parallel::records::{GhostForces, GhostVelocities, NewGhost};
use crate::parallel::records_of_bytes;
use crate::particles::Particles;

impl ParticleHalo {
    /// Packs the numbers of columns that travel at each step: images receive those of their originals, and those of
    /// exported particles follow the velocities in the messages.
    pub(super) fn pack_numbers(&mut self, particles: &mut Particles) {
        if particles.columns.width_of(Travel::EachStep) == 0 {
            return;
        }
        let mut row = Vec::new();
        for &[image, original] in self.images.iter().flat_map(|images| &images.pairs) {
            row.clear();
            particles.columns.append_row(Travel::EachStep, original as usize, &mut row);
            particles.columns.set_row(Travel::EachStep, image as usize, &row);
        }
        for (message, exported) in self.velocities.outgoing.iter_mut().zip(&self.exported) {
            row.clear();
            for &index in exported {
                particles.columns.append_row(Travel::EachStep, index as usize, &mut row);
            }
            message.bytes[exported.len() * size_of::<GhostVelocities>()..]
                .copy_from_slice(bytemuck::cast_slice(&row));
        }
    }

    /// Gives copies the numbers of their originals, which follow the velocities in the messages.
    pub(super) fn give_numbers_to_copies(&self, particles: &mut Particles) {
        let width = particles.columns.width_of(Travel::EachStep);
        if width == 0 {
            return;
        }
        for (message, copies) in self.velocities.incoming.iter().zip(&self.copies) {
            let row = size_of::<GhostVelocities>() + width * size_of::<f64>();
            let first = message.bytes.len() / row * size_of::<GhostVelocities>();
            let numbers: Vec<f64> = records_of_bytes(&message.bytes[first..]).collect();
            for &[place, ghost] in copies {
                let row = &numbers[place as usize * width..][..width];
                particles.columns.set_row(Travel::EachStep, ghost as usize, row);
            }
        }
    }

    /// Moves the returned numbers from the copies into the messages, behind the forces.
    pub(super) fn pack_returned(&mut self, particles: &mut Particles) {
        let width = particles.columns.width_of(Travel::Returned);
        if width == 0 {
            return;
        }
        for (message, copies) in self.forces.outgoing.iter_mut().zip(&self.copies) {
            let particles_of_owner = message.bytes.len() / returned_bytes(width);
            let mut numbers = vec![0.0; particles_of_owner * width];
            for (same, row) in by_particle(copies).zip(numbers.chunks_exact_mut(width)) {
                for &[_, ghost] in same {
                    particles.columns.take_returned(ghost as usize, row);
                }
            }
            message.bytes[particles_of_owner * size_of::<GhostForces>()..]
                .copy_from_slice(bytemuck::cast_slice(&numbers));
        }
    }

    /// Adds the returned numbers to those of the originals.
    pub(super) fn add_returned(&self, particles: &mut Particles) {
        let width = particles.columns.width_of(Travel::Returned);
        if width == 0 {
            return;
        }
        for (message, exported) in self.forces.incoming.iter().zip(&self.exported) {
            let behind_forces = &message.bytes[exported.len() * size_of::<GhostForces>()..];
            let numbers: Vec<f64> = records_of_bytes(behind_forces).collect();
            for (row, &index) in numbers.chunks_exact(width).zip(exported) {
                particles.columns.add_returned(index as usize, row);
            }
        }
    }
}

/// Columns that new ghosts receive; returned numbers begin as zeros.
pub(super) const TO_NEW_GHOSTS: [Travel; 2] = [Travel::WithNewGhosts, Travel::EachStep];

/// Bytes of a new ghost in a message.
pub(super) fn new_ghost_bytes(particles: &Particles) -> usize {
    let widths = TO_NEW_GHOSTS.map(|travel| particles.columns.width_of(travel));
    size_of::<NewGhost>() + widths.iter().sum::<usize>() * size_of::<f64>()
}

/// Sets the numbers of the ghost that was added last.
pub(super) fn give_to_new_ghost(particles: &mut Particles, bytes: &[u8]) {
    if bytes.is_empty() {
        return;
    }
    let numbers: Vec<f64> = records_of_bytes(bytes).collect();
    let (mut rest, ghost) = (&numbers[..], particles.count() - 1);
    for travel in TO_NEW_GHOSTS {
        let (row, others) = rest.split_at(particles.columns.width_of(travel));
        particles.columns.set_row(travel, ghost, row);
        rest = others;
    }
}

/// Bytes that are returned for a particle with this many numbers in addition to its force and torque.
pub(super) fn returned_bytes(width: usize) -> usize {
    size_of::<GhostForces>() + width * size_of::<f64>()
}
