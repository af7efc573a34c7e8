//! What a gas may take for granted of the particles.

use crate::numbers::Quantum;

/// Bounds of what particles are and do: sums over them have room for that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleLimits {
    /// Smallest and largest diameter.
    pub diameters: [f64; 2],
    /// Largest component of one particle's gas force.
    pub force: f64,
    /// What forces are rounded to.
    pub force_quantum: Quantum,
    /// Largest speed of particles, and of gas relative to them.
    pub speed: f64,
    /// How far a particle may be from where it was when it was sorted to its rank.
    pub drift: f64,
}
