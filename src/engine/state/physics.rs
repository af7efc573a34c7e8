//! The models that act on the particles, before the particles' sizes are known.

use super::{Limits, SizeRange};
use crate::contact::{
    ByPair, BySpecies, CoarseGraining, ContactForceLaw, ContactModel, Exchanges, VanDerWaals,
    VanDerWaalsNow,
};
use crate::domain::EffectiveGravity;
use crate::gas::GasModel;
use crate::rules::interaction_range;

/// The models that act on the particles during one stage of a run, in one coherent system of units. Together with the
/// sizes of the particles they give the [`Models`](super::Models).
#[derive(Clone, Debug, PartialEq)]
pub struct Physics {
    /// Contact of two particles, by pair of species.
    pub contact: ByPair<ContactModel>,
    /// Contact of particles and walls, by the numbers of the walls; walls beyond its end behave like particles of the
    /// same species.
    pub at_walls: Vec<BySpecies<ContactModel>>,
    /// Attraction, by pair of species; at walls, that of two particles of the same species applies.
    pub cohesion: Option<ByPair<VanDerWaals>>,
    /// Quantities other than momentum that touching particles exchange.
    pub exchanges: Exchanges,
    /// Gas.
    pub gas: GasModel,
    /// Gravity along -z in the frame of the plate.
    pub gravity: EffectiveGravity,
    /// Length of a step; time.
    pub time_step: f64,
}

impl Physics {
    /// Contacts alone: without cohesion, gas and gravity, and with walls like the particles.
    pub fn new(contact: impl Into<ContactModel>, time_step: f64) -> Self {
        Self {
            contact: ByPair::of_all(contact.into()),
            at_walls: Vec::new(),
            cohesion: None,
            exchanges: Exchanges::default(),
            gas: GasModel::None,
            gravity: EffectiveGravity { magnitude: 0.0, vibration: None },
            time_step,
        }
    }

    /// These models, scaled for parcels.
    #[must_use]
    pub fn coarse_grained(self, parcels: &CoarseGraining) -> Self {
        let contact = |model: &ContactModel| model.coarse_grained(parcels);
        Self {
            contact: self.contact.map(contact),
            at_walls: self.at_walls.iter().map(|at_wall| at_wall.map(contact)).collect(),
            cohesion: self.cohesion.map(|cohesion| cohesion.map(|law| law.coarse_grained(parcels))),
            gas: self.gas.around_parcels(parcels.factor),
            ..self
        }
    }

    /// All contact models: of two particles, and of particles and walls.
    pub fn contact_models(&self) -> impl Iterator<Item = &ContactModel> {
        let at_walls = self.at_walls.iter().flat_map(BySpecies::values);
        self.contact.values().iter().chain(at_walls)
    }

    /// The attraction at a time.
    pub fn cohesion_at(&self, time: f64) -> Option<ByPair<VanDerWaalsNow>> {
        self.cohesion.as_ref().map(|cohesion| cohesion.map(|law| law.at(time)))
    }

    /// The attraction of each pair of species.
    pub fn attractions(&self) -> &[VanDerWaals] {
        self.cohesion.as_ref().map_or(&[], ByPair::values)
    }

    /// Separation of surfaces up to which particles of these sizes, or they and walls, act on each other.
    pub fn range(&self, sizes: &SizeRange) -> f64 {
        range_of(self.contact_models(), self.attractions(), sizes)
    }

    /// The limits for particles of these sizes.
    pub fn limits(&self, sizes: &SizeRange) -> Limits {
        Limits::new(
            self.contact_models(),
            self.attractions(),
            [sizes.smallest_diameter, sizes.largest_diameter],
            sizes.largest_mass * self.gravity.largest(),
            self.time_step,
        )
    }
}

/// Separation of surfaces up to which bodies with these contact models act on each other, for particles of these sizes.
pub(super) fn range_of<'a>(
    models: impl IntoIterator<Item = &'a ContactModel>,
    attractions: &[VanDerWaals],
    sizes: &SizeRange,
) -> f64 {
    let largest_radius = 0.5 * sizes.largest_diameter;
    let reaches = models.into_iter().map(|model| model.law.contact_range(largest_radius));
    let range = attractions.iter().map(|law| law.range).reduce(f64::max);
    interaction_range(reaches, range)
}
