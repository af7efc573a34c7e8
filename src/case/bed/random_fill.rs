//! A random loose bed without overlap: random sequential addition, layer by layer upwards.

use super::super::particles::Amount;
use super::cells::Cells;
use super::{BedError, Sphere, diameter_of, no_room, too_many};
use crate::case::Case;
use crate::numbers::{random_of, uniform};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Thickness of a layer in largest diameters.
const LAYER: f64 = 4.0;
/// Number of tries after which there is no room for a particle.
const TRIES: u32 = 20_000;

/// Spheres at a solids fraction, from the bottom to the height that they need.
pub(super) fn fill(
    case: &Case,
    solids_fraction: f64,
    bottom: f64,
) -> Result<Vec<Sphere>, BedError> {
    let bounds = &case.domain.bounds;
    let per_height = solids_fraction * case.domain.cross_section();
    let diameters = diameters(case, per_height, bottom)?;
    let largest = diameters.iter().copied().fold(0.0, f64::max);
    let height = diameters.iter().map(|&diameter| volume_of(diameter)).sum::<f64>() / per_height;
    // For one or few particles in a wide box, centres need room above the bottom.
    let height = height.max(largest);
    let (top, reached) = (bounds.lengths().z, bottom + height);
    if reached > top * (1.0 + 1.0e-9) {
        let reason = format!("the bed would reach up to {reached:.6} in a box of {top}");
        return Err(no_room(case, reason));
    }
    let thickness = height / (height / (LAYER * largest)).round().max(1.0);
    let mut cells = Cells::new(bounds, largest, diameters.len());
    let mut spheres: Vec<Sphere> = Vec::with_capacity(diameters.len());
    let mut filled = 0.0;
    for (id, &diameter) in diameters.iter().enumerate() {
        let layer = (filled / per_height / thickness).floor();
        let lower = bottom + layer * thickness;
        let upper = (lower + thickness).min(reached);
        let free = |sphere: &Sphere| cells.overlap(&spheres, sphere, 0.0).is_none();
        let lowest = if bottom > 0.0 { lower.max(bottom + 0.5 * diameter) } else { lower };
        let Some(sphere) = place(case, id as u64, diameter, [lowest, upper], free) else {
            let reason = format!(
                "no room for particle {id} between heights of {lower:.6} and {upper:.6} after {TRIES} \
                 tries: lower solids_fraction"
            );
            return Err(no_room(case, reason));
        };
        cells.push(&sphere.position);
        spheres.push(sphere);
        filled += volume_of(diameter);
    }
    Ok(spheres)
}

/// The diameters of all particles: the number that the case requests, or as many as fill the height at a given volume
/// per height.
fn diameters(case: &Case, per_height: f64, bottom: f64) -> Result<Vec<f64>, BedError> {
    let diameter = |id| diameter_of(case, id).unwrap_or(case.particles.reference_diameter);
    let smallest = case.size_range().map_or(1.0, |sizes| sizes.smallest_diameter);
    let top = case.domain.bounds.lengths().z;
    let height = match case.particles.amount {
        Some(Amount::Count(count)) => {
            let room = per_height * (top - bottom).max(0.0) / volume_of(smallest);
            return match count as f64 > room * (1.0 + 1.0e-9) {
                true => Err(too_many(case, room.min(1.0e9) as u64)),
                false => Ok((0..count).map(diameter).collect()),
            };
        }
        Some(Amount::FillHeight(height)) => height.min(top) - bottom,
        None => 0.0,
    };
    let mut room = per_height * height;
    if room / volume_of(smallest) > 1.0e9 {
        let reason = "more than 1e9 particles would fit below fill_height".to_owned();
        return Err(no_room(case, reason));
    }
    let mut diameters = Vec::new();
    loop {
        let next = diameter(diameters.len() as u64);
        room -= volume_of(next);
        if room < 0.0 {
            break;
        }
        diameters.push(next);
    }
    match diameters.is_empty() {
        true => Err(no_room(case, "not one particle fits below fill_height")),
        false => Ok(diameters),
    }
}

/// A sphere with its centre between two heights that touches no wall and is accepted by `is_free`.
fn place(
    case: &Case,
    id: u64,
    diameter: f64,
    [lower, upper]: [f64; 2],
    is_free: impl Fn(&Sphere) -> bool,
) -> Option<Sphere> {
    let bounds = &case.domain.bounds;
    let radius = 0.5 * diameter;
    let mut generator = random_of(case.particles.seed, id, "position");
    for _ in 0..TRIES {
        let position = Vector3::from_fn(|axis, _| {
            let length = bounds.lengths()[axis];
            let [mut low, mut high] = if axis == 2 { [lower, upper] } else { [0.0, length] };
            if !bounds.is_periodic(axis) {
                low = low.max(radius);
                high = high.min(length - radius);
            }
            low + (high - low) * uniform(&mut generator)
        });
        let position = bounds.position_quantum().round_vector(position);
        let is_inside = (0..3).all(|axis| {
            let room = bounds.lengths()[axis] - radius;
            bounds.is_periodic(axis) || (radius..=room).contains(&position[axis])
        });
        let touches = |wall: &crate::domain::Wall| wall.height_of(&position) < radius;
        let sphere = Sphere { position, diameter };
        if is_inside && !case.domain.walls.iter().any(touches) && is_free(&sphere) {
            return Some(sphere);
        }
    }
    None
}

fn volume_of(diameter: f64) -> f64 {
    PI / 6.0 * diameter * diameter * diameter
}
