//! The models that act on the particles, and their limits for particles of given sizes.

use super::physics::range_of;
use super::{Limits, Physics, SizeRange};
use crate::numbers::Quantum;
use crate::particles::Weight;

/// The models that act on the particles of a run during one stage, with quantities that follow from the particles'
/// sizes; immutable.
#[derive(Clone, Debug, PartialEq)]
pub struct Models {
    /// The models themselves.
    pub physics: Physics,
    /// Limits for forces and speeds; beyond them the run stops with an error message.
    pub limits: Limits,
    /// Quantum to whose multiples forces are rounded.
    pub force_quantum: Quantum,
    /// Quantum to whose multiples torques are rounded.
    pub torque_quantum: Quantum,
}

impl Models {
    /// Models for particles of these sizes, which are those at the start of the run, also after a restart: limits and
    /// quanta follow from them.
    pub fn of(physics: &Physics, sizes: &SizeRange) -> Self {
        Self::new(physics.clone(), physics.limits(sizes), sizes)
    }

    /// Models with these limits for particles of these sizes; [`Models::of`] gives the limits that follow from the
    /// physics.
    pub fn new(physics: Physics, limits: Limits, sizes: &SizeRange) -> Self {
        let force_quantum = limits.force_quantum();
        let torque_quantum = limits.torque_quantum(0.5 * sizes.largest_diameter);
        Self { physics, limits, force_quantum, torque_quantum }
    }

    /// Weight of the particles in the frame of the plate.
    pub fn weight_at(&self, time: f64) -> Weight {
        Weight { gravity: self.physics.gravity.at(time), quantum: self.force_quantum }
    }

    /// Separation of surfaces up to which particles of these sizes, or they and walls, act on each other.
    pub fn range(&self, sizes: &SizeRange) -> f64 {
        self.physics.range(sizes)
    }

    /// Separation of surfaces up to which contacts of particles of these sizes act.
    pub fn contact_range(&self, sizes: &SizeRange) -> f64 {
        range_of(self.physics.contact.values(), &[], sizes)
    }
}
