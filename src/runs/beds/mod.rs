//! Initial beds: those of case files, and those from Rust.
//!
//! A case describes its particles by a [`ParticleSetup`], from which [`build`] makes records; [`Layers`] are for
//! [`Setup`](crate::setup::Setup). Both place a [`Sphere`] on the same lattice with the same displacements.

mod cells;
mod file;
mod lattice;
mod lattice_fill;
mod layers;
mod particle_setup;
mod random_fill;
mod sizes;
mod sphere;

pub use layers::Layers;
pub use particle_setup::{Amount, BedFormat, BedStart, ParticleSetup, Species, sphere_mass};
pub use sizes::{SizeClass, SizeDistribution};
pub use sphere::Sphere;

use std::path::PathBuf;
use talcum_engine::numbers::{normal, random_of};
use talcum_engine::particles::ParticleRecord;
use talcum_engine::state::{Domain, SizeRange};
use thiserror::Error;

/// The particles of a bed, without contact histories.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InitialBed {
    /// Particles in the order of their ids; positions on the lattice of the box, inside it.
    pub particles: Vec<ParticleRecord>,
}

impl InitialBed {
    /// The sizes that occur; `None` without particles.
    pub fn size_range(&self) -> Option<SizeRange> {
        SizeRange::of(self.particles.iter().map(|particle| (particle.radius, particle.mass)))
    }
}

/// One of several even parts of a bed: particles in the order of their ids, every `of`-th from `number` on.
#[derive(Clone, Copy, Debug)]
pub struct BedPart {
    /// Which part, from 0.
    pub number: usize,
    /// How many parts there are.
    pub of: usize,
}

impl BedPart {
    /// The whole bed.
    pub const WHOLE: Self = Self { number: 0, of: 1 };

    /// Whether it holds the particle at this place.
    fn holds(self, place: u64) -> bool {
        place % self.of as u64 == self.number as u64
    }
}

/// Keys of a case file whose values have no meaning together, each with a message.
pub type WrongKeys = Vec<(&'static str, String)>;

/// Why there is no initial bed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BedProblem {
    /// The file cannot be read.
    #[error("{}: {reason}", .file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A line of the file is wrong.
    #[error("{}:{line}: {reason}", .file.display())]
    Line {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// What was asked for does not fit, or does not suit the sizes of the particles.
    #[error("{0:?}")]
    Keys(WrongKeys),
    /// The start is the end of another run, which this module cannot read.
    #[error("the start is the end of another run, {}: it is read from that checkpoint", .0.display())]
    AnotherRun(PathBuf),
}

/// Fewer particles fit than are asked for.
fn too_many(room: u64) -> BedProblem {
    let message = format!("only {room} fit into the box from such a start");
    BedProblem::Keys(vec![("particles.count", message)])
}

/// There is no room for such a start.
fn no_room(reason: impl Into<String>) -> BedProblem {
    BedProblem::Keys(vec![("particles.start", reason.into())])
}

/// Everything that determines an initial bed.
#[derive(Clone, Copy)]
pub struct BedPlan<'a> {
    /// The particles.
    pub particles: &'a ParticleSetup,
    /// Box and walls.
    pub domain: &'a Domain,
    /// Checks the sizes of the particles in a file; returns what is wrong with a run of them.
    pub check_sizes: &'a dyn Fn(&SizeRange) -> WrongKeys,
}

/// Makes a part of an initial bed. Only a lattice is made in parts: each sphere at a random place depends on all before
/// it, and any line of a file may be wrong.
///
/// # Errors
/// If the bed does not fit, if its file is wrong, or if the start is the end of another run; the same for all parts.
pub fn build(plan: &BedPlan<'_>, part: BedPart) -> Result<InitialBed, BedProblem> {
    let spheres = match &plan.particles.start {
        BedStart::Lattice { spacing, jitter, bottom } => {
            lattice_fill::fill(plan, *spacing, *jitter, *bottom, part)?
        }
        BedStart::Random { solids_fraction, bottom } => {
            let all = random_fill::fill(plan, *solids_fraction, *bottom)?;
            (0..).zip(all).filter(|&(id, _)| part.holds(id)).collect()
        }
        BedStart::File { path, format, offset } => {
            let InitialBed { particles } = file::read(plan, path, *format, *offset)?;
            let own = particles.into_iter().skip(part.number).step_by(part.of);
            return Ok(InitialBed { particles: own.collect() });
        }
        BedStart::Run { path } => return Err(BedProblem::AnotherRun(path.clone())),
    };
    let records = spheres.iter().map(|(id, sphere)| plan.record(*id, sphere));
    Ok(InitialBed { particles: records.collect() })
}

impl BedPlan<'_> {
    /// The random diameter of a particle; `None` if the case gives no sizes.
    fn diameter_of(&self, id: u64) -> Option<f64> {
        let particles = self.particles;
        particles.sizes.as_ref().map(|sizes| sizes.diameter_of(particles.seed, id))
    }

    /// A sphere in the corner of the box, at rest or with a random velocity, as the case asks.
    fn sphere(&self, id: u64, diameter: f64) -> Sphere {
        Sphere {
            position: [0.0; 3],
            velocity: self.random_velocity(id),
            radius: 0.5 * diameter,
            density: self.particles.density_of_particle(id),
        }
    }

    /// A velocity with normally distributed components, whose variance is the granular temperature.
    fn random_velocity(&self, id: u64) -> [f64; 3] {
        let temperature = self.particles.granular_temperature;
        if temperature == 0.0 {
            return [0.0; 3];
        }
        let mut generator = random_of(self.particles.seed, id, "velocity");
        std::array::from_fn(|_| temperature.sqrt() * normal(&mut generator))
    }

    /// A particle where this sphere is, its position rounded. Its mass is that of [`sphere_mass`]: [`Sphere::record`]
    /// rounds in another order, and digests depend on both.
    fn record(&self, id: u64, sphere: &Sphere) -> ParticleRecord {
        let bounds = &self.domain.bounds;
        let position = bounds.wrap(bounds.position_quantum().round_vector(sphere.position.into()));
        ParticleRecord {
            position: position.into(),
            mass: sphere_mass(sphere.density, sphere.diameter()),
            species: self.particles.species_of_particle(id) as f64,
            ..sphere.record(id)
        }
    }
}
