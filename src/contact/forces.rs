//! The loops over near pairs: geometry, law, cohesion, and exact sums.

use super::apart::AttractApart;
use super::lanes::PairWork;
use super::{Contact, ContactForce, ContactModel, VanDerWaalsNow};
use crate::numbers::{Quantum, with_simd};
use crate::particles::{ContactHistory, Contacts, Particles, Ranges};
use nalgebra::Vector3;
use thiserror::Error;

/// A force that no contact of this case can have: the time step is too long, or particles overlap.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "the contact of particle {particle} with {other} has a force of {force:.3e} (limit {limit:.3e}), at an \
     overlap of {overlap:.3e}: shorten time.step, or check the start for overlaps"
)]
pub struct ForceOutOfRange {
    /// The particle's id.
    pub particle: u64,
    /// The other particle, or the wall.
    pub other: String,
    /// Largest component of the force.
    pub force: f64,
    /// What it may be.
    pub limit: f64,
    /// Overlap of the two.
    pub overlap: f64,
}

/// What acts between near bodies at one instant.
#[derive(Clone, Copy, Debug)]
pub struct ForceLaws<'a> {
    /// Where particles touch.
    pub contact: &'a ContactModel,
    /// Where they touch the walls, by the walls' numbers; walls beyond its end are like particles.
    pub at_walls: &'a [ContactModel],
    /// Attraction now.
    pub cohesion: Option<VanDerWaalsNow>,
    /// Separations of surfaces up to which contacts act, and any force.
    pub ranges: Ranges,
    /// Time that tangential springs are carried on by; zero to evaluate forces without moving on.
    pub dt: f64,
    /// Largest component of a contact's force.
    pub limit: f64,
    /// Lattice of forces.
    pub force_quantum: Quantum,
    /// Lattice of torques.
    pub torque_quantum: Quantum,
}

/// Adds the forces and torques of all pairs to both their particles.
///
/// With n the unit vector from particle i to j, delta the overlap and F_c the attraction at separation
/// -delta, particle j feels (F_n - F_c) n + F_t and the torque -r_j n x F_t, particle i the negative force and
/// -r_i n x F_t. Every contribution is rounded to a lattice before it is added: the sums are exact, so
/// neither the order of pairs nor evaluating a pair on two ranks changes a bit.
///
/// Before: forces are those of nothing else but lattice numbers; ghosts are current. After: forces of
/// owned particles are complete.
///
/// # Errors
/// If a force exceeds the limit or is undefined; the first such pair of this rank.
pub fn add_pair_forces(
    particles: &mut Particles,
    contacts: &mut Contacts,
    laws: &ForceLaws,
) -> Result<(), ForceOutOfRange> {
    contacts.near.acting.hold_rolling_angles(laws.contact.rolling.is_some());
    contacts.find_near(particles, laws.ranges);
    let near = &mut contacts.near;
    match laws.cohesion {
        None => near.look_for_arrivals(particles),
        Some(cohesion) => with_simd(AttractApart { particles, near, cohesion, laws })?,
    }
    near.let_in();
    with_simd(PairWork { particles, near, laws })
}

/// A contact that has ended leaves no memory.
pub(super) fn forget(touching: &mut bool, history: &mut ContactHistory) {
    *touching = false;
    *history = ContactHistory::default();
}

/// Force on the second body: contact and attraction.
#[inline(always)]
pub(super) fn total(contact: &Contact, force: &ContactForce) -> Vector3<f64> {
    contact.normal * (force.normal - contact.cohesion) + force.tangential
}

#[cold]
pub(super) fn out_of_range(
    particle: u64,
    other: String,
    force: Vector3<f64>,
    overlap: f64,
    limit: f64,
) -> ForceOutOfRange {
    ForceOutOfRange { particle, other, force: force.amax(), limit, overlap }
}
