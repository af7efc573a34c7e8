//! What acts between particles, and between particles and walls, at one instant.

use super::{ContactModel, VanDerWaalsNow};
use crate::numbers::Quantum;
use crate::particles::InteractionRanges;
use nalgebra::Vector3;
use thiserror::Error;

/// A contact force beyond what the case allows: the time step is too long, or particles overlapped at the start.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "the contact of particle {particle} with {other} has a force of {force:.3e} (limit {limit:.3e}), at an \
     overlap of {overlap:.3e}: shorten time.step, or check the start for overlaps"
)]
pub(crate) struct ForceOutOfRange {
    /// The particle's id.
    pub(crate) particle: u64,
    /// The other particle, or the wall.
    pub(crate) other: String,
    /// Largest component of the force, by magnitude.
    pub(crate) force: f64,
    /// The limit of that component.
    pub(crate) limit: f64,
    /// Overlap of the two bodies.
    pub(crate) overlap: f64,
}

/// The laws of all forces at contacts at one instant, with their limits and rounding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForceLaws<'a> {
    /// Contact model of two particles.
    pub(crate) contact: &'a ContactModel,
    /// Contact models of particles and walls, by the walls' numbers; for walls beyond its end, that of particles holds.
    pub(crate) at_walls: &'a [ContactModel],
    /// Attraction at this instant.
    pub(crate) cohesion: Option<VanDerWaalsNow>,
    /// Separations of surfaces up to which contacts act, and up to which any force acts.
    pub(crate) ranges: InteractionRanges,
    /// Time by which contact histories are advanced; zero to evaluate forces without advancing them.
    pub(crate) dt: f64,
    /// Largest component of a contact's force.
    pub(crate) limit: f64,
    /// Quantum of forces.
    pub(crate) force_quantum: Quantum,
    /// Quantum of torques.
    pub(crate) torque_quantum: Quantum,
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
