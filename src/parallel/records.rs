//! The records that are sent between ranks and written to checkpoints. In memory, in messages and in files they are
//! the same bytes; [`super`] lists who sends which of them when.

use crate::particles::{
    Body, ContactHistory, ForceTorque, Membership, PairHistory, Particles, WallHistory,
};
use bytemuck::{Pod, Zeroable};

/// A sequence of records that are stored, or computed when they are asked for and so take no memory.
pub trait Records<T> {
    /// Number of records.
    fn count(&self) -> usize;

    /// The record of an index.
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

/// Records that a function computes from their index: their number, and the function.
#[derive(Clone, Copy, Debug)]
pub struct ComputedRecords<F>(pub usize, pub F);

impl<T, F: Fn(usize) -> T> Records<T> for ComputedRecords<F> {
    fn count(&self) -> usize {
        self.0
    }

    fn at(&self, index: usize) -> T {
        self.1(index)
    }
}

/// The state of one particle.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ParticleRecord {
    /// Global id, unique and never used again.
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
    /// Number of the species, a whole number from 0; a double as its neighbours are.
    pub species: f64,
    /// Where drag follows from agglomerates, the diameter of the sphere that the particle's agglomerate is taken for; zero
    /// otherwise, and of a particle alone.
    pub agglomerate_diameter: f64,
    /// Volume of its members over that of this sphere, likewise.
    pub agglomerate_packing: f64,
    /// Drag on the particle over that of the law in the last step of the gas; zero where it does not follow from agglomerates.
    pub drag_factor: f64,
}

/// The contact history of a pair, as seen from the particle with the lower id.
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
    /// Angle by which the higher has rolled relative to the lower, if there is a rolling spring.
    pub rolling_angle: [f64; 3],
    /// Angle by which the higher has twisted relative to the lower about the normal, if there is a twisting spring.
    pub twisting_angle: f64,
}

/// The contact history of a particle and a wall.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct WallContactRecord {
    /// The particle's id.
    pub particle: u64,
    /// The index of the wall in the domain's list of walls.
    pub wall: u64,
    /// Tangential displacement of the wall relative to the particle since the contact began.
    pub tangential_spring: [f64; 3],
    /// Largest overlap since the contact began.
    pub largest_overlap: f64,
    /// Angle by which the wall has rolled relative to the particle, if there is a rolling spring.
    pub rolling_angle: [f64; 3],
    /// Angle by which the wall has twisted relative to the particle about the normal, if there is a twisting spring.
    pub twisting_angle: f64,
}

/// What a checkpoint keeps of the volume-averaged gas in one cell, or of a column gas: its plenum, and intervals if it is compressible.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CellRecord {
    /// Number of the cell in the whole grid, x fastest, then y, then z.
    pub cell: u64,
    /// Velocity of the gas at the lower faces along x, y, z, each along its normal.
    pub lower_velocity: [f64; 3],
    /// Velocity at the upper faces: at the end of the box no other cell has it.
    pub upper_velocity: [f64; 3],
    /// Pressure less the hydrostatic head.
    pub pressure: f64,
    /// Volume of gas per volume.
    pub voidage: f64,
}

/// What snapshots show of the volume-averaged gas in one cell.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CellSample {
    /// Number of the cell in the whole grid, x fastest, then y, then z.
    pub cell: u64,
    /// Pressure less the hydrostatic head.
    pub pressure: f64,
    /// Velocity of the gas, the mean of those at its faces.
    pub velocity: [f64; 3],
    /// Volume of gas per open volume; 0 in a closed cell.
    pub voidage: f64,
    /// Open volume over that of the cell: 1 except outside and at the wall of a round column.
    pub open_fraction: f64,
    /// Mean velocity of the solids by volume; 0 where there are none.
    pub solids_velocity: [f64; 3],
}

/// Where a particle is owned: the rank, and its index there until lists are next made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Origin {
    pub(super) rank: u32,
    pub(super) index: u32,
}

/// A particle that becomes a ghost of a neighbour, sent when the neighbour list is rebuilt. The position is that of the
/// image, shifted through periodic faces.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct NewGhost {
    pub(super) id: u64,
    pub(super) origin: Origin,
    pub(super) radius: f64,
    pub(super) mass: f64,
    pub(super) species: f64,
    pub(super) position: [f64; 3],
    pub(super) velocities: GhostVelocities,
}

impl NewGhost {
    /// A particle where it is, the copy of one of that origin.
    pub(super) fn of(particles: &Particles, index: usize, origin: Origin) -> Self {
        let body = &particles.body[index];
        Self {
            id: particles.id[index],
            origin,
            radius: body.radius,
            mass: body.mass,
            species: body.species() as f64,
            position: body.position.into(),
            velocities: GhostVelocities::of(body),
        }
    }

    pub(super) fn body(&self) -> Body {
        let (position, velocity) = (self.position.into(), self.velocities.velocity.into());
        let mut body = Body::new(position, velocity, self.radius, self.mass);
        self.velocities.give_to(&mut body);
        body.of_species(self.species as usize)
    }
}

/// What is sent of a ghost's original at every step.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct GhostVelocities {
    pub(super) velocity: [f64; 3],
    pub(super) angular_velocity: [f64; 3],
}

impl GhostVelocities {
    #[inline(always)]
    pub(super) fn of(body: &Body) -> Self {
        Self { velocity: body.velocity.into(), angular_velocity: body.angular_velocity.into() }
    }

    #[inline(always)]
    pub(super) fn give_to(&self, body: &mut Body) {
        body.velocity = self.velocity.into();
        body.angular_velocity = self.angular_velocity.into();
    }
}

/// What goes back at every step: the sum of what a rank's pairs put on another's particle.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct GhostForces {
    force: [f64; 3],
    torque: [f64; 3],
}

impl GhostForces {
    #[inline(always)]
    pub(super) fn of(forces: &ForceTorque) -> Self {
        Self { force: forces.force.into(), torque: forces.torque.into() }
    }

    #[inline(always)]
    pub(super) fn force_and_torque(&self) -> ForceTorque {
        ForceTorque::new(self.force.into(), self.torque.into())
    }
}

impl ParticleRecord {
    /// The record of one owned particle. Inlined, so that nothing but the id is loaded where only that is used.
    #[inline(always)]
    pub fn of(particles: &Particles, index: usize) -> Self {
        let Membership { diameter, packing, drag_factor } = particles.membership.get(index);
        Self {
            id: particles.id[index],
            position: particles.body[index].position.into(),
            velocity: particles.body[index].velocity.into(),
            angular_velocity: particles.body[index].angular_velocity.into(),
            force: particles.forces[index].force.into(),
            torque: particles.forces[index].torque.into(),
            radius: particles.body[index].radius,
            mass: particles.body[index].mass,
            gas_force: particles.gas_force.get(index).into(),
            species: particles.body[index].species() as f64,
            agglomerate_diameter: diameter,
            agglomerate_packing: packing,
            drag_factor,
        }
    }

    /// Adds the particle to the owned ones. Before: there are no ghosts.
    pub fn push_to(&self, particles: &mut Particles) {
        let index = particles.count();
        let (position, velocity) = (self.position.into(), self.velocity.into());
        particles.push(self.id, position, velocity, self.radius, self.mass);
        particles.body[index] = particles.body[index].of_species(self.species as usize);
        particles.body[index].angular_velocity = self.angular_velocity.into();
        particles.forces[index].force = self.force.into();
        particles.forces[index].torque = self.torque.into();
        particles.gas_force.set(index, self.gas_force.into());
        let membership = Membership {
            diameter: self.agglomerate_diameter,
            packing: self.agglomerate_packing,
            drag_factor: self.drag_factor,
        };
        particles.membership.set(index, membership);
    }
}

fn contact_history(tangential_spring: [f64; 3], largest_overlap: f64) -> ContactHistory {
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
            twisting_angle: pair.twisting_angle,
        }
    }
}

impl From<ContactRecord> for PairHistory {
    fn from(record: ContactRecord) -> Self {
        let history = contact_history(record.tangential_spring, record.largest_overlap);
        let rolling_angle = record.rolling_angle.into();
        let (lower, higher, twisting_angle) = (record.lower, record.higher, record.twisting_angle);
        Self { lower, higher, history, rolling_angle, twisting_angle }
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
            twisting_angle: contact.twisting_angle,
        }
    }
}

impl From<WallContactRecord> for WallHistory {
    fn from(record: WallContactRecord) -> Self {
        let history = contact_history(record.tangential_spring, record.largest_overlap);
        let rolling_angle = record.rolling_angle.into();
        let (particle, wall) = (record.particle, record.wall as u32);
        let twisting_angle = record.twisting_angle;
        Self { particle, wall, history, rolling_angle, twisting_angle }
    }
}

/// The records in a message, whose bytes need not be aligned. Bytes at the end that do not make up a whole record are
/// ignored.
pub fn records_of_bytes<T: Pod>(bytes: &[u8]) -> impl Iterator<Item = T> + '_ {
    bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_have_the_sizes_that_the_documentation_of_the_module_states() {
        assert_eq!(size_of::<ParticleRecord>(), 200);
        assert_eq!(size_of::<ContactRecord>(), 80);
        assert_eq!(size_of::<WallContactRecord>(), 80);
        assert_eq!(size_of::<CellRecord>(), 72);
        assert_eq!(size_of::<NewGhost>(), 112);
        assert_eq!(size_of::<GhostVelocities>(), 48);
    }
}
