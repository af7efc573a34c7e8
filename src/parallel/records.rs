//! What travels between ranks and into checkpoints, byte for byte.

use crate::particles::{ContactHistory, PairHistory, Particles, WallHistory};
use bytemuck::{Pod, Zeroable};

/// Records that are there, or that are made when one asks for them, so that they take no memory.
pub trait Records<T> {
    /// How many there are.
    fn count(&self) -> usize;

    /// One of them.
    fn at(&self, index: usize) -> T;
}

impl<T: Copy, S: AsRef<[T]> + ?Sized> Records<T> for S {
    fn count(&self) -> usize {
        self.as_ref().len()
    }

    fn at(&self, index: usize) -> T {
        self.as_ref()[index]
    }
}

/// So many records, made by a function of their index.
#[derive(Clone, Copy, Debug)]
pub struct MadeRecords<F>(pub usize, pub F);

impl<T, F: Fn(usize) -> T> Records<T> for MadeRecords<F> {
    fn count(&self) -> usize {
        self.0
    }

    fn at(&self, index: usize) -> T {
        self.1(index)
    }
}

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
    /// Force of a gas in three dimensions as of its last step; zero without such a gas.
    pub gas_force: [f64; 3],
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
    /// Angle that the higher has rolled relative to the lower, if a rolling spring holds it.
    pub rolling_angle: [f64; 3],
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
    /// Angle that the wall has rolled relative to the particle, if a rolling spring holds it.
    pub rolling_angle: [f64; 3],
}

/// What a gas in three dimensions is in one cell.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CellRecord {
    /// Number of the cell in the whole grid, x fastest, then y, then z.
    pub cell: u64,
    /// Velocities at the lower faces along x, y, z, at the upper faces, pressure, voidage.
    pub numbers: [f64; CellRecord::NUMBERS],
}

impl CellRecord {
    /// Numbers in a record.
    pub const NUMBERS: usize = 8;
}

impl ParticleRecord {
    /// The record of one owned particle. Inlined, so that who asks for its id alone looks up nothing else.
    #[inline(always)]
    pub fn of(particles: &Particles, index: usize) -> Self {
        Self {
            id: particles.id[index],
            position: particles.body[index].position.into(),
            velocity: particles.body[index].velocity.into(),
            angular_velocity: particles.body[index].angular_velocity.into(),
            force: particles.forces[index].force.into(),
            torque: particles.forces[index].torque.into(),
            radius: particles.body[index].radius,
            mass: particles.body[index].mass,
            gas_force: particles.gas_force[index].into(),
        }
    }

    /// Adds the particle to the owned ones. There must be no ghosts.
    pub fn push_to(&self, particles: &mut Particles) {
        let index = particles.count();
        let (position, velocity) = (self.position.into(), self.velocity.into());
        particles.push(self.id, position, velocity, self.radius, self.mass);
        particles.body[index].angular_velocity = self.angular_velocity.into();
        particles.forces[index].force = self.force.into();
        particles.forces[index].torque = self.torque.into();
        particles.gas_force[index] = self.gas_force.into();
    }
}

fn memory_of(tangential_spring: [f64; 3], largest_overlap: f64) -> ContactHistory {
    ContactHistory { tangential_spring: tangential_spring.into(), largest_overlap }
}

impl From<PairHistory> for ContactRecord {
    fn from(pair: PairHistory) -> Self {
        Self {
            lower: pair.lower,
            higher: pair.higher,
            tangential_spring: pair.history.tangential_spring.into(),
            largest_overlap: pair.history.largest_overlap,
            rolling_angle: pair.rolling_angle.into(),
        }
    }
}

impl From<ContactRecord> for PairHistory {
    fn from(record: ContactRecord) -> Self {
        let history = memory_of(record.tangential_spring, record.largest_overlap);
        let rolling_angle = record.rolling_angle.into();
        Self { lower: record.lower, higher: record.higher, history, rolling_angle }
    }
}

impl From<WallHistory> for WallContactRecord {
    fn from(contact: WallHistory) -> Self {
        Self {
            particle: contact.particle,
            wall: u64::from(contact.wall),
            tangential_spring: contact.history.tangential_spring.into(),
            largest_overlap: contact.history.largest_overlap,
            rolling_angle: contact.rolling_angle.into(),
        }
    }
}

impl From<WallContactRecord> for WallHistory {
    fn from(record: WallContactRecord) -> Self {
        let history = memory_of(record.tangential_spring, record.largest_overlap);
        let rolling_angle = record.rolling_angle.into();
        Self { particle: record.particle, wall: record.wall as u32, history, rolling_angle }
    }
}

/// The records in bytes that another rank sent, which may lie at any address. Bytes at the end that are no
/// whole record are left out.
pub fn records_of_bytes<T: Pod>(bytes: &[u8]) -> impl Iterator<Item = T> + '_ {
    bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned)
}
