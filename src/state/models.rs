//! What acts on the particles.

use super::{Limits, SizeRange};
use crate::contact::{ContactForceLaw, ContactModel, VanDerWaals};
use crate::domain::EffectiveGravity;
use crate::gas::GasModel;
use crate::numbers::Quantum;
use crate::particles::Weight;
use crate::rules::interaction_range;

/// What acts on the particles: chosen by the case for one stage of the run, and immutable.
#[derive(Clone, Debug, PartialEq)]
pub struct Models {
    /// Where particles touch.
    pub contact: ContactModel,
    /// Where they touch the walls, by the walls' numbers; walls beyond its end are like particles.
    pub at_walls: Vec<ContactModel>,
    /// Attraction.
    pub cohesion: Option<VanDerWaals>,
    /// Gas.
    pub gas: GasModel,
    /// Gravity in the frame of the plate.
    pub gravity: EffectiveGravity,
    /// Length of a step.
    pub time_step: f64,
    /// Bounds of what particles may do; beyond them the run stops with an error message.
    pub limits: Limits,
    /// Lattice that forces are rounded to.
    pub force_quantum: Quantum,
    /// Lattice that torques are rounded to.
    pub torque_quantum: Quantum,
}

impl Models {
    /// What particles weigh in the frame of the plate.
    pub fn weight_at(&self, time: f64) -> Weight {
        Weight { gravity: self.gravity.at(time), quantum: self.force_quantum }
    }

    /// Separation of surfaces up to which particles of these sizes, or they and walls, act on each other.
    pub fn range(&self, sizes: &SizeRange) -> f64 {
        let interfaces = std::iter::once(&self.contact).chain(&self.at_walls);
        range_of(interfaces, self.cohesion.as_ref(), sizes)
    }

    /// Separation of surfaces up to which contacts of particles of these sizes act.
    pub fn contact_range(&self, sizes: &SizeRange) -> f64 {
        range_of([&self.contact], None, sizes)
    }
}

/// Separation of surfaces up to which bodies act on each other that touch in these ways, particles being of
/// these sizes.
pub fn range_of<'a>(
    interfaces: impl IntoIterator<Item = &'a ContactModel>,
    cohesion: Option<&VanDerWaals>,
    sizes: &SizeRange,
) -> f64 {
    let largest_radius = 0.5 * sizes.largest_diameter;
    let reaches =
        interfaces.into_iter().map(|interface| interface.law.contact_range(largest_radius));
    interaction_range(reaches, cohesion.map(|cohesion| cohesion.range))
}
