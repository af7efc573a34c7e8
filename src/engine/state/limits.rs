//! Sizes of the particles, and limits for their forces and speeds.

use crate::contact::{ContactForceLaw, ContactModel, VanDerWaals};
use crate::numbers::Quantum;
use crate::rules::speed_limit;

/// The smallest and largest particles of a run at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeRange {
    /// Smallest diameter.
    pub smallest_diameter: f64,
    /// Largest diameter.
    pub largest_diameter: f64,
    /// Largest mass.
    pub largest_mass: f64,
}

impl SizeRange {
    /// The range of particles of these radii and masses; `None` if there are none.
    pub fn of(particles: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        particles.into_iter().fold(None, |range: Option<Self>, (radius, mass)| {
            let diameter = 2.0 * radius;
            let range = range.unwrap_or(Self {
                smallest_diameter: diameter,
                largest_diameter: diameter,
                largest_mass: mass,
            });
            Some(Self {
                smallest_diameter: range.smallest_diameter.min(diameter),
                largest_diameter: range.largest_diameter.max(diameter),
                largest_mass: range.largest_mass.max(mass),
            })
        })
    }
}

/// Limits for a run: beyond them, its numbers would not be meaningful.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest component of the force of one contact, or of the gas on one particle; force.
    pub force: f64,
    /// Largest speed: a tenth of the smallest diameter per step; length per time.
    pub speed: f64,
}

impl Limits {
    /// Overlap, relative to the smallest diameter, above which a contact is not treated as a contact.
    const LARGEST_OVERLAP: f64 = 0.5;
    /// Number of contacts, each at the limit, that the range of a particle's force allows for.
    const CONTACTS: f64 = 64.0;

    /// Limits for particles between two diameters, the heavier of this weight, with these contact models.
    pub fn new<'a>(
        interfaces: impl IntoIterator<Item = &'a ContactModel>,
        attractions: &[VanDerWaals],
        diameters: [f64; 2],
        largest_weight: f64,
        time_step: f64,
    ) -> Self {
        let [smallest, largest] = diameters;
        let overlap = Self::LARGEST_OVERLAP * smallest;
        let of_law = |interface: &ContactModel| interface.law.largest_force(overlap, 0.5 * largest);
        let elastic = interfaces.into_iter().map(of_law).fold(0.0, f64::max);
        let of_attraction = |law: &VanDerWaals| law.largest_force(0.5 * largest);
        let attraction = attractions.iter().map(of_attraction).fold(0.0, f64::max);
        Self {
            force: elastic + attraction + largest_weight,
            speed: speed_limit(smallest, time_step),
        }
    }

    /// The quantum of forces; its range allows for many contacts at the limit.
    pub fn force_quantum(&self) -> Quantum {
        Quantum::spanning(Self::CONTACTS * self.force)
    }

    /// The quantum of torques, for forces at the largest radius.
    pub fn torque_quantum(&self, largest_radius: f64) -> Quantum {
        Quantum::spanning(Self::CONTACTS * self.force * largest_radius)
    }
}
