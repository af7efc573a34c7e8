//! Bounds that a gas assumes for the particles.

use crate::numbers::Quantum;

/// Bounds of the sizes, forces and motion of particles; sums over particles have room for these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleLimits {
    /// Smallest and largest diameter.
    pub diameters: [f64; 2],
    /// Largest component of one particle's gas force.
    pub force: f64,
    /// Quantum to which forces are rounded.
    pub force_quantum: Quantum,
    /// Largest speed of particles, and of gas relative to them.
    pub speed: f64,
    /// Largest distance of a particle from its position when it was sorted to its rank.
    pub drift: f64,
}
