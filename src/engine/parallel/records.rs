//! The records that are sent between ranks and written to checkpoints. They consist of the same bytes in memory, in
//! messages and in files; [`super`] lists when they are sent, and by which ranks.

use crate::fields::{Field, Id, Record, records};
use crate::particles::{Body, ForceTorque, Particles};
use bytemuck::{Pod, Zeroable};

/// A sequence of records that are either stored, or computed when they are requested and so take no memory.
pub trait Records<T> {
    /// Number of records.
    fn count(&self) -> usize;

    /// The record with this index.
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

records! {
    /// Data in a checkpoint on one cell of the volume-averaged gas, or on a column gas: its plenum, and intervals if it
    /// is compressible.
    pub struct CellRecord {
        [cell]: "number of the cell, x fastest, then y, then z, ascending";
        lower_velocity: Vector, Speed, "velocity at the lower face along x, y, z";
        upper_velocity: Vector, Speed, "velocity at the upper face along x, y, z";
        pressure: Number, Pressure, "pressure less the hydrostatic head";
        voidage: Number, One, "volume of gas per volume";
    }
}

impl Record for CellRecord {
    const GROUP: &'static str = "/gas";
    const IDS: &'static [Id] = Self::IDS;
    const FIELDS: &'static [Field] = Self::FIELDS;
}

/// Data in snapshots on one cell of the volume-averaged gas.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CellSample {
    /// Number of the cell in the whole grid, x fastest, then y, then z.
    pub cell: u64,
    /// Pressure less the hydrostatic head.
    pub pressure: f64,
    /// Velocity of the gas: the mean of the velocities at the faces of the cell.
    pub velocity: [f64; 3],
    /// Volume of gas per open volume; 0 in a closed cell.
    pub voidage: f64,
    /// Open volume over that of the cell: 1 except outside and at the wall of a round column.
    pub open_fraction: f64,
    /// Mean velocity of the solids by volume; 0 where there are none.
    pub solids_velocity: [f64; 3],
}

/// The place where a particle is owned: the rank, and its index there until lists are next made.
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
    /// The particle with this index at its present position, as a copy of an original at this origin.
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

/// Data on a ghost's original that are sent at every step.
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

/// Data that are returned at every step: the sums of the forces and torques of a rank's pairs on a particle of another
/// rank.
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

/// The records in a message, whose bytes need not be aligned. Bytes at the end that do not make up a whole record are
/// ignored.
pub fn records_of_bytes<T: Pod>(bytes: &[u8]) -> impl Iterator<Item = T> + '_ {
    bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::{ContactRecord, ParticleRecord, WallContactRecord};

    #[test]
    fn records_have_the_sizes_that_the_documentation_of_the_module_states() {
        assert_eq!(size_of::<ParticleRecord>(), 200);
        assert_eq!(size_of::<ContactRecord>(), 80);
        assert_eq!(size_of::<WallContactRecord>(), 88);
        assert_eq!(size_of::<CellRecord>(), 72);
        assert_eq!(size_of::<NewGhost>(), 112);
        assert_eq!(size_of::<GhostVelocities>(), 48);
    }
}
