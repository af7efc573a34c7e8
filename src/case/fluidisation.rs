//! The gas velocity at which the gas of a stage carries a bed at rest.

use super::{Case, Stage};
use crate::gas::GasModel;
use crate::rules::minimum_fluidisation_velocity;

impl Case {
    /// U_mf from the force balance in a stage: the superficial velocity at which the gas carries the weight of a bed at
    /// rest of particles of the reference diameter, at a solids fraction. `None` without gas or gravity.
    pub fn minimum_fluidisation(&self, stage: &Stage, solids_fraction: f64) -> Option<f64> {
        let diameter = self.particles.reference_diameter;
        let weight = self.particles.mass_of(diameter) * stage.physics.gravity.magnitude;
        let drag = match &stage.physics.gas {
            GasModel::None => return None,
            GasModel::Column(gas) => gas.particle_drag(),
            GasModel::VolumeAveraged(model) => model.coupling.drag.clone(),
        };
        let per_velocity = |velocity: f64| drag.per_velocity(diameter, solids_fraction, velocity);
        let balance = || minimum_fluidisation_velocity(per_velocity, weight, solids_fraction);
        (weight > 0.0 && (0.0..1.0).contains(&solids_fraction)).then(balance)
    }
}
