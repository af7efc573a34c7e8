//! A stage: a part of the run during which the same models hold.

use crate::contact::{ContactModel, VanDerWaals};
use crate::domain::EffectiveGravity;
use crate::gas::GasModel;
use crate::state::{Limits, Models, SizeRange};

/// A part of the run during which the same models hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// When it begins.
    pub start: f64,
    /// When it ends: the next one's start.
    pub end: f64,
    /// Length of a step.
    pub time_step: f64,
    /// Where particles touch.
    pub contact: ContactModel,
    /// Where they touch the walls, by the walls' numbers.
    pub at_walls: Vec<ContactModel>,
    /// Attraction.
    pub cohesion: Option<VanDerWaals>,
    /// Gas.
    pub gas: GasModel,
    /// Gravity in the frame of the plate.
    pub gravity: EffectiveGravity,
}

impl Stage {
    /// The models of this stage for particles of these sizes.
    ///
    /// The sizes are those at the start of the run, also in a restart: limits and lattices follow from them.
    pub fn models(&self, sizes: &SizeRange) -> Models {
        let limits = self.limits(sizes);
        Models {
            contact: self.contact.clone(),
            at_walls: self.at_walls.clone(),
            cohesion: self.cohesion.clone(),
            gas: self.gas.clone(),
            gravity: self.gravity,
            time_step: self.time_step,
            limits,
            force_quantum: limits.force_quantum(),
            torque_quantum: limits.torque_quantum(0.5 * sizes.largest_diameter),
        }
    }

    /// All ways in which bodies touch.
    pub fn interfaces(&self) -> impl Iterator<Item = &ContactModel> {
        std::iter::once(&self.contact).chain(&self.at_walls)
    }

    /// What particles of these sizes may not exceed.
    pub(super) fn limits(&self, sizes: &SizeRange) -> Limits {
        Limits::new(
            self.interfaces(),
            self.cohesion.as_ref(),
            [sizes.smallest_diameter, sizes.largest_diameter],
            sizes.largest_mass * self.gravity.largest(),
            self.time_step,
        )
    }
}
