//! The forces between particles, and between particles and walls, at one instant.

use super::{ByPair, BySpecies, ContactModel, Exchanges, VanDerWaalsNow};
use crate::numbers::Quantum;
use crate::particles::InteractionRanges;
use nalgebra::Vector3;
use thiserror::Error;

/// A contact force above the limit of the case: the time step is too long, or particles overlapped at the start.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "the contact of particle {particle} with {other} has a force of {force:.3e} (limit {limit:.3e}), at an \
     overlap of {overlap:.3e}: shorten time.step, or check the start for overlaps"
)]
pub struct ForceOutOfRange {
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
#[derive(Clone, Debug)]
pub struct ForceLaws<'a> {
    /// Contact models of two particles.
    pub(crate) contact: &'a ByPair<ContactModel>,
    /// Contact models of particles and walls, by the numbers of the walls; for walls beyond its end, those of two
    /// particles of the same species hold.
    pub(crate) at_walls: &'a [BySpecies<ContactModel>],
    /// Attraction at this instant; at walls, that of two particles of the same species applies.
    pub(crate) cohesion: Option<ByPair<VanDerWaalsNow>>,
    /// Quantities other than momentum that touching particles exchange.
    pub(crate) exchanges: &'a Exchanges,
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

/// The laws of the pairs of one kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairLaws<'a> {
    /// Contact model.
    pub(crate) contact: &'a ContactModel,
    /// Attraction at this instant.
    pub(crate) cohesion: Option<VanDerWaalsNow>,
    /// As in [`ForceLaws`].
    pub(crate) dt: f64,
    /// As in [`ForceLaws`].
    pub(crate) limit: f64,
    /// Quantum of forces.
    pub(crate) force_quantum: Quantum,
    /// Quantum of torques.
    pub(crate) torque_quantum: Quantum,
}

/// The laws of particles of one species at one wall.
#[derive(Clone, Copy, Debug)]
pub struct WallLaws<'a> {
    /// Contact model.
    pub(crate) contact: &'a ContactModel,
    /// Attraction at this instant.
    pub(crate) cohesion: Option<VanDerWaalsNow>,
}

impl<'a> ForceLaws<'a> {
    /// The laws of a kind of pairs, by its number.
    pub(crate) fn of_kind(&self, kind: usize) -> PairLaws<'a> {
        let Self { dt, limit, force_quantum, torque_quantum, .. } = *self;
        let contact = self.contact.of_kind(kind);
        let cohesion = self.cohesion.as_ref().map(|cohesion| *cohesion.of_kind(kind));
        PairLaws { contact, cohesion, dt, limit, force_quantum, torque_quantum }
    }

    /// The laws of a species at a wall.
    #[inline(always)]
    pub fn at_wall(&self, wall: usize, species: usize) -> WallLaws<'a> {
        WallLaws::of(wall, species, (self.contact, self.at_walls), self.cohesion.as_ref())
    }
}

impl<'a> WallLaws<'a> {
    /// The laws of a wall and a species, from the contact models of pairs and of walls.
    #[inline(always)]
    pub fn of(
        wall: usize,
        species: usize,
        (of_pairs, at_walls): (&'a ByPair<ContactModel>, &'a [BySpecies<ContactModel>]),
        cohesion: Option<&ByPair<VanDerWaalsNow>>,
    ) -> Self {
        let alike = [species; 2];
        let contact = match at_walls.get(wall) {
            Some(models) => models.of(species),
            None => of_pairs.of(alike),
        };
        Self { contact, cohesion: cohesion.map(|cohesion| *cohesion.of(alike)) }
    }
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
