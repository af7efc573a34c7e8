//! The particles at the start of a run.

mod cells;
mod columns;
mod csv;
mod file;
mod lammps;
mod lattice;
mod random_fill;

use super::Case;
use super::particles::BedStart;
use crate::input::InputErrors;
use crate::numbers::{normal, random_of};
use crate::parallel::ParticleRecord;
use crate::state::SizeRange;
use bytemuck::Zeroable;
use nalgebra::Vector3;
use std::path::PathBuf;
use thiserror::Error;

/// Particles that remember nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InitialBed {
    /// Particles in the order of their ids; positions on the lattice of the box, inside it.
    pub particles: Vec<ParticleRecord>,
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
    /// All of it.
    pub const WHOLE: Self = Self { number: 0, of: 1 };

    /// Whether it holds the particle at this place.
    fn holds(self, place: u64) -> bool {
        place % self.of as u64 == self.number as u64
    }
}

/// Why there is no initial bed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BedError {
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
    /// What the case asks for does not fit, or does not suit the sizes of the particles.
    #[error(transparent)]
    Case(#[from] InputErrors),
    /// The start is the end of another run, which this module cannot read.
    #[error("the start is the end of another run, {}: it is read from that checkpoint", .0.display())]
    AnotherRun(PathBuf),
}

/// Not as many particles fit as the case asks for.
fn too_many(case: &Case, room: u64) -> BedError {
    let message = format!("only {room} fit into the box from such a start");
    case.places.errors([("particles.count", message)]).into()
}

/// There is no room for such a start.
fn no_room(case: &Case, reason: impl Into<String>) -> BedError {
    case.places.errors([("particles.start", reason.into())]).into()
}

impl InitialBed {
    /// The sizes that occur; `None` without particles.
    pub fn size_range(&self) -> Option<SizeRange> {
        let first = self.particles.first()?;
        let mut range = SizeRange {
            smallest_diameter: 2.0 * first.radius,
            largest_diameter: 2.0 * first.radius,
            largest_mass: first.mass,
        };
        for particle in &self.particles {
            range.smallest_diameter = range.smallest_diameter.min(2.0 * particle.radius);
            range.largest_diameter = range.largest_diameter.max(2.0 * particle.radius);
            range.largest_mass = range.largest_mass.max(particle.mass);
        }
        Some(range)
    }
}

/// A sphere that is to become a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sphere {
    position: Vector3<f64>,
    diameter: f64,
}

/// A part of the initial bed of a case. Of a lattice nothing else is ever held; each sphere at a random place depends
/// on all before it, and each line of a file may be wrong.
pub(super) fn build(case: &Case, part: BedPart) -> Result<InitialBed, BedError> {
    let spheres = match &case.particles.start {
        BedStart::Lattice { spacing, jitter, bottom } => {
            lattice::fill(case, *spacing, *jitter, *bottom, part)?
        }
        BedStart::Random { solids_fraction, bottom } => {
            let all = random_fill::fill(case, *solids_fraction, *bottom)?;
            (0..).zip(all).filter(|&(id, _)| part.holds(id)).collect()
        }
        BedStart::File { path, format, offset } => {
            let InitialBed { particles } = file::read(case, path, *format, *offset)?;
            let own = particles.into_iter().skip(part.number).step_by(part.of);
            return Ok(InitialBed { particles: own.collect() });
        }
        BedStart::Run { path } => return Err(BedError::AnotherRun(path.clone())),
    };
    let records = spheres.iter().map(|(id, sphere)| record(case, *id, sphere));
    Ok(InitialBed { particles: records.collect() })
}

/// A particle at rest, or with the random velocity that the case wants.
fn record(case: &Case, id: u64, sphere: &Sphere) -> ParticleRecord {
    let bounds = &case.domain.bounds;
    let position = bounds.wrap(bounds.position_quantum().round_vector(sphere.position));
    ParticleRecord {
        id,
        position: position.into(),
        velocity: random_velocity(case, id),
        radius: 0.5 * sphere.diameter,
        mass: case.particles.mass_of_particle(id, sphere.diameter),
        species: case.particles.species_of_particle(id) as f64,
        ..ParticleRecord::zeroed()
    }
}

/// Components normally distributed, their variance the granular temperature.
fn random_velocity(case: &Case, id: u64) -> [f64; 3] {
    let temperature = case.particles.granular_temperature;
    if temperature == 0.0 {
        return [0.0; 3];
    }
    let mut generator = random_of(case.particles.seed, id, "velocity");
    std::array::from_fn(|_| temperature.sqrt() * normal(&mut generator))
}

/// Diameter of a particle that the case draws.
fn diameter_of(case: &Case, id: u64) -> Option<f64> {
    case.particles.sizes.as_ref().map(|sizes| sizes.diameter_of(case.particles.seed, id))
}
