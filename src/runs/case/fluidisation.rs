//! The gas velocity at which the gas of a stage carries a bed at rest.

use super::{Case, Stage};
use talcum_results::analysis::minimum_fluidisation::velocity_of_balance;

impl Case {
    /// U_mf from the force balance in a stage: the superficial velocity at which the gas carries the weight of a bed at
    /// rest of particles of the reference diameter, at a solids fraction. `None` without gas or gravity.
    pub fn minimum_fluidisation(&self, stage: &Stage, solids_fraction: f64) -> Option<f64> {
        let diameter = self.particles.reference_diameter;
        let weight = self.particles.mass_of(diameter) * stage.physics.gravity.magnitude;
        velocity_of_balance(&stage.physics.gas, (diameter, weight), solids_fraction)
    }
}
