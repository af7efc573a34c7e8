//! A sphere that is to become a particle.

use bytemuck::Zeroable;
use std::f64::consts::PI;
use talcum_engine::particles::ParticleRecord;

/// A sphere that does not spin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre; length.
    pub position: [f64; 3],
    /// Velocity of the centre; length per time.
    pub velocity: [f64; 3],
    /// Radius; length.
    pub radius: f64,
    /// Density of the solid; mass per volume.
    pub density: f64,
}

impl Sphere {
    /// The sphere that a record describes.
    pub fn of(record: &ParticleRecord) -> Self {
        let ParticleRecord { position, velocity, radius, mass, .. } = *record;
        Self { position, velocity, radius, density: mass / (4.0 / 3.0 * PI * radius.powi(3)) }
    }

    /// Diameter; length.
    pub fn diameter(&self) -> f64 {
        2.0 * self.radius
    }

    /// The record of the particle with this id, its mass (4/3) pi rho r^3.
    pub fn record(&self, id: u64) -> ParticleRecord {
        ParticleRecord {
            id,
            position: self.position,
            velocity: self.velocity,
            radius: self.radius,
            mass: self.density * 4.0 / 3.0 * PI * self.radius.powi(3),
            ..ParticleRecord::zeroed()
        }
    }
}
