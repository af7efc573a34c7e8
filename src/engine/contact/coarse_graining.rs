//! Parcels: bodies of the run that represent many particles each.
//!
//! A parcel is l times as large as its particles, has the same density, and moves at their velocity. Its contacts are
//! similar to theirs: at l times the overlap all forces, of springs and of adhesion, are multiplied by one factor, and
//! restitution and friction are kept. No factor keeps all properties (Di Renzo et al. 2021, section 3, compare the
//! rules in use):
//!
//! | kept | forces | stiffnesses | work of separation | duration of a contact | what stays | what changes |
//! | --- | --- | --- | --- | --- | --- | --- |
//! | `strength` | l^2 | l | l^3 | l | stresses, tensile strength, overlap over the diameter in an impact, speed below which impacts stick (Bierwisch et al. 2009) | Bond number F / (m g), by 1 / l |
//! | `bond_number` | l^3 | l^2 | l^4 | l^(1/2) | F, k d and work of separation over d, all over the weight m g | tensile strength and the square of the speed of sticking, by l |
//!
//! References:
//! * C. Bierwisch, T. Kraft, H. Riedel, M. Moseler, "Three-dimensional discrete element models for the granular statics and
//!   dynamics of powders in cavity filling", J. Mech. Phys. Solids 57 (2009) 10-31, <https://doi.org/10.1016/j.jmps.2008.10.006>
//! * A. Di Renzo, E. S. Napolitano, F. P. Di Maio, "Coarse-grain DEM modelling in fluidized bed simulation: a review",
//!   Processes 9 (2021) 279, <https://doi.org/10.3390/pr9020279>

use crate::schema::{Allowed, Key, Word};

const FACTOR: Key = Key::number(
    "factor",
    Allowed::at_least(1.0),
    "Diameter l of a parcel over that of its particles, of which it stands for l^3",
);

const WORDS: &[Word] = &[
    Word::new(
        "strength",
        "forces grow as l^2: tensile strength and the speed of sticking stay, the Bond number falls as 1 / l",
    ),
    Word::new(
        "bond_number",
        "forces grow as l^3, like the weight: the Bond number stays, tensile strength grows as l",
    ),
];

/// The keys of `[coarse_graining]`.
pub const COARSE_GRAINING: &[Key] =
    &[FACTOR, Key::word("keeps", WORDS, "What stays of contacts and cohesion")];

/// Property of the contacts and the adhesion of particles that parcels keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// Force over the square of the diameter.
    Strength,
    /// Force over the weight.
    BondNumber,
}

impl Kept {
    /// Each with its name under `keeps` in the case file.
    pub const ALL: [(&'static str, Self); 2] =
        [("strength", Self::Strength), ("bond_number", Self::BondNumber)];
}

/// Parcels, and the property that they keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoarseGraining {
    /// l, the ratio of the diameter of a parcel to that of its particles; at least 1.
    pub factor: f64,
    /// Property of their contacts and their adhesion that is kept.
    pub keeps: Kept,
}

impl CoarseGraining {
    /// Number of particles in a parcel, l^3.
    pub fn particles(&self) -> f64 {
        self.factor * self.factor * self.factor
    }

    /// The factor of lengths: diameters, overlaps, ranges.
    pub fn length(&self) -> f64 {
        self.factor
    }

    /// The factor of forces of contact and adhesion.
    pub fn force(&self) -> f64 {
        match self.keeps {
            Kept::Strength => self.factor * self.factor,
            Kept::BondNumber => self.particles(),
        }
    }

    /// The factor of force over length: stiffnesses, surface energies.
    pub fn stiffness(&self) -> f64 {
        self.force() / self.length()
    }

    /// The factor of force over area: elastic moduli.
    pub fn stress(&self) -> f64 {
        self.stiffness() / self.length()
    }

    /// The factor of Hamaker constants, force times length.
    pub fn energy(&self) -> f64 {
        self.force() * self.length()
    }
}
