//! The particle of the reference diameter.

use talcum_runs::case::{Case, Stage};

/// The reference particle of dimensionless numbers.
pub(super) struct ReferenceParticle {
    pub(super) diameter: f64,
    pub(super) density: f64,
    pub(super) mass: f64,
    pub(super) gravity: f64,
}

impl ReferenceParticle {
    pub(super) fn of(case: &Case, stage: &Stage) -> Self {
        let diameter = case.particles.reference_diameter;
        let mass = case.particles.mass_of(diameter);
        let gravity = stage.physics.gravity.magnitude;
        Self { diameter, density: case.particles.density, mass, gravity }
    }

    pub(super) fn weight(&self) -> f64 {
        self.mass * self.gravity
    }
}
