//! Layers of spheres, for beds from Rust.

use super::Sphere;
use super::lattice::{Lattice, Row, displaced, displacement};
use talcum_engine::domain::Bounds;
use talcum_engine::numbers::random_of;

/// Spheres of one size in layers of a square lattice that fills the cross-section of the box, from below upwards.
///
/// A bed on a perfect lattice stays on it for long: `jitter` and `speed` break its symmetry.
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
    /// No spheres, of diameter and density 1, in layers 1.1 apart, at rest on their sites.
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
        let (layers, lattice) = (*self, self.lattice(bounds));
        (0..self.count).map(move |number| {
            let mut generator = random_of(layers.seed, number, "layers");
            let shift = displacement(&mut generator, [layers.jitter; 3]);
            Sphere {
                position: displaced(lattice.site(number), shift),
                velocity: displacement(&mut generator, [layers.speed; 3]),
                radius: 0.5 * layers.diameter,
                density: layers.density,
            }
        })
    }

    fn lattice(&self, bounds: &Bounds) -> Lattice {
        let lengths = bounds.lengths();
        let counts = [0, 1].map(|axis| ((lengths[axis] / self.spacing) as u64).max(1));
        let across = |axis: usize| {
            let (step, parts) = (lengths[axis], counts[axis] as f64);
            Row { origin: 0.0, offset: 0.5, step, parts }
        };
        let upwards = Row { origin: self.bottom, offset: 0.0, step: self.spacing, parts: 1.0 };
        Lattice { counts, rows: [across(0), across(1), upwards] }
    }
}
