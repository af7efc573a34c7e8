//! What acts on the particles, before their sizes are known.

use super::{Limits, SizeRange};
use crate::contact::{ContactForceLaw, ContactModel, VanDerWaals};
use crate::domain::EffectiveGravity;
use crate::gas::GasModel;
use crate::rules::interaction_range;

/// What acts on the particles during one stage of a run, in one coherent system of units. With the sizes of the
/// particles, [`Models`](super::Models) follow from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Physics {
    /// Contact of two particles.
    pub contact: ContactModel,
    /// Contact of particles and walls, by the walls' numbers; walls beyond its end are like particles.
    pub at_walls: Vec<ContactModel>,
    /// Attraction.
    pub cohesion: Option<VanDerWaals>,
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
            contact: contact.into(),
            at_walls: Vec::new(),
            cohesion: None,
            gas: GasModel::None,
            gravity: EffectiveGravity { magnitude: 0.0, vibration: None },
            time_step,
        }
    }

    /// The contact models: of two particles, and of particles and walls.
    pub fn contact_models(&self) -> impl Iterator<Item = &ContactModel> {
        std::iter::once(&self.contact).chain(&self.at_walls)
    }

    /// Separation of surfaces up to which particles of these sizes, or they and walls, act on each other.
    pub fn range(&self, sizes: &SizeRange) -> f64 {
        range_of(self.contact_models(), self.cohesion.as_ref(), sizes)
    }

    /// What particles of these sizes may not exceed.
    pub fn limits(&self, sizes: &SizeRange) -> Limits {
        Limits::new(
            self.contact_models(),
            self.cohesion.as_ref(),
            [sizes.smallest_diameter, sizes.largest_diameter],
            sizes.largest_mass * self.gravity.largest(),
            self.time_step,
        )
    }
}

/// Separation of surfaces up to which bodies of these contact models act on each other, particles being of these sizes.
pub(super) fn range_of<'a>(
    models: impl IntoIterator<Item = &'a ContactModel>,
    cohesion: Option<&VanDerWaals>,
    sizes: &SizeRange,
) -> f64 {
    let largest_radius = 0.5 * sizes.largest_diameter;
    let reaches = models.into_iter().map(|model| model.law.contact_range(largest_radius));
    interaction_range(reaches, cohesion.map(|cohesion| cohesion.range))
}
