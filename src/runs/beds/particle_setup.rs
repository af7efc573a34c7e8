//! The particles of an initial bed: how many there are, of what, and where they begin.

use super::{SizeClass, SizeDistribution};
use nalgebra::Vector3;
use std::f64::consts::PI;
use std::path::PathBuf;
use talcum_engine::contact::CoarseGraining;
use talcum_engine::state::SizeRange;

/// The particles of a bed.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleSetup {
    /// How many; `None` if a file says it.
    pub amount: Option<Amount>,
    /// Diameters; `None` if a file says them.
    pub sizes: Option<SizeDistribution>,
    /// Diameter that Bond and Stokes number refer to.
    pub reference_diameter: f64,
    /// Solid density, also that of Bond and Stokes number.
    pub density: f64,
    /// Seed of all random numbers; 0 if none are drawn.
    pub seed: u64,
    /// Where they begin.
    pub start: BedStart,
    /// T of the random velocities at the start, the variance of each component.
    pub granular_temperature: f64,
    /// The species; none if all particles are of one that has no name.
    pub species: Vec<Species>,
}

/// How many particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// This many.
    Count(u64),
    /// As many as fit below this height.
    FillHeight(f64),
}

/// Where the particles begin.
#[derive(Clone, Debug, PartialEq)]
pub enum BedStart {
    /// Layers of a simple cubic lattice.
    Lattice {
        /// Least distance of neighbouring sites.
        spacing: f64,
        /// Random displacement over the largest one without contact.
        jitter: f64,
        /// Height of the lowest layer's underside.
        bottom: f64,
    },
    /// Random, loose, without overlap.
    Random {
        /// Solids fraction.
        solids_fraction: f64,
        /// Height of the bed's underside.
        bottom: f64,
    },
    /// The rows of a file.
    File {
        /// Its path.
        path: PathBuf,
        /// Its format.
        format: BedFormat,
        /// Added to all positions.
        offset: Vector3<f64>,
    },
    /// The end of another run.
    Run {
        /// Path of its checkpoint.
        path: PathBuf,
    },
}

/// Formats of files that hold a bed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BedFormat {
    /// A table with a header.
    Csv,
    /// A dump of LAMMPS or LIGGGHTS; its last frame.
    Lammps,
}

/// A species of particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Species {
    /// Its name.
    pub name: String,
    /// Its solid density, if it is not that of the case.
    pub density: Option<f64>,
}

impl ParticleSetup {
    /// The size classes; none if sizes are not in classes.
    pub fn classes(&self) -> &[SizeClass] {
        self.sizes.as_ref().map_or(&[], SizeDistribution::classes)
    }

    /// Mass of a sphere of this diameter and of the density of the case, rho_s pi d^3 / 6.
    pub fn mass_of(&self, diameter: f64) -> f64 {
        sphere_mass(self.density, diameter)
    }

    /// Mass of a particle: that of its class, or of the density of the bed.
    pub fn mass_of_particle(&self, id: u64, diameter: f64) -> f64 {
        sphere_mass(self.density_of_particle(id), diameter)
    }

    /// Density of a particle: that of its class, or of the bed.
    pub(super) fn density_of_particle(&self, id: u64) -> f64 {
        let class = self.class_of_particle(id);
        class.map_or(self.density_of_species(0), |class| self.density_of(class))
    }

    /// Number of the species of a particle: that of its class, or the first.
    pub fn species_of_particle(&self, id: u64) -> usize {
        self.class_of_particle(id).map_or(0, |class| class.species)
    }

    fn class_of_particle(&self, id: u64) -> Option<&SizeClass> {
        self.sizes.as_ref().and_then(|sizes| sizes.class_of(self.seed, id))
    }

    /// Mass of a particle of the reference diameter and of a species.
    pub fn reference_mass(&self, species: usize) -> f64 {
        sphere_mass(self.density_of_species(species), self.reference_diameter)
    }

    /// How many species there are.
    pub fn species_count(&self) -> usize {
        self.species.len().max(1)
    }

    /// Solid density of a species.
    pub fn density_of_species(&self, species: usize) -> f64 {
        self.species.get(species).and_then(|species| species.density).unwrap_or(self.density)
    }

    /// The class of a particle of this diameter, mass and species; `None` if there is no such class, or several.
    pub fn class_number(&self, diameter: f64, mass: f64, species: usize) -> Option<usize> {
        let mut like = self.classes().iter().enumerate().filter(|(_, class)| {
            class.species == species
                && class.diameter == diameter
                && sphere_mass(self.density_of(class), diameter) == mass
        });
        like.next().filter(|_| like.next().is_none()).map(|(number, _)| number)
    }

    /// Whether particles may differ in density.
    pub fn has_several_densities(&self) -> bool {
        let of_species = self.species.iter().any(|species| species.density.is_some());
        of_species || self.sizes.as_ref().is_some_and(SizeDistribution::has_densities)
    }

    /// Mass and radius of the lightest particle of a species; `smallest` is the least diameter of all particles, which counts
    /// where sizes are not in classes.
    pub fn lightest_of_species(&self, species: usize, smallest: f64) -> (f64, f64) {
        let of_class = |class: &SizeClass| {
            (sphere_mass(self.density_of(class), class.diameter), 0.5 * class.diameter)
        };
        let classes = self.classes().iter().filter(|class| class.species == species);
        let lightest = classes.map(of_class).min_by(|one, other| one.0.total_cmp(&other.0));
        let of_smallest =
            || (sphere_mass(self.density_of_species(species), smallest), 0.5 * smallest);
        lightest.unwrap_or_else(of_smallest)
    }

    fn density_of(&self, class: &SizeClass) -> f64 {
        class.density.unwrap_or(self.density)
    }

    /// Mass over volume of many particles as the case draws them.
    pub fn mean_density(&self) -> f64 {
        let sums = self.classes().iter().fold([0.0; 2], |[mass, volume], class| {
            let share = class.fraction * class.diameter.powi(3);
            [mass + share * self.density_of(class), volume + share]
        });
        match self.classes() {
            [] => self.density_of_species(0),
            _ if self.has_several_densities() => sums[0] / sums[1],
            _ => self.density,
        }
    }

    /// Sum d sum d^3 / (sum d^2)^2 - 1 of the diameters that the case draws: by how much the viscous drag of a packed bed is
    /// larger if each particle has that of a bed of its own size. `None` if all are of one size, or a file says the sizes.
    pub fn drag_excess(&self) -> Option<f64> {
        /// Particles that are drawn.
        const SAMPLE: u64 = 2000;
        let sizes = self.sizes.as_ref().filter(|sizes| sizes.bounds()[0] < sizes.bounds()[1])?;
        let diameters = (0..SAMPLE).map(|id| sizes.diameter_of(self.seed, id));
        let sums = diameters.fold([0.0; 3], |[first, second, third], d| {
            [first + d, second + d.powi(2), third + d.powi(3)]
        });
        Some(sums[0] * sums[2] / sums[1].powi(2) - 1.0)
    }

    /// The range that sizes can have; `None` if a file says it.
    pub fn size_range(&self) -> Option<SizeRange> {
        if !matches!(self.start, BedStart::Lattice { .. } | BedStart::Random { .. }) {
            return None;
        }
        let [smallest_diameter, largest_diameter] = self.sizes.as_ref()?.bounds();
        let mass = |class: &SizeClass| sphere_mass(self.density_of(class), class.diameter);
        let of_classes = self.classes().iter().map(mass).reduce(f64::max);
        let of_first = || sphere_mass(self.density_of_species(0), largest_diameter);
        let largest_mass = of_classes.unwrap_or_else(of_first);
        Some(SizeRange { smallest_diameter, largest_diameter, largest_mass })
    }

    /// The parcels of these particles.
    pub fn coarse_grained(self, parcels: &CoarseGraining) -> Self {
        let length = parcels.length();
        let amount = |amount| match amount {
            Amount::Count(count) => {
                Amount::Count((count as f64 / parcels.particles()).round() as u64)
            }
            Amount::FillHeight(height) => Amount::FillHeight(height),
        };
        let start = match self.start {
            BedStart::Lattice { spacing, jitter, bottom } => {
                BedStart::Lattice { spacing: length * spacing, jitter, bottom }
            }
            other => other,
        };
        Self {
            amount: self.amount.map(amount),
            sizes: self.sizes.map(|sizes| sizes.enlarged(length)),
            reference_diameter: length * self.reference_diameter,
            start,
            ..self
        }
    }
}

/// rho_s pi d^3 / 6.
pub fn sphere_mass(density: f64, diameter: f64) -> f64 {
    density * PI / 6.0 * diameter * diameter * diameter
}
