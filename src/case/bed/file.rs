//! Particles from a file.

use super::super::particles::BedFormat;
use super::cells::Cells;
use super::columns::{At, Row, Rows};
use super::{BedError, InitialBed, Sphere, csv, diameter_of, lammps, record};
use crate::case::Case;
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
    let text = String::from_utf8(bytes).map_err(|_| failed("is not a text in UTF-8".to_owned()))?;
    let Rows { mut rows, have_velocities } = match format {
        BedFormat::Csv => csv::parse(&text, file)?,
        BedFormat::Lammps => lammps::parse(&text, file)?,
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
    check(case, &bed)?;
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
        let diameter = row.diameter.or_else(|| diameter_of(case, row.id)).ok_or_else(|| {
            let words = "there is no diameter: give a column of it, or particles.diameter";
            At { file, line: row.line }.error(words)
        })?;
        let position = Vector3::from(row.position) + offset;
        require_inside(case, row.id, &position)?;
        let mut particle = record(case, row.id, &Sphere { position, diameter });
        if case.particles.granular_temperature == 0.0 {
            particle.velocity = row.velocity;
        }
        particle.angular_velocity = row.angular_velocity;
        bed.particles.push(particle);
    }
    Ok(bed)
}

/// A position must not be beyond a face, but for a periodic one.
fn require_inside(case: &Case, id: u64, position: &Vector3<f64>) -> Result<(), BedError> {
    let bounds = &case.domain.bounds;
    for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        let (coordinate, length) = (position[axis], bounds.lengths()[axis]);
        let allowed = match bounds.is_periodic(axis) {
            true => -MOST_TURNS * length..=MOST_TURNS * length,
            false => 0.0..=length,
        };
        if !allowed.contains(&coordinate) {
            return Err(BedError::Outside { id, axis: name, coordinate });
        }
    }
    Ok(())
}

/// Sizes must suit the case; overlaps must be small.
fn check(case: &Case, bed: &InitialBed) -> Result<(), BedError> {
    let Some(sizes) = bed.size_range() else { return Ok(()) };
    let wrong = case.check_sizes(&sizes);
    if !wrong.is_empty() {
        let lines: Vec<String> =
            wrong.iter().map(|(key, words)| format!("{key}: {words}")).collect();
        return Err(BedError::Sizes(lines.join("\n")));
    }
    let spheres = bed.particles.iter().map(|particle| Sphere {
        position: particle.position.into(),
        diameter: 2.0 * particle.radius,
    });
    let spheres: Vec<Sphere> = spheres.collect();
    let name = |number: usize| format!("particle {}", bed.particles[number].id);
    let mut cells = Cells::new(&case.domain.bounds, sizes.largest_diameter, spheres.len());
    for (number, sphere) in spheres.iter().enumerate() {
        let mut partner = cells
            .overlap(&spheres, sphere, MOST_OVERLAP)
            .map(|(other, overlap)| (name(other), overlap));
        for wall in &case.domain.walls {
            let overlap = 0.5 - wall.height_of(&sphere.position) / sphere.diameter;
            if overlap > MOST_OVERLAP {
                partner = Some((format!("wall {:?}", wall.name), overlap));
            }
        }
        if let Some((second, overlap)) = partner {
            let first = name(number);
            return Err(BedError::Overlap { first, second, overlap, most: MOST_OVERLAP });
        }
        cells.push(&sphere.position);
    }
    Ok(())
}
