//! Particles of a bed that is set up from Rust.

use crate::domain::Bounds;
use crate::numbers::{random_of, uniform};
use crate::parallel::ParticleRecord;
use bytemuck::Zeroable;
use std::f64::consts::PI;

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

/// Spheres of one size in layers of a square lattice that fills the cross-section of the box, from the bottom upwards.
///
/// A bed on a perfect lattice remains on it for a long time: `jitter` and `speed` break its symmetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// Number of spheres.
    pub count: u64,
    /// Least distance of neighbouring sites, and distance of layers; length.
    pub spacing: f64,
    /// Height of the centres of the lowest layer; length.
    pub bottom: f64,
    /// Diameter; length.
    pub diameter: f64,
    /// Density of the solid; mass per volume.
    pub density: f64,
    /// Largest random displacement from the site along each axis; length.
    pub jitter: f64,
    /// Largest random velocity along each axis; length per time.
    pub speed: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for Layers {
    /// No spheres; diameter and density 1, layers 1.1 apart, at rest on their sites.
    fn default() -> Self {
        Self {
            count: 0,
            spacing: 1.1,
            bottom: 0.55,
            diameter: 1.0,
            density: 1.0,
            jitter: 0.0,
            speed: 0.0,
            seed: 0,
        }
    }
}

impl Layers {
    /// The spheres in a box. Each depends only on its number and the seed.
    pub fn spheres(&self, bounds: &Bounds) -> impl Iterator<Item = Sphere> {
        let lengths = bounds.lengths();
        let sites = [0, 1].map(|axis| ((lengths[axis] / self.spacing) as u64).max(1));
        let layers = *self;
        (0..self.count).map(move |number| {
            let mut generator = random_of(layers.seed, number, "layers");
            let mut vary = |width: f64| width * (2.0 * uniform(&mut generator) - 1.0);
            let layer = (number / (sites[0] * sites[1])) as f64;
            let site = [number % sites[0], (number / sites[0]) % sites[1]].map(|site| site as f64);
            let across = |axis: usize| (site[axis] + 0.5) * lengths[axis] / sites[axis] as f64;
            let height = layers.bottom + layer * layers.spacing;
            let position = [across(0), across(1), height].map(|x| x + vary(layers.jitter));
            let velocity = [(); 3].map(|()| vary(layers.speed));
            Sphere { position, velocity, radius: 0.5 * layers.diameter, density: layers.density }
        })
    }
}
