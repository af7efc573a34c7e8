//! Particles from a file.

mod columns;
mod csv;
mod lammps;

use super::cells::Cells;
use super::{BedFormat, BedPlan, BedProblem, InitialBed, Sphere};
use crate::input::{NOT_UTF8, utf8_text};
use columns::{At, Row, Rows};
use nalgebra::Vector3;
use std::path::Path;

/// Largest overlap in a file, over the smaller diameter.
const MOST_OVERLAP: f64 = 0.2;
/// Largest distance of a position from the box, in periods: a larger one is a mistake.
const MOST_TURNS: f64 = 1000.0;

/// The bed in a file, in the order of ids.
pub(super) fn read(
    plan: &BedPlan<'_>,
    file: &Path,
    format: BedFormat,
    offset: Vector3<f64>,
) -> Result<InitialBed, BedProblem> {
    let failed = |reason: String| BedProblem::File { file: file.to_owned(), reason };
    let bytes = std::fs::read(file).map_err(|error| failed(format!("cannot be read: {error}")))?;
    let text = utf8_text(bytes).map_err(|line| At { file, line }.error(NOT_UTF8))?;
    let Rows { mut rows, have_velocities } = match format {
        BedFormat::Csv => csv::parse(&text, file, &plan.particles.species)?,
        BedFormat::Lammps => lammps::parse(&text, file, plan.particles.species.len())?,
    };
    if rows.is_empty() {
        return Err(failed("holds no particles".to_owned()));
    }
    if have_velocities && plan.particles.granular_temperature > 0.0 {
        let words = "holds velocities: particles.start.velocity cannot be given too";
        return Err(failed(words.to_owned()));
    }
    rows.sort_by_key(|row| (row.id, row.line));
    if let Some(pair) = rows.windows(2).find(|pair| pair[0].id == pair[1].id) {
        let at = At { file, line: pair[1].line };
        return Err(at.error(format!("id {} is also that of line {}", pair[0].id, pair[0].line)));
    }
    let bed = bed_of(plan, &rows, offset, file)?;
    let wrong = bed.size_range().map(|sizes| (plan.check_sizes)(&sizes)).unwrap_or_default();
    if !wrong.is_empty() {
        return Err(BedProblem::Keys(wrong));
    }
    let lines: Vec<usize> = rows.iter().map(|row| row.line).collect();
    check_overlaps(plan, &bed, |number| At { file, line: lines[number] })?;
    Ok(bed)
}

fn bed_of(
    plan: &BedPlan<'_>,
    rows: &[Row],
    offset: Vector3<f64>,
    file: &Path,
) -> Result<InitialBed, BedProblem> {
    let mut bed = InitialBed::default();
    for row in rows {
        let at = At { file, line: row.line };
        let diameter = row.diameter.or_else(|| plan.diameter_of(row.id)).ok_or_else(|| {
            at.error("there is no diameter: give a column of it, or particles.diameter")
        })?;
        let position = Vector3::from(row.position) + offset;
        require_inside(plan, row.id, &position).map_err(|reason| at.error(reason))?;
        let mut sphere = Sphere { position: position.into(), ..plan.sphere(row.id, diameter) };
        if let Some(species) = row.species {
            sphere.density = plan.particles.density_of_species(species);
        }
        let mut particle = plan.record(row.id, &sphere);
        if plan.particles.granular_temperature == 0.0 {
            particle.velocity = row.velocity;
        }
        particle.angular_velocity = row.angular_velocity;
        if let Some(species) = row.species {
            particle.species = species as f64;
        } else if plan.particles.species_count() > 1 {
            let message = "there is no species: give a column of it (csv: species, a name; lammps: type, a number from 1)";
            return Err(at.error(message));
        }
        bed.particles.push(particle);
    }
    Ok(bed)
}

/// A position must not be beyond a face that is not periodic.
fn require_inside(plan: &BedPlan<'_>, id: u64, position: &Vector3<f64>) -> Result<(), String> {
    let bounds = &plan.domain.bounds;
    for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        let (coordinate, length) = (position[axis], bounds.lengths()[axis]);
        let turns = MOST_TURNS * length;
        let allowed = if bounds.is_periodic(axis) { -turns..=turns } else { 0.0..=length };
        if !allowed.contains(&coordinate) {
            return Err(format!("particle {id} is outside of the box: its {name} is {coordinate}"));
        }
    }
    Ok(())
}

/// Requires that overlaps are small. `place_of` gives the place of a particle in the file, by its number.
fn check_overlaps<'a>(
    plan: &BedPlan<'_>,
    bed: &InitialBed,
    place_of: impl Fn(usize) -> At<'a>,
) -> Result<(), BedProblem> {
    let Some(sizes) = bed.size_range() else { return Ok(()) };
    let spheres: Vec<Sphere> = bed.particles.iter().map(Sphere::of).collect();
    let name = |number: usize| format!("particle {}", bed.particles[number].id);
    let mut cells = Cells::new(&plan.domain.bounds, sizes.largest_diameter, spheres.len());
    for (number, sphere) in spheres.iter().enumerate() {
        let mut partner = cells.overlap(&spheres, sphere, MOST_OVERLAP).map(|(other, overlap)| {
            (format!("{} of line {}", name(other), place_of(other).line), overlap)
        });
        for wall in &plan.domain.walls {
            let overlap = 0.5 - wall.height_of(&sphere.position.into()) / sphere.diameter();
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
        cells.push(sphere.position);
    }
    Ok(())
}
