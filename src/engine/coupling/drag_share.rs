//! Distribution of drag among particles of different sizes.

use std::f64::consts::PI;

/// The quantity to which the drag on a particle is proportional among its neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DragShare {
    /// The diameter d: each particle has the drag of a bed of its own size.
    #[default]
    Diameter,
    /// The surface, d^2: all particles together have the drag of a bed of the Sauter mean diameter, sum d^3 / sum d^2.
    Surface,
}

impl DragShare {
    /// The share of a particle, d or d^2.
    #[inline(always)]
    pub fn of(self, diameter: f64) -> f64 {
        match self {
            Self::Diameter => diameter,
            Self::Surface => diameter * diameter,
        }
    }

    /// The diameter of equal spheres that have this solids fraction and whose shares per volume have this sum: the
    /// square root of 6 phi / (pi sum d), or 6 phi / (pi sum d^2).
    #[inline(always)]
    pub fn diameter_of_equals(self, solids_fraction: f64, shares: f64) -> f64 {
        let ratio = 6.0 * solids_fraction / (PI * shares);
        match self {
            Self::Diameter => ratio.sqrt(),
            Self::Surface => ratio,
        }
    }
}
