//! What travels between ranks and into checkpoints, byte for byte.

use bytemuck::{Pod, Zeroable};

/// One particle: everything of its state that is its own.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ParticleRecord {
    /// Global id: unique, never reused.
    pub id: u64,
    /// Centre.
    pub position: [f64; 3],
    /// Velocity of the centre.
    pub velocity: [f64; 3],
    /// Angular velocity, right-handed.
    pub angular_velocity: [f64; 3],
    /// Total force at the end of the last step.
    pub force: [f64; 3],
    /// Total torque about the centre at the end of the last step.
    pub torque: [f64; 3],
    /// Radius.
    pub radius: f64,
    /// Mass.
    pub mass: f64,
}

/// What a touching pair remembers, as seen from the particle with the lower id.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ContactRecord {
    /// The lower id of the pair.
    pub lower: u64,
    /// The higher id of the pair.
    pub higher: u64,
    /// Tangential displacement of the higher relative to the lower since the contact began.
    pub tangential_spring: [f64; 3],
    /// Largest overlap since the contact began.
    pub largest_overlap: f64,
}

/// What a particle's contact with a wall remembers.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct WallContactRecord {
    /// The particle's id.
    pub particle: u64,
    /// The wall's number in the order of the domain's walls.
    pub wall: u64,
    /// Tangential displacement of the wall relative to the particle since the contact began.
    pub tangential_spring: [f64; 3],
    /// Largest overlap since the contact began.
    pub largest_overlap: f64,
}

/// The records in bytes that another rank sent, which may lie at any address. Bytes at the end that are
/// no whole record are left out.
pub fn records_of_bytes<T: Pod>(bytes: &[u8]) -> Vec<T> {
    bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect()
}
