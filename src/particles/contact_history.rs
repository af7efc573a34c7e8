//! What a contact keeps from one step to the next: the records of touching pairs, and of particles that touch a wall.

use bytemuck::{Pod, Zeroable};
use nalgebra::Vector3;

/// History of a contact: one record for all contact laws, of numbers (`f64`) only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ContactHistory {
    /// Tangential displacement of the second body relative to the first since the contact began.
    pub tangential_spring: Vector3<f64>,
    /// Largest overlap since the contact began.
    pub largest_overlap: f64,
}

impl ContactHistory {
    /// The spring, then the largest overlap.
    #[inline(always)]
    pub(crate) fn numbers(&self) -> &[f64; 4] {
        bytemuck::cast_ref(self)
    }
}

/// History of the touching pair of particles `lower` < `higher`, seen from the lower id.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairHistory {
    /// The lower global id.
    pub lower: u64,
    /// The higher global id.
    pub higher: u64,
    /// History of the contact, with the displacement of the higher relative to the lower.
    pub history: ContactHistory,
    /// Deflection angle of the rolling spring, of the higher relative to the lower; zero without such a spring.
    pub rolling_angle: Vector3<f64>,
    /// Angle of the twisting spring about the normal from the lower to the higher; zero without such a spring.
    pub twisting_angle: f64,
}

/// History of the contact of a particle and a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallHistory {
    /// The particle's global id.
    pub particle: u64,
    /// The wall's number.
    pub wall: u32,
    /// History of the contact, with the displacement of the wall relative to the particle.
    pub history: ContactHistory,
    /// Deflection angle of the rolling spring, of the wall relative to the particle; zero without such a spring.
    pub rolling_angle: Vector3<f64>,
    /// Angle of the twisting spring about the normal from the particle to the wall; zero without such a spring.
    pub twisting_angle: f64,
}

/// The contact histories of some particles: of the pairs that touch, and of the particles that touch a wall.
///
/// They outlive the slots of a neighbour list: over a rebuild, to another rank, and through a checkpoint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactHistories {
    /// Touching pairs, in no particular order. A pair may occur twice, with the same contents.
    pub pairs: Vec<PairHistory>,
    /// Particles that touch a wall, in no particular order.
    pub walls: Vec<WallHistory>,
    /// Ids and positions of the particles of other ranks that are in one of the pairs, as far as they are known.
    pub partners: Vec<(u64, Vector3<f64>)>,
}

impl ContactHistories {
    /// Removes the histories of all contacts of a particle for which `is_kept` does not hold, given its global id.
    pub fn retain_particles(&mut self, is_kept: impl Fn(u64) -> bool) {
        self.pairs.retain(|pair| is_kept(pair.lower) && is_kept(pair.higher));
        self.walls.retain(|contact| is_kept(contact.particle));
    }
}
