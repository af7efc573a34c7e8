//! Particles from a file.

use super::super::particles::{BedFormat, sphere_mass};
use super::cells::Cells;
use super::columns::{At, Row, Rows};
use super::{BedError, InitialBed, Sphere, csv, diameter_of, lammps, record};
use crate::case::Case;
use crate::input::{NOT_UTF8, utf8_text};
use nalgebra::Vector3;
use std::path::Path;

/// Overlap over the smaller diameter that a file may hold.
const MOST_OVERLAP: f64 = 0.2;
/// A position more periods away from the box is a mistake.
const MOST_TURNS: f64 = 1000.0;

/// The bed that a file holds, in the order of ids.
pub(super) fn read(
    case: &Case,
    file: &Path,
    format: BedFormat,
    offset: Vector3<f64>,
) -> Result<InitialBed, BedError> {
    let failed = |reason: String| BedError::File { file: file.to_owned(), reason };
    let bytes = std::fs::read(file).map_err(|error| failed(format!("cannot be read: {error}")))?;
    let text = utf8_text(bytes).map_err(|line| At { file, line }.error(NOT_UTF8))?;
    let Rows { mut rows, have_velocities } = match format {
        BedFormat::Csv => csv::parse(&text, file, &case.particles.species)?,
        BedFormat::Lammps => lammps::parse(&text, file, case.particles.species.len())?,
    };
    if rows.is_empty() {
        return Err(failed("holds no particles".to_owned()));
    }
    if have_velocities && case.particles.granular_temperature > 0.0 {
        let words = "holds velocities: particles.start.velocity cannot be given too";
        return Err(failed(words.to_owned()));
    }
    rows.sort_by_key(|row| (row.id, row.line));
    if let Some(pair) = rows.windows(2).find(|pair| pair[0].id == pair[1].id) {
        let at = At { file, line: pair[1].line };
        return Err(at.error(format!("id {} is that of line {} too", pair[0].id, pair[0].line)));
    }
    let bed = bed_of(case, &rows, offset, file)?;
    bed.size_range().map_or(Ok(()), |sizes| case.require_sizes(&sizes))?;
    let lines: Vec<usize> = rows.iter().map(|row| row.line).collect();
    check_overlaps(case, &bed, |number| At { file, line: lines[number] })?;
    Ok(bed)
}

fn bed_of(
    case: &Case,
    rows: &[Row],
    offset: Vector3<f64>,
    file: &Path,
) -> Result<InitialBed, BedError> {
    let mut bed = InitialBed::default();
    for row in rows {
        let at = At { file, line: row.line };
        let diameter = row.diameter.or_else(|| diameter_of(case, row.id)).ok_or_else(|| {
            at.error("there is no diameter: give a column of it, or particles.diameter")
        })?;
        let position = Vector3::from(row.position) + offset;
        require_inside(case, row.id, &position).map_err(|reason| at.error(reason))?;
        let mut particle = record(case, row.id, &Sphere { position, diameter });
        if case.particles.granular_temperature == 0.0 {
            particle.velocity = row.velocity;
        }
        particle.angular_velocity = row.angular_velocity;
        if let Some(species) = row.species {
            particle.mass = sphere_mass(case.particles.density_of_species(species), diameter);
            particle.species = species as f64;
        } else if case.particles.species_count() > 1 {
            let message = "there is no species: give a column of it (csv: species, a name; lammps: type, a number from 1)";
            return Err(at.error(message));
        }
        bed.particles.push(particle);
    }
    Ok(bed)
}

/// A position must not be beyond a face, but for a periodic one.
fn require_inside(case: &Case, id: u64, position: &Vector3<f64>) -> Result<(), String> {
    let bounds = &case.domain.bounds;
    for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        let (coordinate, length) = (position[axis], bounds.lengths()[axis]);
        let allowed = match bounds.is_periodic(axis) {
            true => -MOST_TURNS * length..=MOST_TURNS * length,
            false => 0.0..=length,
        };
        if !allowed.contains(&coordinate) {
            return Err(format!("particle {id} is outside of the box: its {name} is {coordinate}"));
        }
    }
    Ok(())
}

/// Overlaps must be small. `place_of`: where the file has a particle, by its number.
fn check_overlaps<'a>(
    case: &Case,
    bed: &InitialBed,
    place_of: impl Fn(usize) -> At<'a>,
) -> Result<(), BedError> {
    let Some(sizes) = bed.size_range() else { return Ok(()) };
    let spheres = bed.particles.iter().map(|particle| Sphere {
        position: particle.position.into(),
        diameter: 2.0 * particle.radius,
    });
    let spheres: Vec<Sphere> = spheres.collect();
    let name = |number: usize| format!("particle {}", bed.particles[number].id);
    let mut cells = Cells::new(&case.domain.bounds, sizes.largest_diameter, spheres.len());
    for (number, sphere) in spheres.iter().enumerate() {
        let mut partner = cells.overlap(&spheres, sphere, MOST_OVERLAP).map(|(other, overlap)| {
            (format!("{} of line {}", name(other), place_of(other).line), overlap)
        });
        for wall in &case.domain.walls {
            let overlap = 0.5 - wall.height_of(&sphere.position) / sphere.diameter;
            if overlap > MOST_OVERLAP {
                partner = Some((format!("wall {:?}", wall.name), overlap));
            }
        }
        if let Some((partner, overlap)) = partner {
            return Err(place_of(number).error(format!(
                "{} and {partner} overlap by {overlap:.4} of the smaller diameter: must be at most {MOST_OVERLAP}",
                name(number)
            )));
        }
        cells.push(&sphere.position);
    }
    Ok(())
}
